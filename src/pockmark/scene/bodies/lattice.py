"""The lattice of points in round bodies: half-integers about a centre, within a circle or a sphere.

In `rounded` bodies it is the paper's: its Tables 2 and 3 come out exactly.
"""

from functools import cache

import numpy as np

from .shape import Array, Box, Fit


def half_integers(center: float, fit: Fit, low: float, high: float) -> Array:
    """Return the half-integers i for which center + i pitch (m) lies in low .. high (m).

    There are as many as the fitted radius has room for.
    """
    n = int(fit.number)
    half = np.arange(-n, n) + 0.5
    x = half * fit.pitch + center
    return half[(x >= low) & (x < high)]


def ball_axes(center: tuple[float, float, float], fit: Fit, box: Box) -> list[Array]:
    """Return half-integers i, j, k about the centre of a ball, of points that lie in the box.

    The ball itself is i^2 + j^2 + k^2 < n^2, with n its radius in pitches.
    """
    return [half_integers(center[a], fit, box[0][a], box[1][a]) for a in range(3)]


@cache
def whole_ball(n: int) -> int:
    """Return how many points a ball of a radius of n pitches has: eight times its first octant's."""
    half = np.arange(n) + 0.5
    return 8 * count_within(n, half, half, half)


def count_within(radius: float, *axes: Array) -> int:
    """Return how many points i, j, k of three axes have i^2 + j^2 + k^2 < radius^2."""
    x, y, z = (np.sort(half**2) for half in axes)
    # In a plane of constant x: for each y, the z with z^2 < n^2 - x^2 - y^2.
    return sum(int(np.searchsorted(z, radius**2 - square - y, side="left").sum()) for square in x)
