"""The ejecta: material that no longer hangs together with the rest and moves away.

docs/metrology.md says which mass counts. All figures are of the whole impact: what symmetry planes hide is counted.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.geometry import Setup, copies
from .pieces import attached
from .section import section_area

Array = NDArray[np.float64]
SPEED_BINS, ANGLE_BINS = 16, 9


@dataclass(frozen=True)
class Ejecta:
    """The ejecta in the grid: mass kg, momentum (3,) kg m/s, kinetic energy J, and histograms of their mass.

    `mass_by_speed` (kg) has the edges `speed_edges` (m/s). `mass_by_angle` (kg) has the edges `angle_edges` (rad),
    the angles from the surface's normal.
    """

    mass: float
    momentum: Array
    kinetic: float
    speed_edges: Array
    mass_by_speed: Array
    angle_edges: Array
    mass_by_angle: Array


def find_ejecta(snapshot: Mapping[str, NDArray[Any]], setup: Setup) -> Ejecta:
    """Return the ejecta in a snapshot: the points that are detached and move upwards (v_z > 0).

    The target's and the projectile's points count alike. Detached means off the largest piece of each wall, or of
    everything if the setup has no walls.
    """
    velocity, mass = snapshot["velocity"], snapshot["mass"]
    owner = None
    if setup.walls is not None:
        owner = np.full(len(mass), -1)
        for number, bodies in enumerate(setup.walls):
            owner[np.isin(snapshot["body"], bodies)] = number
    position, volume = snapshot["position"], snapshot["volume"]
    if setup.is_axisymmetric:  # as a slice that fills the cells in which pieces are looked for
        volume = section_area(position, volume) * 2 * setup.spacing
    hangs = attached(position, volume, setup.spacing, owner)
    away = ~hangs & (velocity[:, 2] > 0)
    velocity, mass = velocity[away], mass[away] * copies(setup.mirrors)
    speed = np.linalg.norm(velocity, axis=1)
    angle = np.arccos(np.clip(velocity[:, 2] / np.where(speed > 0, speed, 1.0), -1.0, 1.0))
    fastest = float(speed.max(initial=0.0)) or 1.0
    by_speed, speed_edges = np.histogram(speed, SPEED_BINS, (0.0, fastest), weights=mass)
    by_angle, angle_edges = np.histogram(angle, ANGLE_BINS, (0.0, np.pi / 2), weights=mass)
    momentum = whole_momentum((mass[:, None] * velocity).sum(axis=0), setup)
    kinetic = 0.5 * float(mass @ speed**2)
    return Ejecta(float(mass.sum()), momentum, kinetic, speed_edges, by_speed, angle_edges, by_angle)


def whole_momentum(momentum: Array, setup: Setup) -> Array:
    """Return a momentum (3,) of the whole impact, kg m/s, given that of it without what mirrors hide.

    Its components across symmetry planes are 0, for the mirror image has the opposite ones. So are those of rings,
    but along the axis.
    """
    out = np.array(momentum, dtype=float)
    for axis in (0, 1) if setup.is_axisymmetric else [mirror.axis for mirror in setup.mirrors]:
        out[axis] = 0.0
    return out


def enhancement(ejected: float, projectile: float) -> float | None:
    """Return beta = 1 + ejected/projectile, from the ejecta's momentum out of the target and the projectile's into it.

    Both are in kg m/s. None where the projectile has none.
    """
    return 1 + ejected / projectile if projectile > 0 else None
