"""The slices of Fig. 14 for each run, a page a mode (Figs. 17 and 18)."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import paper
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from reporting import Row

from pockmark.run import surface_of_run
from pockmark.surface import Surface

PLANE = 12.5e-6  # m: the row and the column of craters nearest to the middle


def mode_pages(rows: Sequence[Row], runs: Path, out: Path) -> None:
    """figure-17a.png to figure-18g.png: the three slices of every run that is of that mode here."""
    for number, part in ((17, [r for r in rows if r.angle == 0]), (18, [r for r in rows if r.angle > 0])):
        for mode, letter in enumerate(paper.LETTERS, 1):
            of = [row for row in part if row.get("group.mode") == mode]
            if of:
                _page(of, runs, f"Mode {number}{letter}").savefig(
                    out / f"figure-{number}{letter}.png", dpi=60
                )


def _page(rows: Sequence[Row], runs: Path, title: str) -> Figure:
    page = Figure(figsize=(10, 2.6 * len(rows) + 0.6), layout="constrained")
    FigureCanvasAgg(page)
    page.suptitle(f"{title}: z = -h/2, y = 12.5 um, x = 12.5 um")
    for row, panels in zip(rows, page.subplots(len(rows), 3, squeeze=False), strict=True):
        theirs = paper.LETTERS[paper.mode(row.angle, row.flux, row.speed) - 1]
        panels[0].set_title(f"{row.label} (paper: {theirs})", fontsize="small", loc="left")
        surface = surface_of_run(runs / row.scene)
        if surface:
            _slices(panels, surface)
    return page


def _slices(panels: Sequence[Axes], surface: Surface) -> None:
    for axes, (axis, at), names in zip(
        panels, ((2, -surface.spacing / 2), (1, PLANE), (0, PLANE)), ("xy", "xz", "yz"), strict=True
    ):
        for line in surface.section(axis, at):
            axes.plot(*(np.asarray(line) * 1e6).T, "k-", linewidth=0.8)
        axes.set(xlabel=f"{names[0]} (um)", ylabel=f"{names[1]} (um)", xlim=(-80, 80), aspect="equal")
        axes.set_ylim((-80, 80) if axis == 2 else (-50, 30))
