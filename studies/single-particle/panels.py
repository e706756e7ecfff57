"""Figures 5 and 8: effective stress and pressure on the plane of symmetry, projectile white."""

from collections.abc import Sequence
from pathlib import Path

from reporting import Row

from pockmark.run import plot_process

FIGURES = {0: "figure-5.png", 30: "figure-8.png"}


def panel_figures(rows: Sequence[Row], runs: Path, out: Path) -> None:
    """Of the runs of the group `panels`."""
    for row in rows:
        if "panels" in row.groups:
            plot_process(runs / row.scene).savefig(out / FIGURES[round(row.angle)], dpi=100)
