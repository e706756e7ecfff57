"""The slices of Fig. 14 for each run, and a page of them a mode (Figs. 17 and 18)."""

import csv
from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
import paper
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from reporting import Row, write_rows
from skimage.measure import approximate_polygon

from pockmark.metrology.surface import Surface
from pockmark.run.measured import surface_of_run
from pockmark.view.canvas import UM, blank, draw_lines

Lines = list[NDArray[np.float64]]  # um
PLANE = 12.5e-6  # m: the row and the column of craters nearest to the middle
PLANES = {"xy": (2, None), "xz": (1, PLANE), "yz": (0, PLANE)}  # by the axes that they show
TOLERANCE = 0.02  # um: points of a line that the rest of it shows as well are left out


def keep_slices(rows: Sequence[Row], runs: Path, out: Path) -> None:
    """Write a table for each run, in `out`, of those whose folder is there; what an earlier call kept of others stays."""
    out.mkdir(exist_ok=True)
    for row in rows:
        if not (runs / row.scene).exists():
            continue
        surface = surface_of_run(runs / row.scene)
        write_rows(_file(out, row), list(_points(surface)) if surface else [])


def mode_pages(rows: Sequence[Row], slices: Path, out: Path) -> None:
    """Draw figure-17a.png to figure-18g.png: the three slices of every run that is of that mode here."""
    for number, part in ((17, [r for r in rows if r.angle == 0]), (18, [r for r in rows if r.angle > 0])):
        for mode, letter in enumerate(paper.LETTERS, 1):
            of = [row for row in part if row.get("group.mode") == mode]
            if of:
                _page(of, slices, f"Mode {number}{letter}").savefig(
                    out / f"figure-{number}{letter}.png", dpi=60
                )


def _points(surface: Surface) -> Iterator[dict[str, object]]:
    for plane, (axis, at) in PLANES.items():
        lines = surface.section(axis, -surface.spacing / 2 if at is None else at)
        for number, line in enumerate(lines):
            for u, v in approximate_polygon(line * 1e6, TOLERANCE):  # type: ignore[no-untyped-call]
                yield {"plane": plane, "line": number, "u_um": f"{u:.2f}", "v_um": f"{v:.2f}"}


def _file(folder: Path, row: Row) -> Path:
    return folder / f"{row.angle:g}deg-{row.flux * 100:g}-{row.speed:g}.csv"


def _read(path: Path) -> dict[str, Lines]:
    found: dict[str, Lines] = {plane: [] for plane in PLANES}
    with path.open(newline="", encoding="utf-8") as file:
        for (plane, _), points in groupby(csv.DictReader(file), lambda p: (p["plane"], p["line"])):
            found[plane].append(np.array([(float(p["u_um"]), float(p["v_um"])) for p in points]))
    return found


def _page(rows: Sequence[Row], slices: Path, title: str) -> Figure:
    page = blank((10, 2.6 * len(rows) + 0.6), title=f"{title}: z = -h/2, y = 12.5 um, x = 12.5 um")
    for row, panels in zip(rows, page.subplots(len(rows), 3, squeeze=False), strict=True):
        theirs = paper.LETTERS[paper.mode(row.angle, row.flux, row.speed) - 1]
        panels[0].set_title(f"{row.label} (paper: {theirs})", fontsize="small", loc="left")
        for axes, (names, lines) in zip(panels, _read(_file(slices, row)).items(), strict=True):
            _draw(axes, names, lines)
    return page


def _draw(axes: Axes, names: str, lines: Lines) -> None:
    draw_lines(axes, [line * UM for line in lines])
    axes.set(xlabel=f"{names[0]} (um)", ylabel=f"{names[1]} (um)", xlim=(-80, 80), aspect="equal")
    axes.set_ylim((-80, 80) if names == "xy" else (-50, 30))
