"""Figure 4: craters with contact and friction, and with sticky contact."""

from collections.abc import Sequence
from pathlib import Path

from reporting import Row, figure, write_table

from pockmark.run.measured import surface_of_run
from pockmark.view.canvas import draw_lines


def profile_figure(rows: Sequence[Row], runs: Path, out: Path) -> None:
    """Draw profiles on the plane of symmetry of the runs of the group `friction`, and of the sticky one beside them."""
    frictional = [row for row in rows if row.friction is not None]
    if not frictional:
        return
    shown = [*(row for row in rows if "sticky" in row.groups), *frictional]
    if all((runs / row.scene).exists() for row in shown):
        _draw(shown, runs, out / "figure-4.png")
    write_table(
        out / "figure-4.csv",
        shown,
        ["depth", "major_axis", "minor_axis", "volume"],
        {"friction": [row.friction for row in shown]},
    )


def _draw(rows: Sequence[Row], runs: Path, path: Path) -> None:
    with figure(path, "x (um)", "z (um)") as axes:
        for row in rows:
            surface = surface_of_run(runs / row.scene)
            lines = [max(surface.section(1, 0.0), key=len)] if surface else []
            name, style = ("sticky", "k-") if row.friction is None else (f"friction {row.friction:g}", "-")
            draw_lines(axes, lines, style, label=name)
        axes.set_aspect("equal")
        axes.legend(fontsize="small")
