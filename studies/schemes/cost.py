"""The processor's time of a step beside that of the trilinear scheme, the two taking turns."""

import statistics
import time

from schemes import TRILINEAR, Changes, overrides

from pockmark import Simulation
from pockmark.run.bench import bench_scene

STEPS, WARM_UP = 40, 60  # of a turn: more than an interval of a filter


def measure(changes: Changes, *, points: int, turns: int) -> dict[str, float]:
    """Return the median time of a step of a point (ns), and that of its ratio to the trilinear scheme's."""
    both = [Simulation(bench_scene(points, tuple(overrides(of))), 1) for of in (changes, TRILINEAR)]
    for simulation in both:
        simulation.advance(1.0, max_steps=WARM_UP)
    times = [[_seconds(simulation) for simulation in both] for _ in range(turns)]
    return {
        "ns_a_point": statistics.median(own for own, _ in times) * 1e9,
        "of_trilinear": statistics.median(own / other for own, other in times),
    }


def _seconds(simulation: Simulation) -> float:
    """Return the seconds that a point takes in a step, over a turn."""
    points, start = simulation.points, time.process_time()
    done = simulation.advance(1.0, max_steps=STEPS)
    return (time.process_time() - start) / (points * done)
