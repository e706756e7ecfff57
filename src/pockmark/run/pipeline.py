"""The way from a scene to a run folder, and on from a checkpoint."""

import numbers
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from .. import __version__
from ..base.counters import GONE
from ..base.errors import PockmarkError, found
from ..base.files import AnyPath, remove
from ..base.lengths import in_metres
from ..scene.scene import Scene
from ..scene.warnings import MIN_CELLS_ACROSS, cells_across, is_too_coarse
from .checkpoint import Checkpoint
from .extent import NOTHING, cut_back, lacking, require_extent
from .keeper import Keeper, newest_good
from .provenance import now
from .simulation import Simulation, core_name, rounded_time
from .stop import heard_between_steps
from .store import RunFolder
from .task import KeptTask, Task, kept, require_tasks
from .tasks import History, ProgressBar, Snapshots

OWN = 2  # tasks of every run: history and snapshots


class Resumed(NamedTuple):
    """A run that went on.

    `begun` is the checkpoint from which it went on, None if it began anew. `told` says of each newer checkpoint what
    is wrong with it, and what else is not as it was.
    """

    folder: RunFolder
    is_finished: bool
    begun: Checkpoint | None
    told: list[str]


def run_scene(
    scene: Scene,
    path: AnyPath,
    *,
    threads: int | None = None,
    force: bool = False,
    progress: bool = True,
    coarse: bool = False,
    tasks: Sequence[Task] = (),
) -> tuple[RunFolder, bool]:
    """Run a scene into a folder. Return the folder, and whether the run was finished (not interrupted).

    `threads` None takes every core; `force` replaces a run that is there; `progress` shows a bar. `tasks` act besides
    those that write the folder; a checkpoint keeps the state of a KeptTask. Raises PockmarkError, also where fewer
    than four cells lie across a projectile, unless `coarse` allows it.
    """
    require_cells_across(scene, coarse=coarse)
    require_tasks(tasks)
    with heard_between_steps() as stop_if_asked:
        RunFolder(path).require_free(force=force)  # told before millions of points are made
        simulation = Simulation(scene, threads)
        stop_if_asked()  # before `force` replaces a run
        folder = RunFolder.create(path, scene, force=force)
        status = _run_into(folder, simulation, stop_if_asked, tasks, progress=progress)
    return folder, status == "finished"


def require_cells_across(scene: Scene, *, coarse: bool) -> None:
    """Raise PockmarkError where fewer than four cells lie across a projectile, unless `coarse` allows it."""
    if is_too_coarse(scene) and not coarse:
        raise PockmarkError(
            f"grid.cell: {in_metres(scene.grid.cell)} puts {cells_across(scene):.3g} cells across the projectile, at least "
            f"{MIN_CELLS_ACROSS} are needed; --coarse (in Python coarse=True) runs it nevertheless"
        )


def resume_run(
    path: AnyPath,
    *,
    end_time: float | None = None,
    threads: int | None = None,
    progress: bool = True,
    tasks: Sequence[Task] = (),
) -> Resumed:
    """Go on with a run from its newest good checkpoint, to the last bit as if it had never stopped.

    `end_time` (s) may be a later end. `tasks` are as many as the run had. A run that was killed before its first
    checkpoint begins anew. Raises PockmarkError where there is nothing to go on from, or nowhere to go on to.
    """
    require_tasks(tasks)
    with heard_between_steps() as stop_if_asked:
        folder = RunFolder.open(path)
        folder.lock()
        try:
            scene = _to_the_end(folder, end_time)
            begun, damaged = _beginning(folder, scene)
            _require_tasks(folder, begun, len(tasks))
            _require_driver(folder, begun)
            told = [*damaged.values(), *_differences(folder, begun)]
            simulation = Simulation(scene, threads, parts=begun.parts if begun else None)
            stop_if_asked()  # before anything is taken off
            _go_back(folder, scene, begun)
            for path in damaged:
                remove(path)
        except BaseException:
            folder.release()
            raise
        status = _run_into(folder, simulation, stop_if_asked, tasks, progress=progress, begun=begun)
    return Resumed(folder, status == "finished", begun, told)


def _require_tasks(folder: RunFolder, begun: Checkpoint | None, number: int) -> None:
    """Raise PockmarkError unless a run goes on with as many tasks as it had."""
    if begun and (had := len(begun.acted) - OWN) != number:
        raise PockmarkError(
            f"{folder.path}: was run with tasks of its own, {had} of them, found {number}: go on in Python, with "
            "resume_run(path, tasks=...)"
        )


def _require_driver(folder: RunFolder, begun: Checkpoint | None) -> None:
    """Raise PockmarkError where a run of the plain driver, which keeps no order of points, would go on with another."""
    plain = "plain driver"
    if begun and begun.core.endswith(plain) and not core_name().endswith(plain):
        raise PockmarkError(
            f"{folder.path}: was computed by {begun.core}: it goes on with POCKMARK_DRIVER=plain"
        )


def can_resume(path: AnyPath, scene: Scene) -> bool:
    """Return whether a folder holds a stopped run of this scene, by this version, with a checkpoint."""
    try:
        folder = RunFolder.open(path)
        known = folder.manifest()
        is_ours = known.get("pockmark") == __version__ and folder.scene().hash == scene.hash
        return is_ours and known["status"] != "finished" and _beginning(folder, scene)[0] is not None
    except PockmarkError:
        return False


