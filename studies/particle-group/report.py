"""Tables 4 and 5 and Figures 15 to 19 of Liu et al. 2015 from the runs of this campaign, and what they say.

python studies/particle-group/report.py RESULTS.csv RUNS OUT: `pockmark study particle-group` calls it so.
"""

import math
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import numpy as np
import paper
from reporting import (
    Row,
    Statement,
    figure,
    keep_statements,
    made_by,
    process_figures,
    read_results,
    write_rows,
)
from slices import keep_slices, mode_pages

from pockmark.laws.scaling import Fit, energy_flux, fit_depth
from pockmark.scene.bodies.placement import sphere_diameter

DENSITY, STRENGTH = 2770.0, 265e6
J_CM2 = 1e4  # J/m^2
PROCESSES = {0: "figure-15.png", 30: "figure-16.png"}


def main() -> None:
    """Make what the table has runs for."""
    results, runs, out = map(Path, sys.argv[1:4])
    rows = [row for row in read_results(results) if not row.fault]
    swept = [row for row in rows if "modes" in row.groups]
    table_4(swept, out)
    confusion(swept, out)
    table_5(swept, out)
    found = [*_modes(swept), *_depths(swept), *figure_19(swept, out)]
    keep_slices(swept, runs, out / "slices")
    mode_pages(swept, out / "slices", out)
    process_figures(rows, runs, out, PROCESSES)
    keep_statements(found, out / "trends.csv")


def table_4(rows: Sequence[Row], out: Path) -> None:
    """Write the mode of each run, the paper's beside it."""
    keys = [
        "nearest_mode",
        "distance_to_it",
        "depth_mean",
        "depth_spread",
        "touching_along",
        "touching_across",
        "linked_along",
        "linked_across",
        "levelled",
    ]
    keys += ["unlike", "irregular_inside", "irregular_outside"]
    table: list[dict[str, object]] = []
    for row in rows:
        values = {key: row.get(f"group.{key}") for key in keys}
        table.append(
            {
                "angle_deg": f"{row.angle:g}",
                "flux_mg/cm2": f"{row.flux * 100:g}",
                "speed_m/s": f"{row.speed:g}",
                "paper": paper.LETTERS[_paper(row) - 1],
                "ours": paper.LETTERS[_ours(row) - 1] if _ours(row) else "none",
            }
            | {key: "" if value is None else f"{value:.4g}" for key, value in values.items()}
            | made_by(row.cells)
        )
    write_rows(out / "table-4.csv", table)


def confusion(rows: Sequence[Row], out: Path) -> None:
    """Count how often each of the paper's modes is which of ours, for normal and for oblique impact."""
    table = []
    for figure_number, part in (
        (17, [r for r in rows if r.angle == 0]),
        (18, [r for r in rows if r.angle > 0]),
    ):
        for mode, letter in enumerate(paper.LETTERS, 1):
            ours = Counter(_ours(row) for row in part if _paper(row) == mode)
            if ours:
                counts = {name: ours[n] for n, name in enumerate(("none", *paper.LETTERS))}
                table.append({"paper": f"{figure_number}{letter}"} | counts)
    write_rows(out / "confusion.csv", table)


def table_5(rows: Sequence[Row], out: Path) -> None:
    """Write the ranges of the energy fluxes (J/cm^2) of each of our modes; the paper's, with their misprints named."""
    names = ("E_f min", "E_f max", "E_f^n min", "E_f^n max")
    table = []
    for angle in (0, 15, 30):
        for n, letter in enumerate(paper.LETTERS, 1):
            fluxes = [_energy(row) for row in rows if row.angle == angle and _ours(row) == n]
            printed = paper.TABLE_5.get((angle, letter))
            if not fluxes and not printed:
                continue
            total, normal = zip(*fluxes, strict=True) if fluxes else ((), ())
            ours = [min(total), max(total), min(normal), max(normal)] if fluxes else []
            table.append(
                {"angle_deg": angle, "mode": letter}
                | _named(names, ours, "ours")
                | _named(names, printed or [], "paper")
                | {"misprint": paper.MISPRINTS.get((angle, letter), "")}
            )
    write_rows(out / "table-5.csv", table)


def _named(names: Sequence[str], values: Sequence[float], whose: str) -> dict[str, object]:
    shown = [f"{value:.4g}" for value in values] or [""] * len(names)
    return {f"{name} {whose}": value for name, value in zip(names, shown, strict=True)}


