"""Rates of the step on this machine, a row a case in CSV: `python benchmarks/run.py [cases|growth|age|memory] [--only NAME]`.

cases: schemes, precisions, threads, instruction sets (rates.csv). growth: from a quarter to 8 million points
(growth.csv). age: through the whole of a run, in which debris spreads (age.csv). memory: the peak of `pockmark run`
and the size of its folder, beside what `pockmark check` forecasts (memory.csv).
"""

import argparse
import csv
import itertools
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from reporting import write_rows

from pockmark import Scene, Simulation, __version__
from pockmark.run.bench import bench, bench_scene
from pockmark.run.provenance import commit
from pockmark.scene.forecast import forecast

HERE = Path(__file__).parent
# The method of the paper, which all checkouts have; "default" is what a scene gets.
PLAIN = [
    word
    for key in ("volumetric_strain=points", "node_velocity=mean", "filter.interval=0")
    for word in ("--set", f"numerics.{key}")
]
QUADRATIC = ["--set", "numerics.shape_functions=quadratic"]
USAVG, USF, MUSL, USL = (
    ["--set", f"numerics.scheme={scheme}", *PLAIN] for scheme in ("usavg", "usf", "musl", "usl")
)
SINGLE, TWO = ["--precision", "single"], ["--threads", "2"]
CASES: dict[str, tuple[str, list[str]]] = {  # instruction set, arguments
    "usf": ("", USF),
    "usf, two threads": ("", [*USF, *TWO]),
    "usf, single": ("", [*USF, *SINGLE]),
    "usf, AVX2": ("avx2", USF),
    "usf, plain x86-64": ("scalar", USF),
    "usavg": ("", USAVG),
    "usavg, two threads": ("", [*USAVG, *TWO]),
    "usavg, single": ("", [*USAVG, *SINGLE]),
    "usavg, single, two threads": ("", [*USAVG, *SINGLE, *TWO]),
    "usavg, AVX2": ("avx2", USAVG),
    "usavg, plain x86-64": ("scalar", USAVG),
    "musl": ("", MUSL),
    "usl, cut-off .01": ("", [*USL, "--set", "numerics.mass_cutoff=0.01"]),  # without one it blows up here
    "usf, quadratic": ("", [*USF, *QUADRATIC]),
    "usavg, quadratic": ("", [*USAVG, *QUADRATIC]),
    "default": ("", []),
    "default, two threads": ("", TWO),
    "default, AVX2": ("avx2", []),
}
MEMORY = [60_000, 250_000, 2_000_000, 4_000_000]
GROWTH = [250_000, 500_000, 1_000_000, 2_000_000, 4_000_000, 8_000_000]


def fastest_of_five(once: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Return a row of the table. The machines are shared: what else runs there only slows."""
    result = max((once() for _ in range(5)), key=lambda r: r["particle_steps_per_second"])
    plain = result.get("plain_particle_steps_per_second")
    row = {
        "isa": result["isa"],
        "points": result["points"],
        "M_particle_steps_s": f"{result['particle_steps_per_second'] / 1e6:.2f}",
        "plain_driver_M": f"{plain / 1e6:.2f}" if plain else "",
        "copy_GB_s": f"{result['copy_bandwidth'] / 1e9:.1f}",
        "share_of_copy": f"{result['share_of_copy_bandwidth']:.2f}",
        "bytes_per_point": f"{result['bytes_per_point'] + result['grid_bytes_per_point']:.0f}",
    }
    return row | {f"{phase}_ns": f"{p['ns_per_point']:.1f}" for phase, p in result["phases"].items()}


def command_line(isa: str, arguments: list[str]) -> dict[str, Any]:
    """Return the figures of `pockmark bench` in a process of its own, on one thread unless told."""
    threads = [] if "--threads" in arguments else ["--threads", "1"]
    command = [sys.executable, "-m", "pockmark", "bench", "--json", *threads, *arguments]
    environment = os.environ | ({"POCKMARK_ISA": isa} if isa else {})
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return dict(json.loads(done.stdout))


def cases(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Time model 1 of Table 2, case by case."""
    for name, (isa, arguments) in CASES.items():
        if not only or name in only:
            whole = [*arguments, "--points", "252112"]
            yield {"case": name} | fastest_of_five(partial(command_line, isa, whole))


def growth(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Time the same impact in ever smaller cells."""
    for points in GROWTH:
        name = f"{points / 1e6:g} million"
        if not only or name in only:
            once = partial(bench, bench_scene(points), 1, compare=False)
            yield {"case": name} | fastest_of_five(once)


def age(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Measure rates in windows of 10 ns along whole runs, on one thread."""
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


def memory(only: list[str] | None) -> Iterator[dict[str, Any]]:
    """Run a few steps, two snapshots, the measures and the pictures, in a process of its own on one thread."""
    short = ("end_time='1 ns'", "output.snapshots='1 ns'")
    for points, precision in itertools.product(MEMORY, ("double", "single")):
        name = f"{points / 1e6:g} million, {precision}"
        if not only or name in only:
            scene = bench_scene(points, (*short, f"numerics.precision={precision}"))
            expected = forecast(scene, 1)
            peak, disk = peak_and_disk(scene)
            yield {
                "case": name,
                "points": expected.points,
                "peak_MiB": f"{peak / 2**20:.0f}",
                "forecast_MiB": f"{expected.memory / 2**20:.0f}",
                "off": f"{expected.memory / peak - 1:+.1%}",
                "disk_MB": f"{disk / 1e6:.1f}",
                "forecast_MB": f"{expected.disk / 1e6:.1f}",
            }


def peak_and_disk(scene: Scene) -> tuple[int, int]:
    """Return the bytes of `pockmark run`: its peak of resident memory, and its folder."""
    with tempfile.TemporaryDirectory() as folder:
        file, out = Path(folder) / "scene.toml", Path(folder) / "run"
        scene.save(file)
        command = [sys.executable, "-m", "pockmark", "run", file, "-o", out, "--quiet", "--threads", "1"]
        words = [str(word) for word in command]
        child = os.posix_spawn(
            sys.executable,
            words,
            os.environ,
            file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)],
        )
        _, status, used = os.wait4(child, 0)
        if status:
            raise SystemExit(f"{' '.join(words)}: failed")
        return used.ru_maxrss * 1024, sum(part.stat().st_size for part in out.iterdir())


def keep(path: Path, row: dict[str, Any]) -> None:
    """Put a row into a CSV table, in place of an older one of the same case, with the version that made it."""
    rows: dict[str, dict[str, Any]] = {}
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            rows = {there["case"]: there for there in csv.DictReader(file)}
    rows[row["case"]] = row | {"version": __version__, "commit": commit()}
    write_rows(path, list(rows.values()))


TABLES = {
    "cases": (cases, "rates.csv"),
    "growth": (growth, "growth.csv"),
    "age": (age, "age.csv"),
    "memory": (memory, "memory.csv"),
}


def main() -> None:
    """Run what is asked for and keep the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="?", choices=list(TABLES), default="cases")
    parser.add_argument("--only", action="append")
    options = parser.parse_args()
    rows, table = TABLES[options.what]
    for row in rows(options.only):
        print(row, flush=True)
        keep(HERE / table, row)


if __name__ == "__main__":
    main()
