"""Figures 4 to 12 of Liu et al. 2015, a CSV and a PNG each, and what they say, from the runs of this campaign.

python studies/single-particle/figures.py RESULTS.csv RUNS OUT: `pockmark study single-particle` calls it so.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from matplotlib.axes import Axes
from profiles import profile_figure
from reporting import Row, figure, keep_statements, process_figures, read_results, write_table
from trends import equation_22, statements

from pockmark.laws.equations import cour_palais, herrmann_jones, summers_charters

EQUATIONS = {
    "Eq. 22": equation_22,
    "Cour-Palais": lambda v: cour_palais(v, diameter=20e-6, brinell=120, sound_speed=5330),
    "Summers-Charters": lambda v: summers_charters(v, sound_speed=5330),
    "Herrmann-Jones": lambda v: herrmann_jones(v, target_density=2770, brinell=120),
}
MARKS = {0: "o", 15: "s", 30: "^"}
PROCESSES = {0: "figure-5.png", 30: "figure-8.png"}


def main() -> None:
    """Draw what the table has runs for."""
    results, runs, out = map(Path, sys.argv[1:4])
    rows = [row for row in read_results(results) if not row.fault]
    swept = [row for row in rows if row.friction is None and "panels" not in row.groups]
    normal = [row for row in swept if row.angle == 0]
    oblique = [row for row in swept if row.angle > 0]
    if normal:
        figure_6(normal, out)
        figure_7(normal, out)
    if oblique:
        figure_9(swept, out)
        figure_10(oblique, out)
        figure_11(oblique, out)
        figure_12(swept, out)
    profile_figure(rows, runs, out)
    process_figures(rows, runs, out, PROCESSES)
    keep_statements(statements(rows), out / "trends.csv")


def figure_6(rows: Sequence[Row], out: Path) -> None:
    """Draw C_p/D_c against the speed."""
    with figure(out / "figure-6.png", "speed (km/s)", "$C_p/D_c$") as axes:
        _errorbars(axes, rows, "depth_over_diameter", "ours")
        axes.axhspan(0.56, 0.60, color="0.85", label="flight craters in aluminium (Love et al. 1995)")
        axes.axhline(0.5, color="black", linewidth=0.8, linestyle=":", label="hemisphere")
        axes.legend()
    write_table(out / "figure-6.csv", rows, ["depth", "diameter", "depth_over_diameter"])


def figure_7(rows: Sequence[Row], out: Path) -> None:
    """Draw C_p/d_p against the speed, and four equations."""
    with figure(out / "figure-7.png", "speed (km/s)", "$C_p/d_p$") as axes:
        _errorbars(axes, rows, "depth_over_projectile_diameter", "ours")
        for (name, law), style in zip(EQUATIONS.items(), ("-", "--", "-.", ":"), strict=True):
            axes.plot([r.speed / 1e3 for r in rows], [law(r.speed) for r in rows], style, label=name)
        axes.legend()
    extra = {name: [law(row.speed) for row in rows] for name, law in EQUATIONS.items()}
    write_table(out / "figure-7.csv", rows, ["depth", "depth_over_projectile_diameter"], extra)


def figure_9(rows: Sequence[Row], out: Path) -> None:
    """Draw C_p, D_max and D_min against the speed at each angle."""
    keys = {"depth": "$C_p$", "major_axis": "$D_{max}$", "minor_axis": "$D_{min}$"}
    _against_speed(out / "figure-9", rows, keys, "um", unit=1e-6)


def figure_10(rows: Sequence[Row], out: Path) -> None:
    """Draw the positions of the bottom, C_xb, and of the pithead's centre, C_xs."""
    keys = {"bottom_x": "$C_{xb}$", "centre_x": "$C_{xs}$"}
    _against_speed(out / "figure-10", rows, keys, "x in the scraping direction (um)", unit=1e-6)


def figure_11(rows: Sequence[Row], out: Path) -> None:
    """Draw the eccentricity ratios."""
    keys = {"e1": "$e_1$", "e2": "$e_2$"}
    _against_speed(out / "figure-11", rows, keys, "$e_1$, $e_2$", level=0.0)


def figure_12(rows: Sequence[Row], out: Path) -> None:
    """Draw the shape factors."""
    keys = {"depth_over_major_axis": "$C_p/D_{max}$", "depth_over_minor_axis": "$C_p/D_{min}$"}
    _against_speed(out / "figure-12", rows, keys, "shape factor", level=0.5)


def _against_speed(
    path: Path,
    rows: Sequence[Row],
    keys: Mapping[str, str],
    y: str,
    *,
    unit: float = 1.0,
    level: float | None = None,
) -> None:
    """Draw a line for each measure and angle, `level` as a dotted one, and the table."""
    with figure(path.with_suffix(".png"), "speed (km/s)", y) as axes:
        for (key, name), style in zip(keys.items(), ("-", "--", ":"), strict=False):
            for angle in sorted({row.angle for row in rows}):
                of = [row for row in rows if row.angle == angle and row.get(key) is not None]
                axes.plot(
                    [row.speed / 1e3 for row in of],
                    [row[key] / unit for row in of],
                    style + MARKS[round(angle)],
                    label=f"{name}, {angle:.0f}°",
                )
        if level is not None:
            axes.axhline(level, color="black", linewidth=0.8, linestyle=":")
        axes.legend(fontsize="small", ncols=len(keys))
    write_table(path.with_suffix(".csv"), rows, list(keys))


def _errorbars(axes: Axes, rows: Sequence[Row], key: str, name: str) -> None:
    axes.errorbar(
        [row.speed / 1e3 for row in rows],
        [row[key] for row in rows],
        [row.spread(key) for row in rows],
        fmt="o-",
        capsize=3,
        label=name,
    )


if __name__ == "__main__":
    main()
