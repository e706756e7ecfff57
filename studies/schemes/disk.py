"""A spinning elastic disk: nothing outside acts on it, so its angular momentum is kept."""

import numpy as np
from elastic import BAR_SPEED, H, elastic_scene, kinetic_energy, relative
from schemes import Changes

from pockmark import Simulation

RIM = 0.1  # of the bar speed: the rim's velocity


def measure(changes: Changes, *, radius_cells: int, turns: int) -> dict[str, float]:
    """Return the changes of angular momentum, kinetic energy and mean radius (rms), over what they were at the start.

    Plane strain, two points a cell edge. The disk starts without stress and swells by the centrifugal force, by less
    than RIM^2; what swells more comes apart. The grid leaves it half of its radius: a point that leaves is told, and
    takes its angular momentum along.
    """
    radius = radius_cells * H
    omega = RIM * BAR_SPEED / radius
    side = radius + max(radius_cells // 2, 3) * H
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
    spin, energy, size = (of(simulation) for of in (_angular_momentum, kinetic_energy, _mean_radius))
    simulation.run()
    return {
        "angular_momentum_change": relative(_angular_momentum(simulation), spin),
        "kinetic_change": relative(kinetic_energy(simulation), energy),
        "radius_change": relative(_mean_radius(simulation), size),
        "left_points": simulation.counters()["left_points"],
    }


def _angular_momentum(simulation: Simulation) -> float:
    """Return the angular momentum about the z axis, kg m^2/s."""
    x, v = simulation.field("position"), simulation.field("velocity")
    return float((simulation.field("mass") * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])).sum())


def _mean_radius(simulation: Simulation) -> float:
    """Return the root of the mean square distance of its points from the z axis, m; NaN when all have left."""
    squares = (simulation.field("position")[:, :2] ** 2).sum(axis=1)
    return float(np.sqrt(squares.mean())) if len(squares) else float("nan")
