"""What the studies share: run a scene with overrides, measure it, keep a row of a table."""

import argparse
import csv
import subprocess
import time
from collections.abc import Mapping
from pathlib import Path

import pockmark
from pockmark import Scene, measure, run_scene

ROOT = Path(__file__).parents[1]


def arguments(text: str | None) -> argparse.Namespace:
    """--quick (coarse and short, for CI), --out (folder of the runs), --only NAME, --threads."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=Path("runs"))
    parser.add_argument("--only", action="append")
    parser.add_argument("--threads", type=int, default=None)
    return parser.parse_args()


def row(name: str, scene: Scene, out: Path, threads: int | None) -> dict[str, object]:
    """Run one scene and return what the tables need; a run that stops is a row too."""
    print(f"{name} ...", flush=True)
    start = time.perf_counter()
    try:
        folder, _ = run_scene(scene, out / name, threads=threads, force=True, progress=False)
    except pockmark.PockmarkError as error:
        return {"case": name, "outcome": str(error).partition(": ")[2]}
    result = measure(folder.path)
    crater, energy, run = result["crater"], result["energy"], result["run"]
    worst = abs(folder.history()["error"] / folder.history()["initial"]).max()
    figures: dict[str, object] = {
        "case": name,
        "outcome": result["run"]["status"],
        "treatment": "; ".join(sorted({m.failure.treatment for m in scene.materials.values()})),
        "scheme": run["scheme"],
        "shape": run["shape_functions"],
        "cfl": scene.numerics.cfl,
        "points": run["points"],
        "cells": run["cells"],
        "steps": run["steps"],
        "time_us": f"{run['time'] * 1e6:.3f}",
        "E_i^r": f"{energy['residual_internal']:.4f}",
        "E_in_grid": f"{energy['internal']:.4f}",
        "kinetic": f"{energy['kinetic']:.4f}",
        "absorbed": f"{energy['absorbed']:.4f}",
        "C_p_um": f"{crater['depth'] * 1e6:.2f}" if crater["depth"] else "",
        "D_c_um": f"{crater['diameter'] * 1e6:.2f}" if crater["diameter"] else "",
        "ledger_error": f"{energy['ledger_error']:+.5f}",
        "largest_ledger_error": f"{worst:.5f}",
        "largest_compression": f"{run['max_compression']:.3f}",
        "failed_points": result["counters"]["failed_points"],
        "wall_s": f"{time.perf_counter() - start:.0f}",
    }
    print("  " + ", ".join(f"{k} {v}" for k, v in figures.items() if k != "case"), flush=True)
    return figures


def commit() -> str:
    """The commit that makes the rows; "-dirty" if anything but the tables has changed since."""

    def git(*words: str) -> str:
        result = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
        return result.stdout.strip()

    changed = git("status", "--porcelain", "--", ":/", ":(exclude,top,glob)**/*.csv")
    return git("describe", "--always") + ("-dirty" if changed else "")


def keep(path: Path, figures: Mapping[str, object]) -> None:
    """Put a row into a CSV table, in place of an older one of the same case, with the version that made it."""
    new = {k: str(v) for k, v in figures.items()} | {"version": pockmark.__version__, "commit": commit()}
    rows: list[dict[str, str]] = []
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    cases = [r["case"] for r in rows]
    if new["case"] in cases:
        rows[cases.index(new["case"])] = new
    else:
        rows.append(new)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(dict.fromkeys(k for r in rows for k in r)), restval="")
        writer.writeheader()
        writer.writerows(rows)