def figure_19(rows: Sequence[Row], out: Path) -> list[Statement]:
    """Draw the mean depths against the normal speed, and the fit of Eq. 31 with its intervals."""
    known = [row for row in rows if row.get("group.depth_mean") is not None]
    if len(known) <= 3:
        return []
    speed = np.array([row.speed * math.cos(math.radians(row.angle)) for row in known])
    diameter = np.array([sphere_diameter(row.flux, area=625e-12, number=1, density=DENSITY) for row in known])
    shape = np.array([row["group.depth_mean"] for row in known]) / diameter
    fit = fit_depth(speed, shape, density=DENSITY, strength=STRENGTH)
    theirs = Fit(*(paper.EQUATION_32[k] for k in ("factor", "threshold", "exponent")), (0, 0, 0), 0)
    root, line = math.sqrt(DENSITY / STRENGTH), np.linspace(max(fit.threshold, 430), 4600, 200)
    with figure(out / "figure-19.png", "$v_p cos θ$ (km/s)", "$C_p/d_p$") as axes:
        for flux in sorted({row.flux for row in known}):
            of = [row.flux == flux for row in known]
            axes.plot(speed[of] / 1e3, shape[of], "o", label=f"{flux * 100:g} mg/cm²")
        axes.plot(line / 1e3, fit(line, root), "k-", label="our fit")
        axes.plot(line / 1e3, theirs(line, root), "k--", label="Eq. 32")
        axes.legend()
    constants = {"factor": fit.factor, "threshold": fit.threshold, "exponent": fit.exponent}
    table = [
        {"constant": name, "ours": f"{value:.5g}", "half-width of the 95 % interval": f"{width:.3g}"}
        for (name, value), width in zip(constants.items(), fit.intervals, strict=True)
    ]
    table.append({"constant": "goodness", "ours": f"{fit.goodness:.4f}"})
    write_rows(out / "figure-19.csv", [row | {"paper": paper.EQUATION_32[row["constant"]]} for row in table])
    numbers = ", ".join(
        f"{n} {v:.4g} ± {w:.2g}" for (n, v), w in zip(constants.items(), fit.intervals, strict=True)
    )
    held = [
        abs(value - paper.EQUATION_32[name]) <= width
        for (name, value), width in zip(constants.items(), fit.intervals, strict=True)
    ]
    return [
        Statement("Eq. 32", "goodness of fit is at least .97", fit.goodness >= 0.97, f"{fit.goodness:.4f}"),
        Statement(
            "Eq. 32", "the constants are .1292, 422.5 m/s, .9234 within our intervals", all(held), numbers
        ),
    ]


def _modes(rows: Sequence[Row]) -> list[Statement]:
    off = [abs(_ours(row) - _paper(row)) if _ours(row) else 9 for row in rows]
    same, near = sum(n == 0 for n in off), sum(n <= 1 for n in off)
    return [
        Statement(
            "Table 4",
            "80 % of the modes are the same (which chose how deep a ridge links)",
            same >= 0.8 * len(rows),
            f"{same} of {len(rows)}",
        ),
        Statement("Table 4", "95 % are within one mode", near >= 0.95 * len(rows), f"{near} of {len(rows)}"),
        Statement(
            "Table 4",
            "17d and 18g are no run's",
            all(_ours(r) != (4 if r.angle == 0 else 7) for r in rows),
            "",
        ),
    ]


def _depths(rows: Sequence[Row]) -> list[Statement]:
    spreads = {row.label: spread for row in rows if (spread := row.get("group.depth_spread")) is not None}
    if not spreads:
        return []
    worst = max(spreads, key=lambda label: spreads[label])
    held = sum(spread <= 0.13 for spread in spreads.values())
    numbers = f"{held} of {len(spreads)}, largest {spreads[worst]:.0%} ({worst})"
    return [
        Statement(
            "4.2", "the depths of a run's craters differ by 13 % at most", held == len(spreads), numbers
        )
    ]


def _ours(row: Row) -> int:
    """Return our mode, 0 where there is no group of craters."""
    mode = row.get("group.mode")
    return int(mode) if mode is not None else 0


def _paper(row: Row) -> int:
    return paper.mode(row.angle, row.flux, row.speed)


def _energy(row: Row) -> tuple[float, float]:
    total, normal = energy_flux(row.flux, row.speed, math.radians(row.angle))
    return total / J_CM2, normal / J_CM2


if __name__ == "__main__":
    main()
