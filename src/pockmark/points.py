"""A scene's bodies to material points."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .lattice import lattice
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


def make_points(scene: Scene) -> Points:
    """All points of a scene; what lies behind a symmetry plane is dropped."""
    positions, volumes, masses, velocities, bodies = [], [], [], [], []
    for index, body in enumerate(scene.body):
        x = lattice(body, scene.grid.box)
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
