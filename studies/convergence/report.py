"""Tables 2 and 3 of Liu et al. 2015 with the order of convergence, variants of model 1, and what still rings at the end.

python studies/convergence/report.py RESULTS.csv RUNS OUT: `pockmark study` calls it so for this campaign and for group-convergence.
"""

import csv
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from reporting import made_by, write_rows
from ringing import ringing

from pockmark.run.store import RunFolder

Cells = Mapping[str, str]
# E_i^r and C_p (um) of the paper's models 1, 2, ...
PAPER = {
    "table-2": ((0.9302, 14.3), (0.9256, 16.2), (0.9295, 17.5), (0.9193, 18.0)),
    "table-3": ((0.7515, 22.5), (0.6904, 23.5), (0.6688, 25.5), (0.6879, 26.5)),
}
MEASURES = {
    "E_i^r": ("energy.residual_internal", 1.0, 4),
    "kinetic": ("energy.kinetic", 1.0, 4),
    "absorbed": ("energy.absorbed", 1.0, 4),
    "left": ("energy.left", 1.0, 4),
    "ledger_error": ("energy.ledger_error", 1.0, 5),
    "C_p_um": ("crater.depth", 1e-6, 2),
    "C_p_uncertainty_um": ("crater.uncertainty.depth", 1e-6, 2),
    "D_c_um": ("crater.diameter", 1e-6, 2),
    "largest_compression": ("run.max_compression", 1.0, 3),
    "points": ("run.points", 1.0, 0),
    "steps": ("run.steps", 1.0, 0),
    "failed_points": ("counters.failed_points", 1.0, 0),
}


def main() -> None:
    """Write what the table has runs for."""
    results, runs, out = map(Path, sys.argv[1:4])
    with results.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for name, paper in PAPER.items():
        models = [
            (n, row) for n in range(1, 5) for row in rows if f"{name}-model-{n}" in row["groups"].split()
        ]
        finished = [(n, row) for n, row in models if not row["fault"]]
        if finished:
            write_rows(out / f"{name}.csv", [_model(n, row, paper[n - 1]) for n, row in finished])
            write_rows(out / f"{name}-order.csv", _orders(finished, paper))
            if all((runs / row["scene"]).exists() for _, row in finished):
                write_rows(
                    out / "ringing.csv", [cells for n, row in finished for cells in _ringing(n, row, runs)]
                )
    variants = [
        row
        for row in rows
        if set(row["groups"].split()) - {f"{t}-model-{n}" for t in PAPER for n in range(1, 5)}
    ]
    if variants:
        write_rows(out / "variants.csv", list(map(_variant, variants)))


def _model(number: int, row: Cells, paper: tuple[float, float]) -> dict[str, object]:
    return (
        {"model": number, "precision": row["numerics.precision"]}
        | _measures(row)
        | _against(row, paper)
        | made_by(row)
    )


def _against(row: Cells, paper: tuple[float, float]) -> dict[str, object]:
    energy, depth = float(row["energy.residual_internal"]), _depth(row)
    return {
        "paper_E_i^r": paper[0],
        "paper_C_p_um": paper[1],
        "E_i^r_off": f"{energy / paper[0] - 1:+.2%}",
        "C_p_off": f"{depth / paper[1] - 1:+.2%}" if depth else "",
    }


def _depth(row: Cells) -> float:
    """Return C_p in um, 0 where there is no crater."""
    return float(row["crater.depth"] or 0) / 1e-6


def _orders(
    models: Sequence[tuple[int, Cells]], paper: Sequence[tuple[float, float]]
) -> list[dict[str, object]]:
    """Return, of three grids, each of half the cell of the one before (models 1, 3, 4): Richardson's order and limit."""
    single = {n: row for n, row in models if row["numerics.precision"] == "single"}
    ours = {
        "E_i^r": [float(single[n]["energy.residual_internal"]) for n in (1, 3, 4) if n in single],
        "C_p_um": [_depth(single[n]) for n in (1, 3, 4) if n in single],
    }
    found: list[dict[str, object]] = []
    for i, (name, values) in enumerate(ours.items()):
        for whose, of in (("ours", values), ("paper", [paper[n - 1][i] for n in (1, 3, 4)])):
            if len(of) == 3:
                found.append({"measure": name, "whose": whose, **_richardson(of)})
    return found


def _richardson(values: Sequence[float]) -> dict[str, object]:
    first, second = values[1] - values[0], values[2] - values[1]
    shown: dict[str, object] = {
        f"cell_{cell}_um": f"{v:.4f}" for cell, v in zip((4, 2, 1), values, strict=True)
    }
    if first * second <= 0 or abs(second) >= abs(first):
        return shown | {"order": "does not converge on these", "limit": ""}
    return shown | {
        "order": f"{math.log2(first / second):.2f}",
        "limit": f"{values[2] + second**2 / (first - second):.4f}",
    }


def _ringing(number: int, row: Cells, runs: Path) -> list[dict[str, object]]:
    folder = RunFolder.open(runs / row["scene"])
    names = {"model": number, "precision": row["numerics.precision"]}
    return [names | cells | made_by(row) for cells in ringing(folder)]


def _variant(row: Cells) -> dict[str, object]:
    swept = {key.rpartition(".")[2]: value for key, value in row.items() if key in _SWEPT and value}
    described = ", ".join(f"{key} {value}" for key, value in swept.items())
    return (
        {"groups": row["groups"], "swept": described, "fault": row["fault"]} | _measures(row) | made_by(row)
    )


_SWEPT = (
    "impact.speed",
    "numerics.scheme",
    "numerics.mass_cutoff",
    "numerics.precision",
    "materials.al2024-liu2015.failure.treatment",
    "materials.al2024-liu2015.failure.floor",
    "materials.al2024-liu2015.failure.displacement",
    "materials.al2024-liu2015.thermal.taylor_quinney",
)


def _measures(row: Cells) -> dict[str, object]:
    return {
        name: f"{float(row[key]) / unit:.{digits}f}" if row.get(key) else ""
        for name, (key, unit, digits) in MEASURES.items()
    }


if __name__ == "__main__":
    main()
