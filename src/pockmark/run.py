"""A run from scene to measured folder, and what is known of a run before and after it."""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import __version__, _core, results
from .crater import Crater
from .errors import PockmarkError
from .plots import history_figure, slice_figure
from .points import block_counts, lattice
from .scene import Block, Scene, Sphere
from .simulation import Simulation, Task
from .store import RunFolder, commit, machine, now
from .tasks import History, ProgressBar, Snapshots

BYTES_PER_POINT = 190  # fields, indices and the sort's scratch, fp64
BYTES_PER_NODE = 164
# Particle-steps a second a core, measured with the default scheme (benchmarks/README.md).
TYPICAL_RATE = {"avx512": 9e6, "avx2": 6e6, "scalar": 2.5e6}


def run_scene(
    scene: Scene, path: str | Path, *, threads: int | None = None, force: bool = False, progress: bool = True
) -> tuple[RunFolder, bool]:
    """Run a scene into a folder. Returns the folder and whether the run was finished (not interrupted)."""
    simulation = Simulation(scene, threads)
    folder = RunFolder.create(path, scene, force=force)
    started = now()
    tasks: list[Task] = [History(folder, scene.output.history), Snapshots(folder, scene.output.snapshots)]
    bar = ProgressBar(simulation) if progress else None
    status = "failed"
    try:
        simulation.run(tasks, watch=bar.watch if bar else None)
        status = "finished"
    except KeyboardInterrupt:
        status = "interrupted"
        for task in tasks:
            task.act(simulation)
    except RuntimeError as error:
        raise PockmarkError(f"{path}: the run stopped at {simulation.time:.4g} s: {error}") from None
    finally:
        if bar:
            bar.close()
        folder.write_manifest(_manifest(simulation, status, started))
    return folder, status == "finished"


def _manifest(simulation: Simulation, status: str, started: str) -> dict[str, Any]:
    scene = simulation.scene
    return {
        "status": status,
        "pockmark": __version__,
        "commit": commit(),
        "scene_hash": scene.hash,
        "started": started,
        "ended": now(),
        "machine": machine(),
        "threads": simulation.threads,
        "options": scene.numerics.model_dump(),
        "failure_treatment": treatments(scene),
        "run": {
            "points": simulation.points
            + simulation.counters()["left_points"]
            + simulation.counters()["lost_points"],
            "cells": scene.grid.cell_count,
            "steps": simulation.steps,
            "time": simulation.time,
            "particle_steps_per_second": simulation.rate,
            "max_compression": simulation.max_compression,
        },
        "ledger": simulation.ledger(),
        "counters": simulation.counters(),
        "timers": simulation.timers(),
        "memory_bytes": simulation.memory(),
    }


def treatments(scene: Scene) -> str:
    """The failure treatment of each material used, as "material: treatment"."""
    used = dict.fromkeys(b.material for b in scene.body)
    return ", ".join(f"{name}: {scene.materials[name].failure.treatment}" for name in used)


def measure_run(path: str | Path) -> dict[str, Any]:
    """Crater, energies, run figures and counters of a run folder, SI; the keys are stable."""
    folder = RunFolder.open(path)
    scene, manifest = folder.scene(), folder.manifest()
    if not {"run", "options", "ledger", "counters", "failure_treatment"} <= manifest.keys():
        raise PockmarkError(f"{path}: the run has not ended (status '{manifest.get('status')}')")
    numerics = manifest["options"]
    run = manifest["run"] | {
        "failure_treatment": manifest["failure_treatment"],
        "scheme": numerics["scheme"],
        "shape_functions": numerics["shape_functions"],
        "precision": numerics["precision"],
        "status": manifest["status"],
    }
    table = results.result_table(
        _crater(folder, scene), _projectile_diameter(scene), manifest["ledger"], run, manifest["counters"]
    )
    history = folder.history()
    table["energy"]["ledger_error_max"] = float(
        np.abs(history["error"]).max() / (history["initial"][0] or 1.0)
    )
    return table


