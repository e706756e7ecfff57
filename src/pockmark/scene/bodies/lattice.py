"""Points in round bodies: half-integers about a centre that lie within a circle or a sphere. With `rounded` bodies they are the
paper's (its Tables 2 and 3 come out exactly)."""

from functools import cache

import numpy as np

from .shape import Array, Box, Fit


def half_integers(center: float, fit: Fit, low: float, high: float) -> Array:
    """Return the half-integers i of the points center + i pitch, m, that a fitted radius has and that lie in low .. high, m."""
    n = int(fit.number)
    half = np.arange(-n, n) + 0.5
    x = half * fit.pitch + center
    return half[(x >= low) & (x < high)]


def ball_axes(center: tuple[float, float, float], fit: Fit, box: Box) -> list[Array]:
    """Return half-integers i, j, k about the centre; the ball is i^2 + j^2 + k^2 < n^2, n its radius in pitches."""
    return [half_integers(center[a], fit, box[0][a], box[1][a]) for a in range(3)]


@cache
def whole_ball(n: int) -> int:
    """Return how many points a ball has whose radius is n pitches: eight times its first octant's."""
    half = np.arange(n) + 0.5
    return 8 * count_within(n, half, half, half)


def count_within(radius: float, *axes: Array) -> int:
    """Return how many of the points i, j, k of three axes have i^2 + j^2 + k^2 < radius^2."""
    x, y, z = (np.sort(half**2) for half in axes)
    # In a plane of constant x: for each y, the z with z^2 < n^2 - x^2 - y^2.
    return sum(int(np.searchsorted(z, radius**2 - square - y, side="left").sum()) for square in x)
