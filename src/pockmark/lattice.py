"""The lattices of points that fill bodies, as the paper's: whole (its Tables 2 and 3 come out exactly), or only counted."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .bodies import Ball, Block, Body

Array = NDArray[np.floating]

EVERYWHERE = ((-math.inf,) * 3, (math.inf,) * 3)


def lattice(body: Body, box: Sequence[Sequence[float]] = EVERYWHERE) -> Array:
    """Positions (n, 3) of a body's points, m, that lie in the box (lower, upper), its upper faces left out."""
    if isinstance(body, Block):
        axes = [_inside(x, box, a) for a, x in enumerate(_block_axes(body))]
        return np.asarray(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.concatenate([_ball_lattice(ball, body.spacing, box) for ball in body.balls])


def count(body: Body, box: Sequence[Sequence[float]] = EVERYWHERE) -> int:
    """How many points lattice() makes, without making them; a block lies in the box whole."""
    if isinstance(body, Block):
        return math.prod(block_counts(body))
    return sum(_ball_count(ball, body.spacing, box) for ball in body.balls)


def size(body: Body) -> float:
    """About how many points a body has, for the asking before they are counted: it may be infinite."""
    if isinstance(body, Block):
        return math.prod((u - w) / body.spacing for w, u in zip(*body.box, strict=True))
    return sum(4 / 3 * math.pi * ball.reach * ball.reach * ball.reach for ball in body.balls)


def block_counts(block: Block) -> list[int]:
    """Number of points along x, y, z: those whose centre lies inside."""
    return [
        max(0, math.ceil((u - w) / block.spacing - 0.5 - 1e-9))
        for w, u in zip(block.lower, block.upper, strict=True)
    ]


def _inside(x: Array, box: Sequence[Sequence[float]], axis: int) -> Array:
    return x[(x >= box[0][axis]) & (x < box[1][axis])]


def _block_axes(block: Block) -> list[Array]:
    """Centres lower + (i + 1/2) h that lie inside; along z upper - (k + 1/2) h, so that the surface is where it is asked."""
    nx, ny, nz = block_counts(block)
    x, y = (w + (np.arange(n) + 0.5) * block.spacing for w, n in zip(block.lower[:2], (nx, ny), strict=True))
    return [x, y, block.upper[2] - (np.arange(nz)[::-1] + 0.5) * block.spacing]


def _ball_lattice(ball: Ball, spacing: float, box: Sequence[Sequence[float]]) -> Array:
    grid = np.stack(np.meshgrid(*_ball_axes(ball, spacing, box), indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (grid**2).sum(axis=1) < ball.reach**2
    return np.asarray(grid[inside] * spacing + np.asarray(ball.center))


def _ball_count(ball: Ball, spacing: float, box: Sequence[Sequence[float]]) -> int:
    x, y, z = (np.sort(half**2) for half in _ball_axes(ball, spacing, box))
    # In a plane of constant x: for each y, the z with z^2 < n^2 - x^2 - y^2.
    return sum(int(np.searchsorted(z, ball.reach**2 - square - y, side="left").sum()) for square in x)


def _ball_axes(ball: Ball, spacing: float, box: Sequence[Sequence[float]]) -> list[Array]:
    """Half-integers i, j, k about the centre; the ball is i^2 + j^2 + k^2 < n^2, n its radius in spacings."""
    n = math.ceil(ball.reach)
    half = np.arange(-n, n) + 0.5
    axes = []
    for a in range(3):
        x = half * spacing + ball.center[a]
        axes.append(half[(x >= box[0][a]) & (x < box[1][a])])
    return axes
