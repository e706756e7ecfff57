"""`pockmark bench`: how fast the step is on this machine, phase by phase, beside its copy bandwidth."""

from typing import Any

from . import _core
from .scene import Scene
from .simulation import Simulation

PHASES = (
    "clear",
    "p2g",
    "boundary",
    "stress",
    "momentum",
    "g2p",
    "absorbed",
    "move",
    "sort",
)  # as in the step
WARM_UP, END = 5e-9, 15e-9  # s: the window that is measured, during the impact


def bench_scene(points: int, overrides: tuple[str, ...] = ()) -> Scene:
    """Table 2's impact (Liu et al. 2015) at about the given number of points; model 1 at 252,112."""
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


def bench(scene: Scene, threads: int) -> dict[str, Any]:
    """Step the scene through the window with the SIMD and the scalar driver; figures in SI, ready for JSON."""
    simulation = Simulation(scene, threads)
    seconds, steps, points = _measure(simulation, END)
    total = sum(seconds.values())
    rate = points * steps / total
    build = _core.build_info()
    copy = float(_core.copy_bandwidth(threads=threads))
    traffic = traffic_per_point(scene)
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
    if build["lanes"]:
        scalar = Simulation(scene, threads, lanes=False)
        seconds, steps, points = _measure(scalar, WARM_UP + (END - WARM_UP) / 4)
        result["scalar_particle_steps_per_second"] = points * steps / sum(seconds.values())
        result["lanes_over_scalar"] = rate / result["scalar_particle_steps_per_second"]
    return result


def _measure(simulation: Simulation, end: float) -> tuple[dict[str, float], int, int]:
    """Seconds of each phase, steps and points from WARM_UP to `end`."""
    simulation.advance(WARM_UP)
    before = simulation.timers()
    steps = simulation.advance(end)
    after = simulation.timers()
    return {name: after[name] - before[name] for name in PHASES}, steps, simulation.points


def traffic_per_point(scene: Scene) -> dict[str, float]:
    """Bytes of point data that each phase must move to and from memory, a point and step; the grid's not counted."""
    size = 8 if scene.numerics.precision == "double" else 4
    width = {f["name"]: f["components"] * size for f in _core.fields()} | {"body": 1, "cell": 4, "id": 4}
    scheme = scene.numerics.scheme

    def of(*names: str) -> int:
        return sum(width[n] for n in names)

    strained = ("volume", "energy", "deviator")
    state = (*strained, "pressure", "viscosity", "plastic_strain", "temperature", "damage")
    stress = of("position", "velocity", "mass", "cell", "body", *state) + of(*state)
    forces = of("position", "cell", "volume", "deviator", "pressure", "viscosity")
    remaps, average = scheme in ("musl", "usavg"), scheme == "usavg"
    move = of("position", "cell") + of("position")
    if average:
        move += of("mass", "body", "pressure", "viscosity", "damage", *strained) + of(*strained)
    return {
        "p2g": float(of("position", "velocity", "mass", "cell")),
        "stress": float(stress if scheme in ("usf", "usavg") else stress + forces),
        "g2p": float(of("position", "velocity", "cell") + of("velocity") + (width["mass"] if remaps else 0)),
        "move": float(move),
        # Cells every step; every eighth, all fields are read and written.
        "sort": of("position", "cell") + width["cell"] + 2 * sum(width.values()) / 8,
    }
