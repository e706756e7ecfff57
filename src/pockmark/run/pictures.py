"""The way from a run folder to its pictures."""

import gc
from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, make_folder, replaced
from ..metrology import results
from ..metrology.measures import UNWARNED
from ..view.plots import (
    HISTORY_COLUMNS,
    fields_figure,
    history_figure,
    process_figure,
    slice_figure,
    top_figure,
)
from .measured import in_the_grid, surface_in
from .setup import setup_of
from .store import UNENDED, RunFolder

PICTURE_DPI = 120


@UNWARNED
def plot_run(path: AnyPath, out: AnyPath | None = None) -> list[Path]:
    """Draw the last snapshot and the history, and return the files.

    They are those of figures_of(), written into `out`, or into the run folder. Raises PockmarkError.
    """
    figures = figures_of(path)
    target = as_path(out) if out else RunFolder.open(path).path
    make_folder(target)
    for name, figure in figures.items():  # made one at a time: each takes some memory
        with replaced(target / name) as descriptor, open(descriptor, "wb", closefd=False) as file:
            figure().savefig(file, format="png", dpi=PICTURE_DPI)
        gc.collect()  # a figure and its parts refer to one another
    return [target / name for name in figures]


@UNWARNED
def figures_of(path: AnyPath) -> dict[str, Callable[[], Figure]]:
    """Return what draws each picture of a run folder, by the name of its file.

    crater.png has the bodies, stress and pressure, fields.png temperature, plastic strain, damage and speed, top.png
    the crater from above, history.png the energies. Raises PockmarkError.
    """
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    snapshot, setup = in_the_grid(folder.last_snapshot(), scene), setup_of(scene)
    title = f"{scene.title or folder.path.name}, {float(snapshot['time'][0]) * 1e9:.0f} ns"
    title += f" ({status})" if status in UNENDED else ""
    surface = surface_in(snapshot, setup)
    crater, has_hole = results.crater_of(surface, setup.heading), results.hole_of(surface) is not None
    return {
        "crater.png": lambda: slice_figure(
            snapshot, setup, crater=crater, title=title, is_perforated=has_hole
        ),
        "fields.png": lambda: fields_figure(
            snapshot, setup, crater=crater, title=title, is_perforated=has_hole
        ),
        "top.png": lambda: top_figure(surface, snapshot, setup, crater=crater, title=title),
        "history.png": lambda: history_figure(folder.history(*HISTORY_COLUMNS)),
    }


@UNWARNED
def plot_process(path: AnyPath) -> Figure:
    """Return a figure of stress and pressure in the last four snapshots of a run folder. Raises PockmarkError."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    snapshots = [in_the_grid(folder.snapshot(file), scene) for file in folder.snapshots()[-4:]]
    if not snapshots:
        raise PockmarkError(f"{folder.path}: holds no snapshot")
    return process_figure(snapshots, setup_of(scene))
