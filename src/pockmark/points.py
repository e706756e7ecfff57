"""Bodies to material points: the paper's lattices (its Tables 2 and 3 come out exactly)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bodies import Block, Sphere
from .errors import PockmarkError
from .scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Points:
    """Initial material points: position (n, 3) m, velocity (n, 3) m/s, mass (n,) kg, volume (n,) m^3, body (n,)."""

    position: Array
    velocity: Array
    mass: Array
    volume: Array
    body: NDArray[np.uint8]


def lattice(body: Block | Sphere) -> Array:
    """Positions (n, 3) of a body's points, m."""
    return _block(body) if isinstance(body, Block) else _sphere(body)


def block_counts(block: Block) -> list[int]:
    """Number of points along x, y, z: those whose centre lies inside."""
    return [
        int(np.ceil((u - w) / block.spacing - 0.5 - 1e-9))
        for w, u in zip(block.lower, block.upper, strict=True)
    ]


def _block(block: Block) -> Array:
    """Centres lower + (i + 1/2) h that lie inside; along z upper - (k + 1/2) h, so that the surface is where it is asked."""
    nx, ny, nz = block_counts(block)
    x, y = (w + (np.arange(n) + 0.5) * block.spacing for w, n in zip(block.lower[:2], (nx, ny), strict=True))
    axes = [x, y, block.upper[2] - (np.arange(nz)[::-1] + 0.5) * block.spacing]
    return np.asarray(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))


def _sphere(sphere: Sphere) -> Array:
    """Half-integer i, j, k about the centre with i^2 + j^2 + k^2 < n^2, n = radius / h rounded."""
    n = max(1, round(sphere.radius / sphere.spacing))
    axis = np.arange(-n, n) + 0.5
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (grid**2).sum(axis=1) < n * n
    return np.asarray(grid[inside] * sphere.spacing + np.asarray(sphere.center))


def make_points(scene: Scene) -> Points:
    """All points of a scene; what lies behind a symmetry plane is dropped. Raises PockmarkError."""
    if len(scene.body) > 255:
        raise PockmarkError(f"body: found {len(scene.body)} bodies, at most 255 are allowed")
    lower, upper = np.asarray(scene.grid.lower), np.asarray(scene.grid.corner)
    positions, volumes, masses, velocities, bodies = [], [], [], [], []
    for index, body in enumerate(scene.body):
        x = lattice(body)
        x = x[np.all((x >= lower) & (x < upper), axis=1)]
        if len(x) == 0:
            raise PockmarkError(
                f"body[{index}] '{body.name}': spacing {body.spacing} m leaves it without points"
            )
        volume = body.spacing**3
        velocity = scene.impact.velocity if body.projectile else (0.0, 0.0, 0.0)
        positions.append(x)
        velocities.append(np.tile(velocity, (len(x), 1)))
        volumes.append(np.full(len(x), volume))
        masses.append(np.full(len(x), volume * scene.materials[body.material].density))
        bodies.append(np.full(len(x), index, dtype=np.uint8))
    return Points(
        np.concatenate(positions),
        np.concatenate(velocities).astype(np.float64),
        np.concatenate(masses),
        np.concatenate(volumes),
        np.concatenate(bodies),
    )
