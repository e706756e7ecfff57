"""Rates of the step on this machine, a row a case in CSV: `python benchmarks/run.py [cases|growth|age] [--only NAME]`.

cases: schemes, precisions, threads, instruction sets (rates.csv). growth: from a quarter to 8 million points
(growth.csv). age: through the whole of a run, in which debris spreads (age.csv).
"""

import argparse
import csv
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from reporting import write_rows

from pockmark import Scene, Simulation, __version__
from pockmark.bench import bench, bench_scene
from pockmark.store import commit

HERE = Path(__file__).parent
QUADRATIC = ["--set", "numerics.shape_functions=quadratic"]
USF, MUSL, USL = (["--set", f"numerics.scheme={scheme}"] for scheme in ("usf", "musl", "usl"))
SINGLE, TWO = ["--precision", "single"], ["--threads", "2"]
CASES: dict[str, tuple[str, list[str]]] = {  # instruction set, arguments
    "usf": ("", USF),
    "usf, two threads": ("", [*USF, *TWO]),
    "usf, single": ("", [*USF, *SINGLE]),
    "usf, AVX2": ("avx2", USF),
    "usf, plain x86-64": ("scalar", USF),
    "usavg": ("", []),
    "usavg, two threads": ("", TWO),
    "usavg, single": ("", SINGLE),
    "usavg, single, two threads": ("", [*SINGLE, *TWO]),
    "usavg, AVX2": ("avx2", []),
    "usavg, plain x86-64": ("scalar", []),
    "musl": ("", MUSL),
    "usl, cut-off .01": ("", [*USL, "--set", "numerics.mass_cutoff=0.01"]),  # without one it blows up here
    "usf, quadratic": ("", [*USF, *QUADRATIC]),
    "usavg, quadratic": ("", QUADRATIC),
}
GROWTH = [250_000, 500_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000]


def fastest_of_five(once: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """A row of the table. The machines are shared: what else runs there only slows."""
    result = max((once() for _ in range(5)), key=lambda r: r["particle_steps_per_second"])
    scalar = result.get("scalar_particle_steps_per_second")
    row = {
        "isa": result["isa"],
        "points": result["points"],
        "M_particle_steps_s": f"{result['particle_steps_per_second'] / 1e6:.2f}",
        "scalar_driver_M": f"{scalar / 1e6:.2f}" if scalar else "",
        "copy_GB_s": f"{result['copy_bandwidth'] / 1e9:.1f}",
        "share_of_copy": f"{result['share_of_copy_bandwidth']:.2f}",
        "bytes_per_point": f"{result['bytes_per_point'] + result['grid_bytes_per_point']:.0f}",
    }
    return row | {f"{phase}_ns": f"{p['ns_per_point']:.1f}" for phase, p in result["phases"].items()}


def command_line(isa: str, arguments: list[str]) -> dict[str, Any]:
    """The figures of `pockmark bench` in a process of its own, on one thread unless told."""
    threads = [] if "--threads" in arguments else ["--threads", "1"]
    command = [sys.executable, "-m", "pockmark", "bench", "--json", *threads, *arguments]
    environment = os.environ | ({"POCKMARK_ISA": isa} if isa else {})
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return dict(json.loads(done.stdout))


def cases(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Model 1 of Table 2, case by case."""
    for name, (isa, arguments) in CASES.items():
        if not only or name in only:
            whole = [*arguments, "--points", "252112"]
            yield {"case": name} | fastest_of_five(partial(command_line, isa, whole))


def growth(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """The same impact in ever smaller cells."""
    for points in GROWTH:
        name = f"{points / 1e6:g} million"
        if not only or name in only:
            once = partial(bench, bench_scene(points), 1, compare=False)
            yield {"case": name} | fastest_of_five(once)


def age(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Rates in windows of 10 ns along whole runs, on one thread."""
    for example in ("normal-2200", "group-4500"):
        if only and example not in only:
            continue
        simulation = Simulation(Scene.load(HERE.parent / "examples" / f"{example}.toml"), 1)
        for start in (5, 50, 100, 200, 300, 400, 490):
            simulation.advance(start * 1e-9)
            work, seconds, sorts = simulation.point_steps, simulation.stepping_seconds, simulation.sorts
            steps = simulation.advance((start + 10) * 1e-9)
            rate = (simulation.point_steps - work) / (simulation.stepping_seconds - seconds)
            yield {
                "case": f"{example} from {start} ns",
                "points": simulation.points,
                "M_particle_steps_s": f"{rate / 1e6:.2f}",
                "steps_per_sort": f"{steps / max(simulation.sorts - sorts, 1):.0f}",
            }


def keep(path: Path, row: dict[str, Any]) -> None:
    """Put a row into a CSV table, in place of an older one of the same case, with the version that made it."""
    rows: dict[str, dict[str, Any]] = {}
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            rows = {there["case"]: there for there in csv.DictReader(file)}
    rows[row["case"]] = row | {"version": __version__, "commit": commit()}
    write_rows(path, list(rows.values()))


def main() -> None:
    """Run what is asked for and keep the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="?", choices=["cases", "growth", "age"], default="cases")
    parser.add_argument("--only", action="append")
    options = parser.parse_args()
    rows = {"cases": cases, "growth": growth, "age": age}[options.what](options.only)
    for row in rows:
        print(row, flush=True)
        keep(HERE / {"cases": "rates.csv", "growth": "growth.csv", "age": "age.csv"}[options.what], row)


if __name__ == "__main__":
    main()
