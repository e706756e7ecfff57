"""A spinning elastic disk: nothing outside acts on it, so its angular momentum is kept."""

import numpy as np
from elastic import BAR_SPEED, H, elastic_scene, kinetic_energy, relative
from schemes import Changes

from pockmark import Simulation

RIM = 0.1  # of the bar speed: the rim's velocity


def measure(changes: Changes, *, radius_cells: int, turns: int) -> dict[str, float]:
    """Return the changes of angular momentum and kinetic energy, over what they were at the start.

    Plane strain, two points a cell edge. The disk starts without stress and swells by the centrifugal force, so its
    kinetic energy breathes by RIM^2.
    """
    radius = radius_cells * H
    omega = RIM * BAR_SPEED / radius
    side = radius + 3 * H
    body = {"name": "disk", "shape": "cylinder", "center": [0.0, 0.0, H / 2], "radius": radius}
    scene = elastic_scene(
        changes,
        body | {"length": H, "spacing": H / 2},
        end_time=turns * 2 * np.pi / omega,
        nu=0.33,
        lower=[-side, -side, 0.0],
        upper=[side, side, H],
        mirrors=("z_lower", "z_upper"),
    )
    simulation = Simulation(scene, 1)
    x, y, _ = simulation.field("position").T
    simulation.set_field("velocity", np.stack([-omega * y, omega * x, 0 * x], axis=1))
    spin, energy = _angular_momentum(simulation), kinetic_energy(simulation)
    simulation.run()
    return {
        "angular_momentum_change": relative(_angular_momentum(simulation), spin),
        "kinetic_change": relative(kinetic_energy(simulation), energy),
    }


def _angular_momentum(simulation: Simulation) -> float:
    """Return the angular momentum about the z axis, kg m^2/s."""
    x, v = simulation.field("position"), simulation.field("velocity")
    return float((simulation.field("mass") * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])).sum())
