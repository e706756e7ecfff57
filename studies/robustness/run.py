"""Does a run stay up? The group of Table 3, model 1 (4.5 km/s), and one sphere at 5 km/s, under each scheme."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from campaign import ROOT, arguments, keep, row

from pockmark import Scene

HERE = Path(__file__).parent
SCENES = {
    "group-4500": (ROOT / "examples" / "group-4500.toml", []),
    "single-5000": (ROOT / "examples" / "normal-2200.toml", ["impact.speed='5 km/s'"]),
}
CURES = {
    "usavg": [],
    "usavg-cutoff-0.0001": ["numerics.mass_cutoff=0.0001"],
    "usavg-cutoff-0.01": ["numerics.mass_cutoff=0.01"],
    "usavg-cfl-0.25": ["numerics.cfl=0.25"],
    "usavg-quadratic": ["numerics.shape_functions=quadratic"],
    "usf": ["numerics.scheme=usf"],
    "usf-cfl-0.25": ["numerics.scheme=usf", "numerics.cfl=0.25"],
    "usf-quadratic": ["numerics.scheme=usf", "numerics.shape_functions=quadratic"],
    "musl": ["numerics.scheme=musl"],
    "usl": ["numerics.scheme=usl"],
}


def main() -> None:
    """Run what is asked for and write the table."""
    options = arguments(__doc__)
    quick = ["end_time='0.005 us'", "output.snapshots='0.005 us'"] if options.quick else []
    for scene, (path, base) in SCENES.items():
        for cure, changes in CURES.items():
            name = f"{scene}-{cure}"
            if options.only and name not in options.only:
                continue
            figures = row(name, Scene.load(path, [*base, *changes, *quick]), options.out, options.threads)
            keep((options.out if options.quick else HERE) / "table.csv", figures)


if __name__ == "__main__":
    main()
