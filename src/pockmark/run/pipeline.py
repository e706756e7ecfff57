"""A run from scene to measured folder."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from ..base.counters import GONE
from ..base.errors import PockmarkError
from ..base.files import AnyPath
from ..base.lengths import in_metres
from ..scene.scene import Scene
from ..scene.warnings import MIN_CELLS_ACROSS, cells_across, is_too_coarse
from .provenance import now
from .simulation import Simulation, Task
from .stop import heard_between_steps
from .store import RunFolder
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
            f"grid.cell: {in_metres(scene.grid.cell)} puts {cells_across(scene):.3g} cells across the projectile, at least "
            f"{MIN_CELLS_ACROSS} are needed; --coarse (in Python coarse=True) runs it nevertheless"
        )
    with heard_between_steps() as stop_if_asked:
        RunFolder(path).require_free(force=force)  # said before millions of points are laid
        simulation = Simulation(scene, threads)
        stop_if_asked()  # before `force` replaces a run
        folder = RunFolder.create(path, scene, force=force)
        status = _run_into(folder, simulation, stop_if_asked, progress=progress)
    return folder, status == "finished"


def _run_into(
    folder: RunFolder, simulation: Simulation, stop_if_asked: Callable[[], None], *, progress: bool
) -> str:
    """Step a simulation to its end, write what happens into its folder, and return how it ended: finished or interrupted."""
    began, scene = folder.manifest(), simulation.scene
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
            folder.write_manifest(began | _end(simulation, status) | {"doubts": history.doubts.sentences()})
        finally:
            folder.release()
        if bar:
            bar.close()
    return status


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
    """Return the failure treatment, or else the model, of each material used, as "material: treatment"."""
    used = dict.fromkeys(b.material for b in scene.body)
    laws = {name: scene.materials[name].failure for name in used}
    return ", ".join(f"{name}: {getattr(law, 'treatment', law.model)}" for name, law in laws.items())
