"""A run from scene to measured folder."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from . import cautions, results
from .bodies import Block, Swarm
from .doubts import doubts
from .errors import PockmarkError
from .files import replaced, told
from .forecast import MIN_CELLS_ACROSS, cells_across, frame_warnings, is_too_coarse
from .hole import measure_hole
from .lattice import count, point_volume
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
from .wall import first_wall, walls

# What a measure makes of absurd fields is no number then: null in the table, and a sentence, not a warning of NumPy's.
UNWARNED = np.errstate(all="ignore")


def run_scene(
    scene: Scene,
    path: str | Path,
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
        RunFolder(Path(path)).require_free(force=force)  # said before millions of points are laid
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
                raise PockmarkError(f"{path}: {when}: {error}") from None
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
    """Return the failure treatment, or else the model, of each material used, as "material: treatment"."""
    used = dict.fromkeys(b.material for b in scene.body)
    laws = {name: scene.materials[name].failure for name in used}
    return ", ".join(f"{name}: {getattr(law, 'treatment', law.model)}" for name, law in laws.items())


@UNWARNED
def measure_run(path: str | Path) -> dict[str, Any]:
    """Measure crater, energies, run figures and counters of a run folder, SI; the keys are stable."""
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
    history = folder.history("error", "initial")
    snapshot = _in_the_grid(folder.last_snapshot(), scene)
    table = measures(snapshot, scene, ledger, run, record.counters, history, record.doubts)
    return dict(finite(table))


def measures(
    snapshot: Mapping[str, NDArray[Any]],
    scene: Scene,
    ledger: Mapping[str, float],
    run: Mapping[str, Any],
    counters: Mapping[str, int],
    history: Mapping[str, NDArray[np.float64]],
    said: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Return the tables of `measure_run`, of the state in a snapshot and what a run says of itself; the doubts that it `said`, None for
    a run that did not come to say them."""
    wall = first_wall(scene)
    field = results.field_of(snapshot, wall, scene.mirrors)
    surface = _surface(field)
    crater, mass = results.crater_of(surface, scene.impact.heading), _projectile_mass(scene)
    hole = None if surface is None else measure_hole(surface)
    is_open = surface is not None and bool(surface.holes.any())
    cells = cells_across(scene)
    table = results.result_table(
        crater,
        float(snapshot["time"][0]),
        _projectile_diameter(scene),
        ledger,
        dict(run) | {"cells_across_projectile": cells},
        counters,
    )
    table["crater"] |= results.morphology_table(
        snapshot,
        field,
        crater,
        projectile_bodies=scene.projectiles,
        projectile_mass=mass,
        spacing=_target_spacing(scene),
        mirrors=scene.mirrors,
        heading=scene.impact.heading,
    )
    no_wall = [*cautions.missing(snapshot, scene, wall)]
    is_told = not no_wall and (hole is not None or not is_open)
    table["crater"] |= results.hole_table(field, hole) if is_told else dict.fromkeys(results.HOLE)
    change = (
        results.depth_change(history["time"], history["depth"])
        if {"time", "depth"} <= history.keys()
        else None
    )
    table["crater"]["depth_change_last_tenth"] = change
    if group := group_of(surface, scene):
        table["group"] = results.group_table(
            group, oblique=scene.impact.angle != 0, heading=scene.impact.heading
        )
    table["ejecta"] = results.ejecta_table(
        snapshot,
        ledger,
        projectile_momentum=-mass * scene.impact.velocity[2],
        spacing=_target_spacing(scene),
        mirrors=scene.mirrors,
        walls=walls(scene),
        is_open=is_open,
    )
    table["warnings"] = [
        *no_wall,
        *cautions.of_hole(hole, surface, wall),
        *cautions.of_crater(crater, surface, wall, scene.mirrors),
        *cautions.of_resolution(wall, cells, change),
        *frame_warnings(scene),
    ]
    error = _ledger_error(history)
    worst = int(np.argmax(error)) if len(error) else None
    table["energy"]["ledger_error_max"] = None if worst is None else float(error[worst])
    if said is None:
        known = worst is not None and "time" in history
        share, when = (float(error[worst]), float(history["time"][worst])) if known else (0.0, 0.0)
        said = doubts(counters, share, when)
    table["doubts"], table["run"]["doubtful"] = [*said], bool(said)
    return table


