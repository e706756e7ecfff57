"""`pockmark bench`: how fast the step is on this machine, phase by phase, beside its copy bandwidth."""

from typing import Any, NamedTuple

from .. import _core
from ..scene.scene import Scene
from .simulation import Simulation

WARM_UP, END = 5e-9, 15e-9  # s, of the impact: what is measured lies between


def bench_scene(points: int, overrides: tuple[str, ...] = ()) -> Scene:
    """Return the impact of Table 2 (Liu et al. 2015) with about the given number of points.

    252,112 points give the paper's model 1.
    """
    layers = max(4, round(50 * (points / 252_112) ** (1 / 3)))
    spacing = 100.0 / layers
    table = {
        "title": f"bench, {layers} layers",
        "end_time": END,
        "impact": {"speed": 2200.0},
        "grid": {
            "lower": ["-100 um", 0.0, "-100 um"],
            "upper": ["100 um", "100 um", "50 um"],
            "cell": f"{2 * spacing} um",
        },
        "body": [
            {
                "name": "target",
                "shape": "block",
                "lower": ["-100 um", 0.0, "-100 um"],
                "upper": ["100 um", "100 um", 0.0],
                "spacing": f"{spacing} um",
                "material": "al2024-liu2015",
            },
            {
                "name": "projectile",
                "shape": "sphere",
                "center": [0.0, 0.0, "10 um"],
                "radius": "10 um",
                "spacing": f"{spacing / 2} um",
                "material": "al2024-liu2015",
                "projectile": True,
            },
        ],
    }
    return Scene.from_dict(table, source="bench", overrides=overrides)


def bench(scene: Scene, threads: int, *, compare: bool = True) -> dict[str, Any]:
    """Step the scene through the window that is measured, and return figures in SI, ready for JSON.

    With `compare` the plain driver steps it, too.
    """
    simulation = Simulation(scene, threads)
    measured = _measure(simulation, END)
    seconds, points, steps = measured.seconds, measured.points, measured.steps
    rate = measured.rate
    build = _core.build_info()
    copy = float(_core.copy_bandwidth(threads=threads))
    traffic = traffic_per_point(scene, measured.sorts / steps)
    memory = simulation.memory()
    result: dict[str, Any] = {
        "points": points,
        "cells": scene.grid.cell_count,
        "steps": steps,
        "threads": threads,
        "isa": build["isa"],
        "precision": scene.numerics.precision,
        "scheme": scene.numerics.scheme,
        "shape_functions": scene.numerics.shape_functions,
        "particle_steps_per_second": rate,
        "copy_bandwidth": copy,
        "traffic": sum(traffic.values()) * rate,
        "share_of_copy_bandwidth": sum(traffic.values()) * rate / copy,
        "bytes_per_point": memory["points"] / points,
        "grid_bytes_per_point": memory["grid"] / points,
        "phases": {
            phase: {
                "ns_per_point": s / (points * steps) * 1e9,
                "bytes_per_point": traffic.get(phase, 0.0),
                "share_of_copy_bandwidth": traffic.get(phase, 0.0) * points * steps / s / copy if s else 0.0,
            }
            for phase, s in seconds.items()
        },
    }
    if compare:
        plain = _measure(Simulation(scene, driver="plain"), END).rate
        result |= {"plain_particle_steps_per_second": plain, "over_plain": rate / plain}
    return result


class Measured(NamedTuple):
    """The seconds of each phase over `steps` steps of `points` points.

    The points were sorted `sorts` times meanwhile.
    """

    seconds: dict[str, float]
    steps: int
    points: int
    sorts: int

    @property
    def rate(self) -> float:
        """Return the particle-steps a second."""
        return self.points * self.steps / sum(self.seconds.values())


def _measure(simulation: Simulation, end: float) -> Measured:
    """Return what a simulation takes from WARM_UP to `end`, s."""
    simulation.advance(WARM_UP)
    before, sorts = simulation.timers(), simulation.sorts
    steps = simulation.advance(end)
    seconds = {name: after - before.get(name, 0.0) for name, after in simulation.timers().items()}
    return Measured(seconds, steps, simulation.points, simulation.sorts - sorts)


def traffic_per_point(scene: Scene, sorts_per_step: float) -> dict[str, float]:
    """Return the bytes that each phase must move to and from memory, for a point and a step.

    Only the points' data are counted, not the grid's.
    """
    size = 8 if scene.numerics.precision == "double" else 4
    width = {f["name"]: f["components"] * size for f in _core.fields()} | {"body": 1, "cell": 4, "id": 4}
    scheme = scene.numerics.scheme

    def of(*names: str) -> int:
        return sum(width[n] for n in names)

    strained = ("volume", "energy", "deviator")
    loaded = of("mass", *strained, "pressure", "viscosity")
    # Few points yield, so plastic strain, temperature and damage are not counted as written.
    stress = (
        loaded + of("position", "velocity", "temperature", "damage") + of(*strained, "pressure", "viscosity")
    )
    first = scheme in ("usf", "usavg")
    move = 2 * of("position")
    if scheme == "usavg":
        move += of(*strained, "pressure", "viscosity", "damage") + of(*strained)
    maps = scheme != "usl"  # the pass that updates velocities also adds the points to the grid
    traffic: dict[str, float] = {
        "p2g": of("position", "velocity", "mass") * min(sorts_per_step, 1.0),  # a sort undoes what was mapped
        "stress": stress if first else stress + loaded + of("position"),
        "g2p": of("position") + 2 * of("velocity") + (width["mass"] if maps else 0),
        "move": move,
        "sort": 2 * sum(width.values()) * sorts_per_step,
    }
    if scheme == "usf":  # one pass does both
        traffic["g2p"] += traffic.pop("move") - of("position")
    else:
        traffic["move"] += of("velocity", "mass")
    return {phase: float(bytes_) for phase, bytes_ in traffic.items()}
