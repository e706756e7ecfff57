"""What an impact throws out: the material that hangs no longer together with the rest and moves away.

docs/metrology.md says which mass counts. All figures are of the whole impact: what symmetry planes hide is counted.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .scene import Mirror
from .surface import filling, largest_piece

Array = NDArray[np.float64]
SPEED_BINS, ANGLE_BINS = 16, 9


@dataclass(frozen=True)
class Ejecta:
    """Mass kg, momentum (3,) kg m/s, kinetic energy J of the ejecta in the grid; histograms of their mass (kg) over
    speed (edges m/s) and over the angle from the surface's normal (edges rad)."""

    mass: float
    momentum: Array
    kinetic: float
    speed_edges: Array
    mass_by_speed: Array
    angle_edges: Array
    mass_by_angle: Array


def find_ejecta(snapshot: Mapping[str, NDArray[Any]], spacing: float, mirrors: Sequence[Mirror]) -> Ejecta:
    """The points, of target and projectile alike, that are detached and move upwards (v_z > 0)."""
    velocity, mass = snapshot["velocity"], snapshot["mass"]
    away = ~attached(snapshot["position"], snapshot["volume"], spacing) & (velocity[:, 2] > 0)
    velocity, mass = velocity[away], mass[away] * copies(mirrors)
    speed = np.linalg.norm(velocity, axis=1)
    angle = np.arccos(np.clip(velocity[:, 2] / np.where(speed > 0, speed, 1.0), -1.0, 1.0))
    fastest = float(speed.max(initial=0.0)) or 1.0
    by_speed, speed_edges = np.histogram(speed, SPEED_BINS, (0.0, fastest), weights=mass)
    by_angle, angle_edges = np.histogram(angle, ANGLE_BINS, (0.0, np.pi / 2), weights=mass)
    momentum = whole_momentum((mass[:, None] * velocity).sum(axis=0), mirrors)
    kinetic = 0.5 * float(mass @ speed**2)
    return Ejecta(float(mass.sum()), momentum, kinetic, speed_edges, by_speed, angle_edges, by_angle)


def attached(position: Array, volume: Array, spacing: float) -> NDArray[np.bool_]:
    """Whether each point (n,) is in or next to the largest connected piece of cells, two spacings wide, more than half full."""
    width = np.full(3, 2 * spacing)
    lower = np.floor(position.min(axis=0) / width) * width - width
    cell = np.floor((position - lower) / width).astype(np.int64)
    piece = largest_piece(filling(position, volume, lower, width, cell.max(axis=0) + 2) > 0.5)
    near = ndimage.binary_dilation(piece, np.ones((3, 3, 3)))
    return np.asarray(near[tuple(cell.T)])


def copies(mirrors: Sequence[Mirror]) -> int:
    """How many times the whole impact holds what is computed."""
    return int(2 ** len(mirrors))


def whole_momentum(momentum: Array, mirrors: Sequence[Mirror]) -> Array:
    """Without the components across symmetry planes, which the mirror image takes back."""
    out = np.array(momentum, dtype=float)
    for mirror in mirrors:
        out[mirror.axis] = 0.0
    return out


def enhancement(ejected: float, projectile: float) -> float | None:
    """beta = 1 + p_ejecta,z / p_projectile,z, both positive: out of the target, into it; None without a projectile's."""
    return 1 + ejected / projectile if projectile > 0 else None