def _ledger_error(history: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the size of the ledger error in each row, as a share of the initial energy; empty where there is none."""
    if (
        not {"error", "initial"} <= history.keys()
        or not len(history["initial"])
        or not history["initial"][0] > 0
    ):
        return np.zeros(0)
    return np.asarray(np.abs(history["error"]) / history["initial"][0])


@UNWARNED
def plot_run(path: str | Path, out: str | Path | None = None) -> list[Path]:
    """Draw crater.png (slice panels of the last snapshot) and history.png. Returns the files."""
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    target = Path(out) if out else folder.path
    snapshot = _in_the_grid(folder.last_snapshot(), scene)
    title = scene.title or folder.path.name
    surface = _surface(_field(snapshot, scene))
    figures = {
        "crater.png": slice_figure(
            snapshot,
            _cast(scene),
            plane=_slice_plane(scene),
            across=_slice_axis(scene),
            spacing=_target_spacing(scene),
            crater=results.crater_of(surface, scene.impact.heading),
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


def group_of(surface: Surface | None, scene: Scene) -> Group | None:
    """Return the craters of the scene's swarm in the surface that it left; None without a swarm or a crater."""
    swarms = [body for i in scene.projectiles if isinstance(body := scene.body[i], Swarm)]
    if not swarms or surface is None:
        return None
    centers = np.array(swarms[0].centers)
    x, y, z = scene.impact.velocity
    hits = centers[:, :2] + np.outer(centers[:, 2], [x / -z, y / -z] if z else [0.0, 0.0])
    for mirror in scene.mirrors:
        hits = with_image(hits, mirror)
    return measure_group(surface, hits, swarms[0].distance)


@UNWARNED
def surface_of_run(path: str | Path) -> Surface | None:
    """Return the target's surface near the crater in the last snapshot of a run folder; None if there is no crater."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    return _surface(_field(_in_the_grid(folder.last_snapshot(), scene), scene))


@UNWARNED
def plot_process(path: str | Path) -> Figure:
    """Draw stress and pressure in the last four snapshots of a run folder."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    snapshots = [_in_the_grid(Snapshot(file), scene) for file in folder.snapshots()[-4:]]
    if not snapshots:
        raise PockmarkError(f"{path}: holds no snapshot")
    return process_figure(
        snapshots,
        _cast(scene),
        plane=_slice_plane(scene),
        across=_slice_axis(scene),
        spacing=_target_spacing(scene),
    )


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
    return results.field_of(snapshot, first_wall(scene), scene.mirrors)


def _surface(field: Field | None) -> Surface | None:
    return None if field is None else field.surface()


def _cast(scene: Scene) -> Cast:
    return Cast([body.name for body in scene.body], scene.projectiles)


def _slice_axis(scene: Scene) -> int:
    """Return the axis across the picture's slice: y, or x where the projectiles move rather along y."""
    x, y = scene.impact.heading
    return 1 if abs(x) >= abs(y) else 0


def _slice_plane(scene: Scene) -> float:
    """Return where the picture's slice lies on that axis, m: at a symmetry plane, or else through the first projectile."""
    axis = _slice_axis(scene)
    for mirror in scene.mirrors:
        if mirror.axis == axis:
            return mirror.at
    if scene.projectiles:
        return scene.body[scene.projectiles[0]].axis[axis]
    return (scene.grid.lower[axis] + scene.grid.corner[axis]) / 2


def _target_spacing(scene: Scene) -> float:
    """Return the coarsest of the target's, m; the projectile's where there is no target."""
    return max(scene.body[i].spacing for i in scene.targets or scene.projectiles)


def _projectile_mass(scene: Scene) -> float:
    """Return the mass of the projectiles' points at the start, kg, of what is computed."""
    bodies = [scene.body[i] for i in scene.projectiles]
    return sum(
        count(b, scene.grid.box) * point_volume(b) * scene.materials[b.material].density for b in bodies
    )


def _projectile_diameter(scene: Scene) -> float:
    """Return the diameter of the first projectile, a block's height, as its points fill it, m; 0 without one."""
    if not scene.projectiles:
        return 0.0
    body = scene.body[scene.projectiles[0]]
    return body.fits[2].length if isinstance(body, Block) else 2 * body.fit.length
