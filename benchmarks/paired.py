"""Compare the step of two checkouts, case by case, in one run: `python benchmarks/paired.py OLD/src NEW/src > benchmarks/paired.csv`.

Each checkout, with its core built, steps the same impact in a process of its own; the two take turns, in random order, so
that what else runs on the machine slows both. On one thread the processor's own time counts, which what else runs hardly
touches. A row has the rates of both and the median of new time by old, with its quartiles.
"""

import csv
import json
import os
import random
import statistics
import subprocess
import sys

from run import CASES

# Rounds have processes of their own, whose memory lies elsewhere. The steps of a turn are an interval of the default's filter.
ROUNDS, TURNS, STEPS, WARM_UP = 3, 12, 10, 40
# What a checkout runs: it answers each number of steps with the seconds that a point took in one.
STEPPER = """
import json, sys, time
try:
    from pockmark.run.bench import bench_scene
    from pockmark.run.simulation import Simulation
except ImportError:  # before the package had rooms
    from pockmark.bench import bench_scene
    from pockmark.simulation import Simulation
threads, changes = json.loads(sys.argv[1])
try:
    scene = bench_scene(252_112, tuple(changes))
except Exception:  # before there were other methods than the paper's
    others = ("volumetric_strain", "node_velocity", "filter")
    scene = bench_scene(252_112, tuple(c for c in changes if c.split(".")[1].split("=")[0] not in others))
simulation = Simulation(scene, threads)
clock = time.process_time if threads == 1 else time.perf_counter
for line in sys.stdin:
    start = clock()
    points, done = simulation.points, simulation.advance(1.0, max_steps=int(line))
    print((clock() - start) / (points * done), flush=True)
"""


def in_python(arguments: list[str]) -> tuple[int, list[str]]:
    """Return the threads and the changes of the scene that the arguments of `pockmark bench` ask for."""
    given = list(zip(arguments[::2], arguments[1::2], strict=True))
    threads = next((int(value) for option, value in given if option == "--threads"), 1)
    changes = [value for option, value in given if option == "--set"]
    changes += [f"numerics.precision={value}" for option, value in given if option == "--precision"]
    return threads, changes


def stepper(source: str, isa: str, threads: int, changes: list[str]) -> subprocess.Popen[str]:
    """Start a process that steps with the checkout at `source`."""
    environment = os.environ | {"PYTHONPATH": source} | ({"POCKMARK_ISA": isa} if isa else {})
    command = [sys.executable, "-c", STEPPER, json.dumps([threads, changes])]
    return subprocess.Popen(
        command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def seconds(process: subprocess.Popen[str], steps: int) -> float:
    """Let a process do some steps. Return the seconds of a particle-step."""
    assert process.stdin
    assert process.stdout
    process.stdin.write(f"{steps}\n")
    process.stdin.flush()
    return float(process.stdout.readline())


def turn(both: list[subprocess.Popen[str]]) -> list[float]:
    """Let both do some steps, either one first. Return the seconds of a particle-step of each."""
    taken = [0.0, 0.0]
    for one in random.sample(range(2), 2):
        taken[one] = seconds(both[one], STEPS)
    return taken


def a_round(both: list[subprocess.Popen[str]]) -> list[list[float]]:
    """Return the seconds of both in each turn of new processes, and end these."""
    for process in both:
        seconds(process, WARM_UP)
    times = [turn(both) for _ in range(TURNS)]
    for process in both:
        process.kill()
        process.communicate()
    return times


def main() -> None:
    """Write a row for each case."""
    old, new = sys.argv[1:3]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(
        [
            "case",
            "old_M_particle_steps_s",
            "new_M_particle_steps_s",
            "new_time_by_old",
            "lower_quartile",
            "upper_quartile",
        ]
    )
    for case, (isa, arguments) in CASES.items():
        times = [
            taken
            for _ in range(ROUNDS)
            for taken in a_round([stepper(source, isa, *in_python(arguments)) for source in (old, new)])
        ]
        ratios = [after / before for before, after in times]
        rates = [1e-6 / statistics.median(column) for column in zip(*times, strict=True)]
        quartiles = statistics.quantiles(ratios)
        writer.writerow(
            [case, *(f"{rate:.2f}" for rate in rates), *(f"{quartiles[i]:.3f}" for i in (1, 0, 2))]
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main()
