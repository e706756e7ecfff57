"""A run from scene to measured folder."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from . import results
from .counters import GONE
from .doubts import doubts
from .errors import PockmarkError
from .files import AnyPath, as_path, replaced, told
from .forecast import MIN_CELLS_ACROSS, cells_across, is_too_coarse, lasting_warnings
from .geometry import Setup
from .hole import measure_hole
from .measures import UNWARNED, measures, surface_of, worst_error
from .plots import HISTORY_COLUMNS, history_figure, process_figure, slice_figure
from .report import standing
from .scene import Scene
from .setup import setup_of
from .simulation import Simulation, Task
from .snapshot import Snapshot
from .stop import heard_between_steps
from .store import UNENDED, RunFolder, finite, now
from .surface import Surface
from .tasks import History, ProgressBar, Snapshots


def run_scene(
    scene: Scene,
    path: AnyPath,
    *,
    threads: int | None = None,
    force: bool = False,
    progress: bool = True,
    coarse: bool = False,
) -> tuple[RunFolder, bool]:
    """Run a scene into a folder. Returns the folder and whether the run was finished (not interrupted).

    Raises PockmarkError, too, where fewer than four cells lie across a projectile, unless `coarse` allows it.
    """
    if is_too_coarse(scene) and not coarse:
        raise PockmarkError(
            f"grid.cell: {scene.grid.cell * 1e6:.4g} um puts {cells_across(scene):.3g} cells across the projectile, at least "
            f"{MIN_CELLS_ACROSS} are needed; --coarse (in Python coarse=True) runs it nevertheless"
        )
    with heard_between_steps() as stop_if_asked:
        RunFolder(path).require_free(force=force)  # said before millions of points are laid
        simulation = Simulation(scene, threads)
        stop_if_asked()  # before `force` replaces a run
        folder = RunFolder.create(path, scene, force=force)
        began = folder.manifest()
        history = History(folder, scene.output.history)
        tasks: list[Task] = [history, Snapshots(folder, scene.output.snapshots)]
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
                raise PockmarkError(f"{folder.path}: {when}: {error}") from None
            raise
        finally:
            try:
                folder.write_manifest(
                    began | _end(simulation, status) | {"doubts": history.doubts.sentences()}
                )
            finally:
                folder.release()
            if bar:
                bar.close()
    return folder, status == "finished"


def _write_last(tasks: Sequence[Task], simulation: Simulation) -> None:
    """Write a last row and snapshot, so that the crater and the energies that are measured are of the same time."""
    for task in tasks:
        task.act(simulation)


def _end(simulation: Simulation, status: str) -> dict[str, Any]:
    """Return what a run's manifest says at the end, beside what it has said from the start on."""
    scene, counters = simulation.scene, simulation.counters()
    return {
        "status": status,
        "ended": now(),
        "threads": simulation.threads,
        "failure_treatment": treatments(scene),
        "run": {
            "points": simulation.points + sum(counters[name] for name in GONE),
            "cells": scene.grid.cell_count,
            "steps": simulation.steps,
            "time": simulation.time,
            "particle_steps_per_second": simulation.rate,
            "max_compression": simulation.max_compression,
        },
        "ledger": simulation.ledger(),
        "counters": counters,
        "timers": simulation.timers(),
        "memory_bytes": simulation.memory(),
    }


def treatments(scene: Scene) -> str:
    """Return the failure treatment of each material used, as "material: treatment"."""
    used = dict.fromkeys(b.material for b in scene.body)
    return ", ".join(f"{name}: {scene.materials[name].failure.treatment}" for name in used)


@UNWARNED
def measure_run(path: AnyPath) -> dict[str, Any]:
    """Measure crater, energies, run figures and counters of a run folder, SI; the keys are stable."""
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    record = folder.record(scene.grid.cell_count)
    run = record.run.model_dump() | {
        "failure_treatment": treatments(scene),
        "scheme": scene.numerics.scheme,
        "shape_functions": scene.numerics.shape_functions,
        "precision": scene.numerics.precision,
        "status": status,
        "torn_rows": folder.rows().torn,
        "end_time": scene.end_time,
    }
    history = folder.history("error", "initial")
    snapshot = _in_the_grid(folder.last_snapshot(), scene)
    table = measures(snapshot, setup_of(scene), record.joules, run, record.counters, history)
    late = [] if status in UNENDED else _late_warning(float(snapshot["time"][0]), record.run.time)
    table["warnings"] = [*dict.fromkeys(late + table["warnings"] + lasting_warnings(scene))]
    said = record.doubts
    if said is None:  # the run did not come to say them
        worst, when = worst_error(history) or (0.0, None)
        said = doubts(record.counters, worst if when is not None else 0.0, when or 0.0)
    table["doubts"], table["run"]["doubtful"] = [*said], bool(said)
    return dict(finite(table))


def _late_warning(snapshot_time: float, end: float) -> list[str]:
    """Say where the last snapshot is not of the time (s) at which the run ended: its file may have been removed."""
    if abs(snapshot_time - end) <= 1e-9 * end:
        return []
    return [
        f"the last snapshot is of {snapshot_time * 1e9:.4g} ns, but the run ended at {end * 1e9:.4g} ns: the crater and the energies "
        "below are of different times (is a snapshot missing?)"
    ]


@UNWARNED
def plot_run(path: AnyPath, out: AnyPath | None = None) -> list[Path]:
    """Draw crater.png (slice panels of the last snapshot) and history.png. Returns the files."""
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    target = as_path(out) if out else folder.path
    snapshot, setup = _in_the_grid(folder.last_snapshot(), scene), setup_of(scene)
    title = scene.title or folder.path.name
    surface = _surface(snapshot, setup)
    figures = {
        "crater.png": slice_figure(
            snapshot,
            setup,
            crater=results.crater_of(surface, setup.heading),
            is_perforated=surface is not None and measure_hole(surface) is not None,
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


@UNWARNED
def surface_of_run(path: AnyPath) -> Surface | None:
    """Return the target's surface near the crater in the last snapshot of a run folder; None if there is no crater."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    return _surface(_in_the_grid(folder.last_snapshot(), scene), setup_of(scene))


@UNWARNED
def plot_process(path: AnyPath) -> Figure:
    """Draw stress and pressure in the last four snapshots of a run folder."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    snapshots = [_in_the_grid(folder.snapshot(file), scene) for file in folder.snapshots()[-4:]]
    if not snapshots:
        raise PockmarkError(f"{folder.path}: holds no snapshot")
    return process_figure(snapshots, setup_of(scene))


def standing_of(path: AnyPath) -> str:
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


def _surface(snapshot: Snapshot, setup: Setup) -> Surface | None:
    return surface_of(results.field_of(snapshot, setup))
