"""Pictures of where the energy went, and of several runs beside one another."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..base.errors import shown
from ..base.ledger import SHARES
from ..base.lengths import unit_for
from .canvas import CYCLE, blank

# Lines and marks differ by their shape, too.
LINES, MARKS = ("-", "--", "-.", ":"), "osD^v<>P"
PARTS_OF_INTERNAL = ("viscous", "filtered")
ENERGIES = tuple(key for key in SHARES if key not in PARTS_OF_INTERNAL)  # they add up to the initial energy
MOST_LINES = 12  # lines that a legend names
ACROSS = 3  # panels beside one another


class Told(NamedTuple):
    """The history of a run by its name: time (n,) s, depth (n,) m, internal energy (n,) as a share."""

    name: str
    time: NDArray[np.float64]
    depth: NDArray[np.float64]
    internal: NDArray[np.float64]


class Series(NamedTuple):
    """Measures of runs that differ in one swept key alone: x (n,), and by measure y (n,), nan where there is none."""

    name: str
    x: NDArray[np.float64]
    y: Mapping[str, NDArray[np.float64]]


def energy_figure(energy: Mapping[str, Any]) -> Figure | None:
    """Draw where the initial energy is at the end of a run, in one bar; None where there was no energy."""
    shares = {key: energy[key] for key in ENERGIES if energy.get(key)}
    if not shares:
        return None
    figure = blank((8, 1.9))
    axes, start = figure.subplots(), 0.0
    for n, (key, share) in enumerate(shares.items()):
        hatch = "" if n < len(CYCLE) else "//"
        colour = CYCLE[n % len(CYCLE)]
        label = f"{key.replace('_', ' ')} {share:.1%}"
        axes.barh(0, share, left=start, color=colour, edgecolor="white", hatch=hatch, label=label)
        start += share
    axes.set(yticks=[], xlabel="share of the initial energy", xlim=(min(0.0, start), max(1.0, start)))
    axes.legend(ncols=4, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)
    return figure


def compared_figure(runs: Sequence[Told]) -> Figure:
    """Draw depth and internal energy of several runs against time."""
    figure = blank((9, 6.5))
    depth, internal = figure.subplots(2, 1, sharex=True)
    unit, size = unit_for(*(float(np.nanmax(run.depth, initial=0.0)) for run in runs))
    for n, run in enumerate(runs):
        style: dict[str, Any] = {
            "color": CYCLE[n % len(CYCLE)],
            "linestyle": LINES[n // len(CYCLE) % 4],
        }
        depth.plot(run.time * 1e9, run.depth / size, **style)
        internal.plot(run.time * 1e9, run.internal, **style)
    depth.set(ylabel=f"depth of the deepest column ({unit}),\nan estimate, not $C_p$")
    internal.set(ylabel="internal energy in the grid\n/ initial energy", xlabel="time (ns)")
    _name_lines(figure, depth.lines, [run.name for run in runs])
    return figure


def swept_figure(key: str, series: Sequence[Series], measures: Sequence[str]) -> Figure:
    """Draw measures against a swept key, a line for each series. The measures are named with their units."""
    rows = -(-len(measures) // ACROSS)
    figure = blank((3.3 * ACROSS, 3.0 * rows + 1.0))
    panels = figure.subplots(rows, ACROSS, squeeze=False).ravel()
    for axes in panels[len(measures) :]:
        axes.set_visible(False)
    for axes, measure in zip(panels, measures, strict=False):
        for n, one in enumerate(series):
            order = np.argsort(one.x)
            style = {"color": CYCLE[n % len(CYCLE)], "marker": MARKS[n % len(MARKS)], "markersize": 4}
            axes.plot(one.x[order], one.y[measure][order], **style)
        axes.set_xlabel(shown(key, 60), parse_math=False)
        axes.set_ylabel(measure, parse_math=False)
    _name_lines(figure, panels[0].lines, [one.name for one in series])
    return figure


def _name_lines(figure: Figure, lines: Sequence[Any], names: Sequence[str]) -> None:
    """Draw a legend of what the first lines are; nothing for a single one without a name."""
    if not any(names):
        return
    lines, names = [*lines][:MOST_LINES], [*names][:MOST_LINES]
    legend = figure.legend(
        lines, ["line"] * len(lines), loc="outside lower center", ncols=2, fontsize="small"
    )
    # The names come last, for matplotlib leaves out labels that begin with "_".
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set(text=shown(name, 60), parse_math=False)
