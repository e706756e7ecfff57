"""Rates of the step on this machine: `python benchmarks/run.py [--only NAME]` keeps a row a case in rates.csv."""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "studies"))
from campaign import keep

HERE = Path(__file__).parent
QUADRATIC = "numerics.shape_functions=quadratic"
CASES: dict[str, tuple[str, list[str]]] = {
    "usavg": ("", []),
    "usavg, two threads": ("", ["--threads", "2"]),
    "usavg, single": ("", ["--precision", "single"]),
    "usf": ("", ["--set", "numerics.scheme=usf"]),
    "usf, two threads": ("", ["--set", "numerics.scheme=usf", "--threads", "2"]),
    "usf, single": ("", ["--set", "numerics.scheme=usf", "--precision", "single"]),
    "musl": ("", ["--set", "numerics.scheme=musl"]),
    "usavg, quadratic": ("", ["--set", QUADRATIC]),
    "usf, quadratic": ("", ["--set", "numerics.scheme=usf", "--set", QUADRATIC]),
    "usavg, AVX2": ("avx2", []),
    "usf, AVX2": ("avx2", ["--set", "numerics.scheme=usf"]),
    "usavg, plain x86-64": ("scalar", []),
}


def main() -> None:
    """Run the cases, one process each, on one thread unless the case says two."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", action="append")
    parser.add_argument("--points", default="252112")
    options = parser.parse_args()
    for name, (isa, arguments) in CASES.items():
        if options.only and name not in options.only:
            continue
        threads = [] if "--threads" in arguments else ["--threads", "1"]
        command = [sys.executable, "-m", "pockmark", "bench", "--json", "--points", options.points]
        done = subprocess.run(
            [*command, *threads, *arguments],
            env=os.environ | ({"POCKMARK_ISA": isa} if isa else {}),
            check=True,
            capture_output=True,
            text=True,
        )
        result = json.loads(done.stdout)
        row = {
            "case": name,
            "isa": result["isa"],
            "points": result["points"],
            "M_particle_steps_s": f"{result['particle_steps_per_second'] / 1e6:.2f}",
            "scalar_driver_M": f"{result.get('scalar_particle_steps_per_second', 0) / 1e6:.2f}",
            "copy_GB_s": f"{result['copy_bandwidth'] / 1e9:.1f}",
            "share_of_copy": f"{result['share_of_copy_bandwidth']:.2f}",
            "bytes_per_point": f"{result['bytes_per_point']:.0f}",
        }
        row |= {f"{phase}_ns": f"{p['ns_per_point']:.1f}" for phase, p in result["phases"].items()}
        print(row, flush=True)
        keep(HERE / "rates.csv", row)


if __name__ == "__main__":
    main()
