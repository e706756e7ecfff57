"""What the spinning disk and the vibrating bar share: an elastic solid in a box, and its mechanical energy."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from schemes import Changes, scene_of

from pockmark import Scene, Simulation

YOUNG, DENSITY, H = 70e9, 2800.0, 1e-6  # Pa, kg/m^3, m (a cell)
BAR_SPEED = (YOUNG / DENSITY) ** 0.5  # 5000 m/s


def elastic_scene(
    changes: Changes,
    body: Mapping[str, object],
    *,
    end_time: float,
    nu: float,
    lower: list[float],
    upper: list[float],
    mirrors: tuple[str, ...],
) -> Scene:
    """Return the scene of one body, at rest, that is a linear elastic solid in a box (m); its other faces are free."""
    faces = [f"{axis}_{side}" for axis in "xyz" for side in ("lower", "upper")]
    solid = {
        "source": "Hooke's law",
        "density": DENSITY,
        "eos": {"model": "linear", "bulk_modulus": YOUNG / (3 * (1 - 2 * nu))},
        "strength": {"model": "elastic", "shear_modulus": YOUNG / (2 * (1 + nu))},
        "failure": {"model": "none"},
        "thermal": {"specific_heat": 900.0, "melt_temperature": 1e5},
        "viscosity": {"quadratic": 0.0, "linear": 0.0},
    }
    table = {
        "title": "elastic body",
        "end_time": end_time,
        "impact": {"speed": 0.0},
        "grid": {"lower": lower, "upper": upper, "cell": H},
        "boundary": dict.fromkeys(faces, "free") | dict.fromkeys(mirrors, "symmetry"),
        "materials": {"solid": solid},
        # Not at rest for the core, which otherwise passes over what nothing has reached.
        "body": [{"material": "solid", "velocity": [0.0, 0.0, 0.0], **body}],
        "output": {"snapshots": end_time, "history": end_time},
    }
    return scene_of(table, changes)


def mechanical_energy(simulation: Simulation) -> float:
    """Return the kinetic and the elastic energy (J); heat is no part of it."""
    constants: dict[str, Any] = simulation.scene.materials["solid"].model_dump()
    bulk, shear = constants["eos"]["bulk_modulus"], constants["strength"]["shear_modulus"]
    mass, p, s = (simulation.field(name) for name in ("mass", "pressure", "deviator"))
    squared = (s[:, :3] ** 2).sum(axis=1) + 2 * (s[:, 3:] ** 2).sum(axis=1)
    elastic = (mass / DENSITY * (p**2 / (2 * bulk) + squared / (4 * shear))).sum()
    return float(elastic) + kinetic_energy(simulation)


def kinetic_energy(simulation: Simulation) -> float:
    """Return the kinetic energy, J."""
    return float(0.5 * (simulation.field("mass") * (simulation.field("velocity") ** 2).sum(axis=1)).sum())


def relative(later: float, first: float) -> float:
    """Return the change of a quantity over what it was first; NaN where it no longer is a number."""
    return float(later / first - 1) if np.isfinite(later) else float("nan")
