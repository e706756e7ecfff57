"""The material points of a scene's bodies."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.scene import Scene

Array = NDArray[np.float64]
PIECE = 2**18  # points: their arrays here take memory beside what the core keeps


@dataclass(frozen=True)
class Points:
    """Material points at the start, n of them.

    position (n, 3) m, velocity (n, 3) m/s, mass (n,) kg, volume (n,) m^3, body (n,), its index.
    """

    position: Array
    velocity: Array
    mass: Array
    volume: Array
    body: NDArray[np.uint8]


def make_points(scene: Scene) -> Iterator[Points]:
    """Give all points of a scene, piece by piece. What lies behind a symmetry plane is left out."""
    for index, body in enumerate(scene.body):
        x, volumes = scene.filled(body)
        density = scene.materials[body.material].density
        velocity = scene.velocity(body)
        for start in range(0, len(x), PIECE):
            position = np.asarray(x[start : start + PIECE], dtype=np.float64)
            volume = np.ascontiguousarray(volumes[start : start + PIECE])
            n = len(position)
            yield Points(
                position,
                np.tile(np.array(velocity), (n, 1)),
                volume * density,
                volume,
                np.full(n, index, dtype=np.uint8),
            )
