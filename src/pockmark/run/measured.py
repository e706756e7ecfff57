"""The way from a run folder to its measures."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..base.errors import PockmarkError
from ..base.files import AnyPath
from ..base.geometry import Setup
from ..base.json import finite
from ..metrology import results
from ..metrology.measures import UNWARNED, measures, surface_of, worst_error
from ..metrology.surface import Surface
from ..scene.scene import Scene
from ..scene.warnings import lasting_warnings
from ..view.report import standing
from .doubts import doubts
from .pipeline import figures_of, treatments
from .resolution import resolution_of
from .setup import setup_of
from .simulation import Simulation
from .snapshot import Snapshot
from .store import UNENDED, RunFolder


def measure(run: AnyPath | Simulation) -> dict[str, Any]:
    """Return crater, energies, figures of the run and counters, SI, of a run folder or of a simulation as it is now.

    The keys are stable, and the same for both. Raises PockmarkError for what is no run folder, or is damaged.
    """
    return measure_simulation(run) if isinstance(run, Simulation) else measure_run(run)


@UNWARNED
def measure_simulation(simulation: Simulation) -> dict[str, Any]:
    """Return the measures of a simulation as it is now.

    Those of a run's history, such as the depth's change in its last tenth, are None: a run folder has them.
    """
    scene, counters, ledger = simulation.scene, simulation.counters(), simulation.ledger()
    snapshot = simulation.snapshot() | {"time": np.array([simulation.time])}
    status = "finished" if simulation.time >= simulation.end_time else "running"
    run = figures_of(simulation) | _method(scene)
    run |= {"status": status, "torn_rows": 0, "end_time": simulation.end_time}
    table = measures(snapshot, setup_of(scene), ledger, run, counters, {})
    error = abs(ledger["error"]) / ledger["initial"] if ledger["initial"] else 0.0
    return _complete(table, scene, doubts(counters, error, simulation.time))


@UNWARNED
def measure_run(path: AnyPath) -> dict[str, Any]:
    """Return crater, energies, figures of the run and counters of a run folder, SI.

    The keys are stable. Raises PockmarkError for what is no run folder, or is damaged.
    """
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    record = folder.record(scene.grid.cell_count)
    run = record.run.model_dump() | _method(scene)
    run |= {"status": status, "torn_rows": folder.rows().torn, "end_time": scene.end_time}
    history = folder.history("error", "initial")
    snapshot = in_the_grid(folder.last_snapshot(), scene)
    table = measures(snapshot, setup_of(scene), record.joules, run, record.counters, history)
    late = [] if status in UNENDED else _late_warning(float(snapshot["time"][0]), record.run.time)
    table["warnings"] = late + table["warnings"]
    said = record.doubts
    if said is None:  # the run did not come to say them
        worst, when = worst_error(history) or (0.0, None)
        said = doubts(record.counters, worst if when is not None else 0.0, when or 0.0)
    return _complete(table, scene, said)


def _method(scene: Scene) -> dict[str, Any]:
    """Return how a scene is computed, as the table of a run has it."""
    keys = ("scheme", "shape_functions", "volumetric_strain", "node_velocity", "precision")
    told = {"failure_treatment": treatments(scene)} | {key: getattr(scene.numerics, key) for key in keys}
    return told | {"filter_interval": scene.numerics.filter.interval}


def _complete(table: dict[str, Any], scene: Scene, doubts: Sequence[str]) -> dict[str, Any]:
    """Return the measures with what the scene adds to them, and with the doubts of the run."""
    table["warnings"] = [*dict.fromkeys(table["warnings"] + lasting_warnings(scene))]
    table["resolution"] = resolution_of(scene)
    table["doubts"], table["run"]["doubtful"] = [*doubts], bool(doubts)
    return dict(finite(table))


def _late_warning(snapshot_time: float, end: float) -> list[str]:
    """Say that the last snapshot is not of the time (s) at which the run ended, if that is so.

    Its file may have been removed.
    """
    if abs(snapshot_time - end) <= 1e-9 * end:
        return []
    return [
        f"the last snapshot is of {snapshot_time * 1e9:.4g} ns, but the run ended at {end * 1e9:.4g} ns: the crater and the energies "
        "below are of different times (is a snapshot missing?)"
    ]


@UNWARNED
def surface_of_run(path: AnyPath) -> Surface | None:
    """Return the target's surface near the crater in the last snapshot of a run folder.

    None if nothing below z = 0 is open. Raises PockmarkError.
    """
    folder = RunFolder.open(path)
    scene = folder.scene()
    return surface_in(in_the_grid(folder.last_snapshot(), scene), setup_of(scene))


def standing_of(path: AnyPath) -> str:
    """Return how a run that has not ended stands, in a sentence; an empty text for one that has ended."""
    folder = RunFolder.open(path)
    rows, snapshot = folder.rows(), folder.last_snapshot()
    return standing(folder.status(), rows.last["time"], float(snapshot["time"][0]), rows.torn)


def in_the_grid(snapshot: Snapshot, scene: Scene) -> Snapshot:
    """Return the snapshot. Raises PockmarkError if a point is of no body or outside of the grid.

    The measures lay out memory over all points: a single one far away would take all that there is.
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


def surface_in(snapshot: Snapshot, setup: Setup) -> Surface | None:
    """Return the target's surface near the crater in a snapshot; None if nothing below z = 0 is open."""
    return surface_of(results.filling_of(snapshot, setup))
