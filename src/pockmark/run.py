"""A run from scene to measured folder."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from . import results
from .bodies import Block, Swarm
from .errors import PockmarkError
from .files import replaced, told
from .lattice import count
from .morphology import Group, measure_group
from .plots import HISTORY_COLUMNS, Cast, history_figure, process_figure, slice_figure
from .report import standing
from .scene import Scene
from .simulation import Simulation, Task
from .snapshot import Snapshot
from .stop import heard_between_steps
from .store import UNENDED, RunFolder, finite, now
from .surface import Field, Surface, with_image
from .tasks import History, ProgressBar, Snapshots


def run_scene(
    scene: Scene, path: str | Path, *, threads: int | None = None, force: bool = False, progress: bool = True
) -> tuple[RunFolder, bool]:
    """Run a scene into a folder. Returns the folder and whether the run was finished (not interrupted)."""
    with heard_between_steps() as stop_if_asked:
        RunFolder(Path(path)).require_free(force=force)  # said before millions of points are laid
        simulation = Simulation(scene, threads)
        stop_if_asked()  # before `force` replaces a run
        folder = RunFolder.create(path, scene, force=force)
        began = folder.manifest()
        tasks: list[Task] = [History(folder, scene.output.history), Snapshots(folder, scene.output.snapshots)]
        status = "failed"
        bar = ProgressBar(simulation) if progress else None

        def watch(simulation: Simulation) -> None:
            if bar:
                bar.watch(simulation)
            stop_if_asked()

        try:
            simulation.run(tasks, watch=watch)
            status = "finished"
        except KeyboardInterrupt:
            status = "interrupted"
            _write_last(tasks, simulation)
        except Exception as error:
            with suppress(PockmarkError, MemoryError):  # what stopped the run may stop this too
                _write_last(tasks, simulation)
            if isinstance(error, RuntimeError):
                when = f"the run stopped at {simulation.time:.4g} s"
                raise PockmarkError(f"{path}: {when}: {error}") from None
            raise
        finally:
            try:
                folder.write_manifest(began | _end(simulation, status))
            finally:
                folder.release()
            if bar:
                bar.close()
    return folder, status == "finished"


def _write_last(tasks: Sequence[Task], simulation: Simulation) -> None:
    """A last row and snapshot, so that the crater and the energies that are measured are of the same time."""
    for task in tasks:
        task.act(simulation)


def _end(simulation: Simulation, status: str) -> dict[str, Any]:
    """What a run's manifest says at the end, beside what it has said from the start on."""
    scene = simulation.scene
    return {
        "status": status,
        "ended": now(),
        "threads": simulation.threads,
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
    scene, status = folder.scene(), folder.status()
    record = folder.record(scene.grid.cell_count)
    ledger = record.joules
    run = record.run.model_dump() | {
        "failure_treatment": treatments(scene),
        "scheme": scene.numerics.scheme,
        "shape_functions": scene.numerics.shape_functions,
        "precision": scene.numerics.precision,
        "status": status,
        "torn_rows": folder.rows().torn,
        "end_time": scene.end_time,
    }
    snapshot = _in_the_grid(folder.last_snapshot(), scene)
    field = _field(snapshot, scene)
    surface = _surface(field)
    crater, mass = results.crater_of(surface), _projectile_mass(scene)
    table = results.result_table(
        crater,
        float(snapshot["time"][0]),
        _projectile_diameter(scene),
        ledger,
        run,
        record.counters,
    )
    table["crater"] |= results.morphology_table(
        snapshot,
        field,
        crater,
        projectile_bodies=scene.projectiles,
        projectile_mass=mass,
        spacing=_target_spacing(scene),
        mirrors=scene.mirrors,
    )
    if group := group_of(surface, scene):
        table["group"] = results.group_table(group, oblique=scene.impact.angle > 0)
    table["ejecta"] = results.ejecta_table(
        snapshot,
        ledger,
        projectile_momentum=-mass * scene.impact.velocity[2],
        spacing=_target_spacing(scene),
        mirrors=scene.mirrors,
    )
    history = folder.history("error", "initial")
    initial = float(history["initial"][0])
    table["energy"]["ledger_error_max"] = float(np.abs(history["error"]).max()) / initial if initial else None
    return dict(finite(table))


def plot_run(path: str | Path, out: str | Path | None = None) -> list[Path]:
    """Draw crater.png (slice panels of the last snapshot) and history.png. Returns the files."""
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    target = Path(out) if out else folder.path
    snapshot = _in_the_grid(folder.last_snapshot(), scene)
    title = scene.title or folder.path.name
    figures = {
        "crater.png": slice_figure(
            snapshot,
            _cast(scene),
            plane=_slice_plane(scene),
            spacing=_target_spacing(scene),
            crater=results.crater_of(_surface(_field(snapshot, scene))),
            title=f"{title}, {float(snapshot['time'][0]) * 1e9:.0f} ns"
            + (f" ({status})" if status in UNENDED else ""),
        ),
        "history.png": history_figure(folder.history(*HISTORY_COLUMNS)),
    }
    with told(target):
        target.mkdir(parents=True, exist_ok=True)
    for name, figure in figures.items():
        with replaced(target / name) as descriptor, open(descriptor, "wb", closefd=False) as file:
            figure.savefig(file, format="png", dpi=150)
    return [target / name for name in figures]


def group_of(surface: Surface | None, scene: Scene) -> Group | None:
    """The craters of the scene's swarm in the surface that it left; None without a swarm or a crater."""
    swarms = [body for i in scene.projectiles if isinstance(body := scene.body[i], Swarm)]
    if not swarms or surface is None:
        return None
    centers = np.array(swarms[0].centers)
    hits = centers[:, :2] + np.outer(centers[:, 2], [math.tan(scene.impact.angle), 0.0])
    for mirror in scene.mirrors:
        hits = with_image(hits, mirror)
    return measure_group(surface, hits, swarms[0].distance)


def surface_of_run(path: str | Path) -> Surface | None:
    """The target's surface near the crater in the last snapshot of a run folder; None if there is no crater."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    return _surface(_field(_in_the_grid(folder.last_snapshot(), scene), scene))


def plot_process(path: str | Path) -> Figure:
    """Stress and pressure in the last four snapshots of a run folder."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    snapshots = [_in_the_grid(Snapshot(file), scene) for file in folder.snapshots()[-4:]]
    if not snapshots:
        raise PockmarkError(f"{path}: holds no snapshot")
    return process_figure(snapshots, _cast(scene), plane=_slice_plane(scene), spacing=_target_spacing(scene))


def standing_of(path: str | Path) -> str:
    """Return how a run that has not ended stands, in one sentence; an empty text for one that has ended."""
    folder = RunFolder.open(path)
    rows, snapshot = folder.rows(), folder.last_snapshot()
    return standing(folder.status(), rows.last["time"], float(snapshot["time"][0]), rows.torn)


def _in_the_grid(snapshot: Snapshot, scene: Scene) -> Snapshot:
    """Return the snapshot. Raises PockmarkError if a point is of no body or outside of the grid.

    Memory for the measures is laid out over all points: one of them far away would take all that there is.
    """
    position, cell = snapshot["position"], scene.grid.cell
    lower, upper = (np.array(corner) for corner in scene.grid.box)
    far = ((position < lower - cell) | (position > upper + cell)).any(axis=1)
    if far.any():
        place = ", ".join(f"{x * 1e6:.4g}" for x in position[np.argmax(far)])
        raise PockmarkError(f"{snapshot.path}: a point lies outside of the grid, at ({place}) um")
    if (highest := int(snapshot["body"].max(initial=0))) >= len(scene.body):
        raise PockmarkError(
            f"{snapshot.path}: a point is of body {highest}, but {len(scene.body)} bodies are known"
        )
    return snapshot


def _field(snapshot: Mapping[str, NDArray[Any]], scene: Scene) -> Field | None:
    return results.field_of(
        snapshot,
        target_bodies=scene.targets,
        spacing=_target_spacing(scene),
        mirrors=scene.mirrors,
    )


def _surface(field: Field | None) -> Surface | None:
    return None if field is None else field.surface()


def _cast(scene: Scene) -> Cast:
    return Cast([body.name for body in scene.body], scene.projectiles)


def _slice_plane(scene: Scene) -> float:
    """The y of the picture's slice, m: a symmetry plane, or else through the first projectile."""
    for mirror in scene.mirrors:
        if mirror.axis == 1:
            return mirror.at
    if scene.projectiles:
        return scene.body[scene.projectiles[0]].axis[1]
    return (scene.grid.lower[1] + scene.grid.corner[1]) / 2


def _target_spacing(scene: Scene) -> float:
    return scene.body[scene.targets[0] if scene.targets else 0].spacing


def _projectile_mass(scene: Scene) -> float:
    """Mass of the projectiles' points at the start, kg, of what is computed."""
    bodies = [scene.body[i] for i in scene.projectiles]
    return sum(count(b, scene.grid.box) * b.spacing**3 * scene.materials[b.material].density for b in bodies)


def _projectile_diameter(scene: Scene) -> float:
    """Diameter of the first projectile as it was discretised, m; 0 without one."""
    if not scene.projectiles:
        return 0.0
    body = scene.body[scene.projectiles[0]]
    if not isinstance(body, Block):
        return 2 * body.balls[0].reach * body.spacing
    return body.upper[2] - body.lower[2]
