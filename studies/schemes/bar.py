"""The first longitudinal mode of an elastic bar that is held at one end: period 4 L / sqrt(E / rho)."""

import numpy as np
from elastic import BAR_SPEED, H, elastic_scene, mechanical_energy, relative
from schemes import Changes

from pockmark import Simulation

AMPLITUDE = (
    1e-3  # of the bar speed, at the free end: the strain is as small, the motion less than a point spacing
)
SAMPLES = 24  # a period


def measure(changes: Changes, *, cells: int, periods: int) -> dict[str, float]:
    """Return how far the mechanical energy and the period are off, as shares.

    The energy is that of the last period against that of the first. The period is the mean one, between the first
    and the last rise of the momentum through zero. A bar whose momentum no longer rises through zero has no period.
    """
    period = 4 * cells * H / BAR_SPEED
    simulation = _struck(changes, cells, periods * period)
    times, momenta, energies = [], [], []
    for n in range(periods * SAMPLES + 1):
        simulation.advance(simulation.scene.end_time, pause=n * period / SAMPLES)
        times.append(simulation.time)
        momenta.append(float(simulation.field("mass") @ simulation.field("velocity")[:, 0]))
        energies.append(mechanical_energy(simulation))
    first, last = np.mean(energies[:SAMPLES]), np.mean(energies[-SAMPLES:])
    rises = _rises(np.array(times), np.array(momenta))
    mean = (rises[-1] - rises[0]) / (len(rises) - 1) if len(rises) > 1 else np.nan
    return {"energy_change": relative(float(last), float(first)), "period_off": relative(mean, period)}


def _struck(changes: Changes, cells: int, end_time: float) -> Simulation:
    """Return the bar, straight and moving as its first mode does."""
    length = cells * H
    scene = elastic_scene(
        changes,
        {
            "name": "bar",
            "shape": "block",
            "spacing": H / 2,
            "lower": [0.0, 0.0, 0.0],
            "upper": [length, H, H],
        },
        end_time=end_time,
        nu=0.0,
        lower=[0.0, 0.0, 0.0],
        upper=[length + 2 * H, H, H],
        mirrors=("x_lower", "y_lower", "y_upper", "z_lower", "z_upper"),
    )
    simulation = Simulation(scene, 1)
    velocity = np.zeros_like(simulation.field("velocity"))
    along = np.sin(np.pi / 2 * simulation.field("position")[:, 0] / length)
    velocity[:, 0] = AMPLITUDE * BAR_SPEED * along
    simulation.set_field("velocity", velocity)
    return simulation


def _rises(time: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return the times at which a value rises through zero, by linear interpolation."""
    at = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
    share = value[at] / (value[at] - value[at + 1])
    return np.asarray(time[at] + share * (time[at + 1] - time[at]))
