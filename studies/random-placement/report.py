"""Depth and mode of groups at random places, seed by seed: python report.py RESULTS.csv RUNS OUT."""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import numpy as np

from pockmark.metrology.modes import ROMAN
from pockmark.metrology.morphology import group_of
from pockmark.run.measured import surface_of_run
from pockmark.run.setup import setup_of
from pockmark.run.store import RunFolder
from pockmark.view.canvas import MARK, blank, draw_lines


def main() -> None:
    """Draw a map of the craters of each seed with its mode, and their depths."""
    results, runs, out = map(Path, sys.argv[1:4])
    with results.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if not row["fault"]]
    page = blank((11, 2.3 * -(-len(rows) // 4) + 3.2))
    maps, below = page.subfigures(2, 1, height_ratios=[2.3 * -(-len(rows) // 4), 3.2])
    panels = maps.subplots(-(-len(rows) // 4), 4, squeeze=False, sharex=True, sharey=True).ravel()
    depths = {}
    for axes, row in zip(panels, rows, strict=False):
        seed, mode = row["body.swarm.seed"], row.get("group.mode")
        surface = surface_of_run(runs / row["scene"])
        group = group_of(surface, setup_of(RunFolder.open(runs / row["scene"]).scene()))
        draw_lines(axes, surface.section(2, -surface.spacing / 2) if surface else [])
        axes.set(aspect="equal", xlim=(-70, 70), ylim=(0, 70))
        axes.set_title(f"seed {seed}: mode {ROMAN[int(mode) - 1] if mode else 'none'}", fontsize="small")
        depths[seed] = [pit.depth * 1e6 for pit in group.pits] if group else []
    for axes in panels[len(rows) :]:
        axes.set_axis_off()
    axes = below.subplots()
    for seed, of in depths.items():
        axes.plot([int(seed)] * len(of), of, "k.")
        axes.plot(int(seed), np.mean(of) if of else np.nan, "o", mfc="none", color=MARK)
    axes.set(xlabel="seed", ylabel="depth of each crater,\nmean (circle), um")
    page.savefig(out / "figure.png", dpi=90)


if __name__ == "__main__":
    main()
