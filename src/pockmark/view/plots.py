"""Pictures of a run: slices through the crater, the crater from above, and the history.

The stress and the pressure of a slice are the panels of Liu et al. 2015, Figs. 5 and 8.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..base.geometry import Setup
from ..base.ledger import DRAWN, LEFT_ENERGIES
from ..metrology.crater import Crater
from .canvas import CYCLE, MARK, blank
from .panels import (
    colour_bar,
    frame,
    mark_depth,
    name_bodies,
    note,
    note_extremes,
    show_bodies,
    show_quantity,
)
from .quantities import DAMAGE, PRESSURE, SPEED, STRAIN, STRESS, TEMPERATURE, Fields, Quantity
from .raster import Cut, Limits, Raster, slice_axis, slice_plane
from .top import top_figure

__all__ = [
    "HISTORY_COLUMNS",
    "fields_figure",
    "history_figure",
    "process_figure",
    "slice_axis",
    "slice_figure",
    "slice_plane",
    "top_figure",
]

History = Mapping[str, NDArray[np.float64]]  # columns
HISTORY_COLUMNS = ("time", *DRAWN, *LEFT_ENERGIES, "error", "initial", "depth")
OTHERS = (TEMPERATURE, STRAIN, DAMAGE, SPEED)


def slice_figure(
    snapshot: Fields,
    setup: Setup,
    *,
    crater: Crater | None,
    title: str,
    is_perforated: bool = False,
) -> Figure:
    """Draw the plane of the picture in three panels: the bodies, the effective stress, the pressure."""
    return _panels(
        snapshot, setup, (None, STRESS, PRESSURE), 1, crater=crater, title=title, is_perforated=is_perforated
    )


def fields_figure(
    snapshot: Fields,
    setup: Setup,
    *,
    crater: Crater | None,
    title: str,
    is_perforated: bool = False,
    quantities: Sequence[Quantity] = OTHERS,
) -> Figure:
    """Draw the plane of the picture in a panel for each quantity: temperature, plastic strain, damage and speed."""
    columns = 2 if len(quantities) > 1 else 1
    return _panels(
        snapshot, setup, quantities, columns, crater=crater, title=title, is_perforated=is_perforated
    )


def _panels(
    snapshot: Fields,
    setup: Setup,
    quantities: Sequence[Quantity | None],
    columns: int,
    *,
    crater: Crater | None,
    title: str,
    is_perforated: bool,
) -> Figure:
    """Draw a panel for each quantity, for None one of the bodies."""
    cut, across = Cut.of(snapshot, setup, [one for one in quantities if one]), slice_axis(setup)
    raster, limits = Raster.of(cut, cut.limits), cut.limits
    rows = -(-len(quantities) // columns)
    figure = blank(_size(limits, rows, columns), layout="compressed", title=title)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, quantity in zip(panels.flat, quantities, strict=False):
        _fill(figure, axes, raster, quantity, setup)
        frame(axes, limits, quantity.name if quantity else "bodies")
        mark_depth(axes, crater, across)
        if is_perforated:
            axes.set_title("perforated", loc="right", color=MARK)
        if len(cut.x) == 0:
            note(axes, "no point is left in this plane")
    _name_axes(panels, across)
    for axes in panels.flat[len(quantities) :]:
        axes.set_visible(False)
    return figure


def _fill(figure: Figure, axes: Axes, raster: Raster, quantity: Quantity | None, setup: Setup) -> None:
    """Draw the content of one panel, and its bar. Every panel gets a bar, so that all are of one width."""
    if quantity is None:
        show_bodies(axes, raster, setup)
        name_bodies(axes, setup)
        figure.colorbar(axes.images[0], ax=axes).ax.set_visible(False)
    elif quantity.name in raster.cut.values:
        colour_bar(figure, show_quantity(axes, raster, quantity), axes, quantity)
        note_extremes(axes, raster, quantity)
    else:
        note(axes, f"the snapshot lacks the field {quantity.field}")


def process_figure(snapshots: Iterable[Fields], setup: Setup) -> Figure:
    """Draw effective stress above and pressure below, a column for each snapshot.

    These are the panels of Liu et al. 2015, Figs. 5 and 8, with their ranges of 0 to 600 and -600 to 600 MPa.
    """
    shown, across = (STRESS, PRESSURE), slice_axis(setup)
    cuts = [Cut.of(snapshot, setup, shown) for snapshot in snapshots]
    limits = cuts[-1].limits
    wide, high = (end - start for start, end in limits)
    figure = blank((3 * len(cuts) + 1.4, 6 * high / wide + 1), layout="compressed")
    rows = figure.subplots(2, len(cuts), sharex=True, sharey=True, squeeze=False)
    rasters = [Raster.of(cut, limits) for cut in cuts]
    for row, quantity in zip(rows, shown, strict=True):
        for axes, raster in zip(row, rasters, strict=True):
            image = show_quantity(axes, raster, quantity, Normalize(*(quantity.paper or ())))
            frame(axes, limits, f"{raster.cut.time:.0f} ns" if quantity is STRESS else "")
            note_extremes(axes, raster, quantity)
        colour_bar(figure, image, row, quantity, paper=True)
    _name_axes(rows, across)
    return figure


def _name_axes(panels: NDArray[np.object_], across: int) -> None:
    """Name the axes at the left and at the bottom of some panels (rows, columns)."""
    for axes in panels[:, 0]:
        axes.set_ylabel("z (um)")
    for axes in panels[-1]:
        axes.set_xlabel(f"{'xy'[1 - across]} (um)")


def _size(limits: Limits, rows: int, columns: int) -> tuple[float, float]:
    """Return the width and height of the figure, inches, in which its panels leave no blank."""
    (left, right), (low, high) = limits
    shape = (high - low) / (right - left)
    wide = min(5.4, 4.0 / shape)
    return columns * (max(wide, 3.0) + 2.0), rows * (wide * shape + 0.4) + 0.7


def history_figure(history: History) -> Figure:
    """Draw energies, ledger error and crater depth against time."""
    time, initial = history["time"] * 1e9, history["initial"]
    # Without an initial energy no share of it can be drawn.
    shares = bool(initial.all())
    scale = initial if shares else 1.0
    figure = blank((8, 9))
    energy, error, depth = figure.subplots(3, 1, sharex=True)
    for axes in (energy, error, depth):
        axes.set_prop_cycle(color=CYCLE)
        axes.grid(color="0.9", linewidth=0.6)
    for name in DRAWN:
        energy.plot(time, history[name] / scale, label=name)
    energy.plot(time, sum(history[name] for name in LEFT_ENERGIES) / scale, label="left the grid")
    energy.set(ylabel="energy / initial kinetic energy" if shares else "energy (J)")
    energy.legend()
    error.plot(time, history["error"] / scale * (100 if shares else 1))
    error.set(ylabel="ledger error (%)" if shares else "ledger error (J)")
    depth.plot(time, history["depth"] * 1e6)
    depth.set(ylabel="depth of the deepest column (um),\nan estimate, not $C_p$", xlabel="time (ns)")
    return figure