def plot_run(path: str | Path, out: str | Path | None = None) -> list[Path]:
    """Draw crater.png (slice panels of the last snapshot) and history.png. Returns the files."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    target = Path(out) if out else folder.path
    snapshot = folder.last_snapshot()
    title = scene.title or folder.path.name
    figures = {
        "crater.png": slice_figure(
            snapshot,
            bodies_projectile=scene.projectiles,
            spacing=_target_spacing(scene),
            crater=_crater(folder, scene),
            title=f"{title}, {float(snapshot['time'][0]) * 1e9:.0f} ns",
        ),
        "history.png": history_figure(folder.history()),
    }
    try:
        target.mkdir(parents=True, exist_ok=True)
        for name, figure in figures.items():
            figure.savefig(target / name, dpi=150)
    except OSError as error:
        raise PockmarkError(f"{target}: {error.strerror}") from None
    return [target / name for name in figures]


def _crater(folder: RunFolder, scene: Scene) -> Crater | None:
    if not scene.targets:
        return None
    return results.crater_of(
        folder.last_snapshot(), target_bodies=scene.targets, spacing=_target_spacing(scene), half=scene.half
    )


def _target_spacing(scene: Scene) -> float:
    return scene.body[scene.targets[0] if scene.targets else 0].spacing


def _projectile_diameter(scene: Scene) -> float:
    """Diameter of the first projectile as it was discretised, m; 0 without one."""
    if not scene.projectiles:
        return 0.0
    body = scene.body[scene.projectiles[0]]
    if isinstance(body, Sphere):
        return 2 * max(1, round(body.radius / body.spacing)) * body.spacing
    return body.upper[2] - body.lower[2]


@dataclass(frozen=True)
class Forecast:
    """What a run will take, before anything runs."""

    points: int
    cells: int
    steps: int
    memory: float  # bytes
    seconds: float
    warnings: list[str] = field(default_factory=list)


def forecast(scene: Scene, threads: int) -> Forecast:
    """Points, cells, steps, memory and time of a scene, with warnings."""
    points = sum(_point_count(scene, i) for i in range(len(scene.body)))
    speed = max(m.dilatational_speed for m in scene.materials.values()) + scene.impact.speed
    # Shocked material is faster and strain limits some steps: 1.35 is what model 1 needed.
    steps = math.ceil(1.35 * scene.end_time / (scene.numerics.cfl * scene.grid.cell / speed))
    nodes = math.prod(n + 3 for n in scene.grid.cells)
    slower = 2.0 if scene.numerics.shape_functions == "quadratic" else 1.0
    size = 1.0 if scene.numerics.precision == "double" else 0.5
    rate = TYPICAL_RATE[_core.build_info()["isa"]] * threads
    return Forecast(
        points=points,
        cells=scene.grid.cell_count,
        steps=steps,
        memory=size * (points * BYTES_PER_POINT + nodes * BYTES_PER_NODE),
        seconds=points * steps * slower / rate,
        warnings=warnings(scene),
    )


def _point_count(scene: Scene, index: int) -> int:
    x = lattice(scene.body[index])
    lower, upper = scene.grid.lower, scene.grid.corner
    return int(((x >= lower) & (x < upper)).all(axis=1).sum())


def warnings(scene: Scene) -> list[str]:
    """What a careful analyst would ask about this scene."""
    out = []
    for i, body in enumerate(scene.body):
        lower, upper = body.box
        if isinstance(body, Sphere) and round(2 * body.radius / body.spacing) < 4:
            out.append(f"body[{i}] '{body.name}': fewer than 4 points across the sphere")
        per_cell = scene.grid.cell / body.spacing
        if per_cell < 2:
            out.append(
                f"body[{i}] '{body.name}': {per_cell:.2g} points a cell along an axis; 2 is the usual least"
            )
        if abs(off := _surface_offset(body)) > 0.01 * body.spacing:
            out.append(
                f"body[{i}] '{body.name}': its points' surface lies {off * 1e6:+.3g} um from the written one, as its "
                "spacing does not divide its size"
            )
        if not body.projectile:
            continue
        diameter = upper[2] - lower[2]
        for axis, name in ((0, "x"), (1, "y")):
            faces = (scene.boundary.faces[2 * axis], scene.boundary.faces[2 * axis + 1])
            gaps = (lower[axis] - scene.grid.lower[axis], scene.grid.corner[axis] - upper[axis])
            near = [g for g, f in zip(gaps, faces, strict=True) if f != "symmetry" and g < 2 * diameter]
            if near:
                out.append(
                    f"body[{i}] '{body.name}': {min(near) * 1e6:.3g} um from a face along {name}, less than two "
                    "diameters; the crater may feel it"
                )
    for name in dict.fromkeys(b.material for b in scene.body):
        out += _failure_warning(name, scene)
    return out


def _surface_offset(body: Block | Sphere) -> float:
    """How far the points reach beyond a block's upper face in z, or a sphere's radius, m; negative if short of it."""
    if isinstance(body, Sphere):
        return max(1, round(body.radius / body.spacing)) * body.spacing - body.radius
    return block_counts(body)[2] * body.spacing - (body.upper[2] - body.lower[2])


def _failure_warning(name: str, scene: Scene) -> list[str]:
    f = scene.materials[name].failure
    if f.treatment == "inactive" or f.D2 == 0.0 or f.D3 == 0.0 or -f.D1 / f.D2 <= 0.0:
        return []
    limit = math.log(-f.D1 / f.D2) / f.D3
    return [
        f"material '{name}': its failure strain is <= 0 above a triaxiality of {limit:.4f}; there the treatment "
        f"'{f.treatment}' decides the crater"
    ]