def _beginning(folder: RunFolder, scene: Scene) -> tuple[Checkpoint | None, dict[Path, str]]:
    """Return the checkpoint from which a run goes on, and what is wrong with newer ones.

    The checkpoint is None if the run begins anew. Raises PockmarkError where that would lose a result.
    """
    begun, damaged = newest_good(folder.path, scene.course)
    if begun is None and (damaged or folder.manifest()["status"] != "running"):
        why = next(iter(damaged.values()), "output.checkpoints was 0")
        raise PockmarkError(f"{folder.path}: has no checkpoint to go on from ({why})")
    if begun and begun.time > rounded_time(scene.end_time):
        raise PockmarkError(
            f"{folder.path}: its checkpoint is of {begun.time:.4g} s, beyond the end at {scene.end_time:.4g} s"
        )
    if begun:
        require_extent(folder, begun.files)
    return begun, damaged


def _differences(folder: RunFolder, begun: Checkpoint | None) -> list[str]:
    """Return what makes a resumed run another one than an uninterrupted run, a sentence each."""
    if begun is None:
        return []
    told = lacking(folder, begun.files)
    if begun.core != core_name():
        told.append(f"was computed by {begun.core}, goes on by {core_name()}: the last digits may differ")
    return told


def _to_the_end(folder: RunFolder, end_time: float | None) -> Scene:
    """Return the scene with which a run goes on. Raises PockmarkError if the run is at its end."""
    scene = folder.scene()
    if end_time is None and folder.manifest()["status"] == "finished":
        raise PockmarkError(f"{folder.path}: has finished; --end-time goes on past its end")
    if end_time is None:
        return scene
    if not isinstance(end_time, numbers.Real):
        raise PockmarkError(f"end_time: {found(end_time)}, expected a number of seconds")
    if not end_time >= scene.end_time:
        raise PockmarkError(
            f"end_time: found {end_time:.4g} s, the run's is {scene.end_time:.4g} s: a later one is needed"
        )
    return Scene.from_dict(scene.to_dict() | {"end_time": end_time})


def _go_back(folder: RunFolder, scene: Scene, begun: Checkpoint | None) -> None:
    """Make a folder what it was at a checkpoint, or at the start.

    If this is killed at any moment, the run can be resumed again.
    """
    known = folder.manifest()
    place = {"step": begun.step, "time": begun.time} if begun else {"step": 0, "time": 0.0}
    resumed = [*known.get("resumed", ()), {"at": now()} | place]
    kept = {key: value for key, value in known.items() if key not in ("run", "doubts", "ended")}
    folder.write_manifest(kept | {"status": "running", "resumed": resumed})
    if scene.hash != known["scene_hash"]:
        folder.change_end(scene)
    cut_back(folder, begun.files if begun else NOTHING)


def _run_into(
    folder: RunFolder,
    simulation: Simulation,
    stop_if_asked: Callable[[], None],
    own: Sequence[Task],
    *,
    progress: bool,
    begun: Checkpoint | None = None,
) -> str:
    """Step a simulation to its end, write what happens into its folder, and return how it ended.

    That is "finished" or "interrupted".
    """
    began, scene = folder.manifest(), simulation.scene
    history = History(folder, scene.output.history)
    tasks: list[KeptTask] = [history, Snapshots(folder, scene.output.snapshots), *map(kept, own)]
    keeper = Keeper(folder, tasks, scene.output.checkpoints, step=begun.step if begun else -1)
    for task, state in zip(tasks, begun.tasks if begun else (), strict=False):
        task.set_state(state)
    status = "failed"
    bar = ProgressBar(simulation) if progress else None

    def watch(simulation: Simulation) -> None:
        if bar:
            bar.watch(simulation)
        keeper.watch(simulation)
        stop_if_asked()

    try:
        simulation.run(tasks, watch=watch, acted=begun.acted if begun else None)
        status = "finished"
        keeper.finish()
    except KeyboardInterrupt:
        status = "interrupted"
        keeper.keep(simulation)  # first: what follows is written by no run that goes on
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
    """Write a last row and snapshot, so that crater and energies are measured at the same time."""
    for task in tasks:
        task.act(simulation)


def _end(simulation: Simulation, status: str) -> dict[str, Any]:
    """Return the part of a run's manifest that is written at its end."""
    return {
        "status": status,
        "ended": now(),
        "threads": simulation.threads,
        "failure_treatment": treatments(simulation.scene),
        "run": figures_of(simulation),
        "ledger": simulation.ledger(),
        "counters": simulation.counters(),
        "timers": simulation.timers(),
        "memory_bytes": simulation.memory(),
    }


def figures_of(simulation: Simulation) -> dict[str, Any]:
    """Return the figures of a simulation: points, cells, steps, time (s), particle-steps a second, rho/rho0."""
    counters = simulation.counters()
    return {
        "points": simulation.points + sum(counters[name] for name in GONE),
        "cells": simulation.scene.grid.cell_count,
        "steps": simulation.steps,
        "time": simulation.time,
        "particle_steps_per_second": simulation.rate,
        "max_compression": simulation.max_compression,
    }


def treatments(scene: Scene) -> str:
    """Return how each material used fails, as "material: treatment, ...".

    A law without a treatment is named by its model.
    """
    used = dict.fromkeys(b.material for b in scene.body)
    laws = {name: scene.materials[name].failure for name in used}
    return ", ".join(f"{name}: {getattr(law, 'treatment', law.model)}" for name, law in laws.items())
