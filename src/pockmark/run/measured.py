"""A run folder to its measures."""

from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import PockmarkError
from ..base.geometry import Setup
from ..metrology import results
from ..metrology.measures import UNWARNED, measures, surface_of, worst_error
from ..metrology.surface import Surface
from ..scene.scene import Scene
from ..scene.warnings import frame_warnings
from ..view.report import standing
from .doubts import doubts
from .pipeline import treatments
from .setup import setup_of
from .snapshot import Snapshot
from .store import RunFolder, finite


@UNWARNED
def measure_run(path: str | Path) -> dict[str, Any]:
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
    snapshot = in_the_grid(folder.last_snapshot(), scene)
    table = measures(snapshot, setup_of(scene), record.joules, run, record.counters, history)
    table["warnings"] += frame_warnings(scene)
    said = record.doubts
    if said is None:  # the run did not come to say them
        worst, when = worst_error(history) or (0.0, None)
        said = doubts(record.counters, worst if when is not None else 0.0, when or 0.0)
    table["doubts"], table["run"]["doubtful"] = [*said], bool(said)
    return dict(finite(table))


@UNWARNED
def surface_of_run(path: str | Path) -> Surface | None:
    """Return the target's surface near the crater in the last snapshot of a run folder; None if there is no crater."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    return surface_in(in_the_grid(folder.last_snapshot(), scene), setup_of(scene))


def standing_of(path: str | Path) -> str:
    """Return how a run that has not ended stands, in one sentence; an empty text for one that has ended."""
    folder = RunFolder.open(path)
    rows, snapshot = folder.rows(), folder.last_snapshot()
    return standing(folder.status(), rows.last["time"], float(snapshot["time"][0]), rows.torn)


def in_the_grid(snapshot: Snapshot, scene: Scene) -> Snapshot:
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


def surface_in(snapshot: Snapshot, setup: Setup) -> Surface | None:
    return surface_of(results.field_of(snapshot, setup))
