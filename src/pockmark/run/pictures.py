"""The way from a run folder to its pictures."""

from pathlib import Path

from matplotlib.figure import Figure

from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, replaced, told
from ..metrology import results
from ..metrology.measures import UNWARNED
from ..view.plots import HISTORY_COLUMNS, history_figure, process_figure, slice_figure
from .measured import in_the_grid, surface_in
from .setup import setup_of
from .store import UNENDED, RunFolder


@UNWARNED
def plot_run(path: AnyPath, out: AnyPath | None = None) -> list[Path]:
    """Draw crater.png (panels of the last snapshot) and history.png, and return the files.

    They are written into `out`, or into the run folder. Raises PockmarkError.
    """
    folder = RunFolder.open(path)
    scene, status = folder.scene(), folder.status()
    target = as_path(out) if out else folder.path
    snapshot, setup = in_the_grid(folder.last_snapshot(), scene), setup_of(scene)
    title = scene.title or folder.path.name
    surface = surface_in(snapshot, setup)
    figures = {
        "crater.png": slice_figure(
            snapshot,
            setup,
            crater=results.crater_of(surface, setup.heading),
            is_perforated=results.hole_of(surface) is not None,
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
def plot_process(path: AnyPath) -> Figure:
    """Return a figure of stress and pressure in the last four snapshots of a run folder. Raises PockmarkError."""
    folder = RunFolder.open(path)
    scene = folder.scene()
    snapshots = [in_the_grid(folder.snapshot(file), scene) for file in folder.snapshots()[-4:]]
    if not snapshots:
        raise PockmarkError(f"{folder.path}: holds no snapshot")
    return process_figure(snapshots, setup_of(scene))
