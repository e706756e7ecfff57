"""The picture of a convergence study: each measure against the cells, its fit and its limit."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..base.lengths import unit_for
from ..metrology.limit import Limit
from .canvas import BLUE, GREY, ORANGE, blank


class Panel(NamedTuple):
    """What is drawn of a measure: values in SI on cells (m), to be divided by `size` for the unit in `name`."""

    name: str
    size: float
    cells: tuple[float, ...]
    values: tuple[float, ...]
    readings: tuple[float, ...]
    limit: Limit | None
    own_cell: float


def convergence_figure(panels: Sequence[Panel], title: str) -> Figure:
    """Draw a panel for each measure. The cells begin at 0, where the limit is."""
    columns = 2 if len(panels) > 1 else 1
    rows = max(1, -(-len(panels) // columns))
    figure = blank((5 * columns, 3.6 * rows + 0.4), title=title)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, panel in zip(grid, panels, strict=False):
        _draw(axes, panel)
    for axes in grid[len(panels) :]:
        axes.set_visible(False)
    return figure


def _draw(axes: Axes, panel: Panel) -> None:
    """Draw one measure: its values with what they were read to, its limit with its interval, and its fit."""
    cells = np.array(panel.cells)
    unit, width = unit_for(*panel.cells)
    values, readings = (np.array(column) / panel.size for column in (panel.values, panel.readings))
    axes.errorbar(
        cells / width, values, 2 * readings, fmt="o", color=BLUE, capsize=3, label="computed, as read (95 %)"
    )
    is_own = cells == panel.own_cell
    axes.plot(
        cells[is_own] / width, values[is_own], "s", ms=12, mfc="none", mec=ORANGE, mew=2, label="your cell"
    )
    if (limit := panel.limit) is not None and limit.is_known:
        _draw_limit(axes, limit, float(cells.max(initial=0.0)), width, panel.size)
    elif limit is not None:
        axes.plot([], [], " ", label="does not converge on these cells")
    axes.set(xlabel=f"cell ({unit})", ylabel=panel.name, xlim=(0, None))
    axes.legend(fontsize="small")


def _draw_limit(axes: Axes, limit: Limit, coarsest: float, width: float, size: float) -> None:
    """Draw a limit at cells of no width, its interval across the panel, and the fit up to the coarsest cell (m)."""
    value, around = limit.value / size, limit.uncertainty / size
    axes.axhspan(value - around, value + around, color=GREY, alpha=0.2, lw=0, label="limit, interval (95 %)")
    axes.axhline(value, color=GREY, lw=1)
    h = np.linspace(0.0, coarsest, 200)
    told = "" if limit.order is None else f", order {limit.order:.2f}"
    axes.plot(h / width, limit.at(h) / size, "--", color=BLUE, lw=1, label=f"fit{told}")
