"""Rings beside three dimensions, a line for each run: python report.py RESULTS.csv RUNS OUT."""

import csv
import sys
from pathlib import Path

from pockmark.run.store import RunFolder

LENGTHS = {"C_p_um": "depth", "D_c_um": "diameter", "rim_um": "rim_height"}
SHARES = {"E_i^r": "residual_internal", "kinetic": "kinetic", "absorbed": "absorbed"}


def main() -> None:
    """Write table.csv."""
    results, runs, out = map(Path, sys.argv[1:4])
    with results.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if not row["fault"]]
    lines = []
    for row in rows:
        scene = RunFolder.open(runs / row["scene"]).scene()
        line = {
            "cell_um": f"{scene.grid.cell * 1e6:g}",
            "geometry": scene.grid.geometry,
            "volumetric_strain": scene.numerics.volumetric_strain,
            "points": row["run.points"],
            "steps": row["run.steps"],
        }
        line |= {name: f"{float(row['crater.' + key] or 'nan') * 1e6:.2f}" for name, key in LENGTHS.items()}
        line["volume_um3"] = f"{float(row['crater.volume'] or 'nan') * 1e18:.0f}"
        line |= {name: f"{float(row['energy.' + key]):.4f}" for name, key in SHARES.items()}
        line["ledger_error"] = f"{float(row['energy.ledger_error']):.0e}"
        lines.append(line | {key: row[key] for key in ("version", "commit")})
    lines.sort(key=lambda line: (-float(line["cell_um"]), line["volumetric_strain"], line["geometry"]))
    with (out / "table.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(lines[0]))
        table.writeheader()
        table.writerows(lines)


if __name__ == "__main__":
    main()
