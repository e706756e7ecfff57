"""What all pictures share: figures, colours that the colour-blind tell apart, lines of a surface."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..base.errors import shown

# Of Okabe and Ito, whose colours the colour-blind tell apart.
BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "#7f7f7f"
CYCLE = (BLUE, ORANGE, "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
MARK = "#b2182b"  # of what was measured
UM = 1e-6  # m


def blank(size: tuple[float, float], *, layout: str = "constrained", title: str = "") -> Figure:
    """Return an empty figure (size in inches) that no window and no global state knows."""
    figure = Figure(figsize=size, layout=layout)  # type: ignore[arg-type]
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(shown(title, 80), parse_math=False)
    return figure


def plain_axes(figure: Figure, x: str, y: str) -> Axes:
    """Return the one panel of a figure, whose lines have the colours of CYCLE."""
    axes = figure.subplots()
    axes.set_prop_cycle(color=CYCLE)
    axes.set(xlabel=x, ylabel=y)
    return axes


def draw_lines(
    axes: Axes, lines: Iterable[NDArray[np.floating]], style: str = "k-", label: str | None = None
) -> None:
    """Draw lines (n, 2), m, of a surface in a plane, in um."""
    for line in lines:
        axes.plot(*(np.asarray(line).T / UM), style, linewidth=0.8, label=label)
