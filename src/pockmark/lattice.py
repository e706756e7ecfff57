"""The lattices of points that fill bodies: whole, or only counted. With `rounded` they are the paper's (its Tables 2 and 3 come
out exactly)."""

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from .bodies import Block, Body, Fit, Vector

Array = NDArray[np.floating]

EVERYWHERE = ((-math.inf,) * 3, (math.inf,) * 3)


def lattice(body: Body, box: Sequence[Sequence[float]] = EVERYWHERE) -> Array:
    """Return the positions (n, 3) of a body's points, m, that lie in the box (lower, upper), its upper faces left out."""
    if isinstance(body, Block):
        axes = [_inside(x, box, a) for a, x in enumerate(_block_axes(body))]
        return np.asarray(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.concatenate([_ball_lattice(center, body.fit, box) for center in body.places])


def count(body: Body, box: Sequence[Sequence[float]] = EVERYWHERE) -> int:
    """Return how many points lattice() makes, without making them; a block lies in the box whole."""
    if isinstance(body, Block):
        return math.prod(int(fit.number) for fit in body.fits)
    return sum(_ball_count(center, body.fit, box) for center in body.places)


def size(body: Body) -> float:
    """Return about how many points a body has, for the asking before they are counted: it may be infinite."""
    if isinstance(body, Block):
        return math.prod(fit.number for fit in body.fits)
    n = body.fit.number
    return len(body.places) * 4 / 3 * math.pi * n * n * n


def point_volume(body: Body) -> float:
    """Return the volume of each point of a body, m^3: a ball's points share the ball's, but for `rounded` ones, which are cubes."""
    cube = body.spacing**3
    if isinstance(body, Block):
        return cube * math.prod(fit.pitch / body.spacing for fit in body.fits)
    if body.rounded:
        return cube
    return 4 / 3 * math.pi * body.fit.length**3 / _whole_ball(int(body.fit.number))


def _inside(x: Array, box: Sequence[Sequence[float]], axis: int) -> Array:
    return x[(x >= box[0][axis]) & (x < box[1][axis])]


def _block_axes(block: Block) -> list[Array]:
    """Return the centres lower + (i + 1/2) h of the pitches h; along z upper - (k + 1/2) h, so that the surface is where it is asked."""
    x, y, z = ((np.arange(fit.number) + 0.5) * fit.pitch for fit in block.fits)
    return [block.lower[0] + x, block.lower[1] + y, block.upper[2] - z[::-1]]


def _ball_lattice(center: Vector, fit: Fit, box: Sequence[Sequence[float]]) -> Array:
    grid = np.stack(np.meshgrid(*_ball_axes(center, fit, box), indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (grid**2).sum(axis=1) < fit.number**2
    return np.asarray(grid[inside] * fit.pitch + np.asarray(center))


def _ball_count(center: Vector, fit: Fit, box: Sequence[Sequence[float]]) -> int:
    if all(w <= c - fit.length and c + fit.length <= u for c, w, u in zip(center, *box, strict=True)):
        return _whole_ball(int(fit.number))
    return _count_within(fit.number, *_ball_axes(center, fit, box))


@cache
def _whole_ball(n: int) -> int:
    """Return how many points a ball has whose radius is n pitches: eight times its first octant's."""
    half = np.arange(n) + 0.5
    return 8 * _count_within(n, half, half, half)


def _count_within(radius: float, *axes: Array) -> int:
    """Return how many of the points i, j, k of three axes have i^2 + j^2 + k^2 < radius^2."""
    x, y, z = (np.sort(half**2) for half in axes)
    # In a plane of constant x: for each y, the z with z^2 < n^2 - x^2 - y^2.
    return sum(int(np.searchsorted(z, radius**2 - square - y, side="left").sum()) for square in x)


def _ball_axes(center: Vector, fit: Fit, box: Sequence[Sequence[float]]) -> list[Array]:
    """Return half-integers i, j, k about the centre; the ball is i^2 + j^2 + k^2 < n^2, n its radius in pitches."""
    n = int(fit.number)
    half = np.arange(-n, n) + 0.5
    axes = []
    for a in range(3):
        x = half * fit.pitch + center[a]
        axes.append(half[(x >= box[0][a]) & (x < box[1][a])])
    return axes
