"""Table 2 of Liu et al. 2015: one sphere, normal impact at 2.2 km/s, models 1 to 3; failure treatments and schemes beside it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from campaign import ROOT, arguments, keep, row

from pockmark import Scene

HERE = Path(__file__).parent
SCENE = ROOT / "examples" / "normal-2200.toml"

# h_p^t, h_p^p, h_e (um), radius of the sphere (um): the paper's Table 2 as reconstructed from its point counts.
MODELS = {1: (2.0, 1.0, 4.0, 10.0), 2: (1.5, 0.75, 3.0, 9.75), 3: (1.0, 0.5, 2.0, 10.0)}
PAPER = {1: (0.9302, 14.3), 2: (0.9256, 16.2), 3: (0.9295, 17.5)}
TREATMENTS = {
    "inactive": ["failure.treatment=inactive"],
    "no_damage": [],
    "signed": ["failure.treatment=signed"],
    "clamp_triaxiality": ["failure.treatment=clamp_triaxiality"],
    "floor-0.1": ["failure.treatment=floor", "failure.floor=0.1"],
    "floor-0.001": ["failure.treatment=floor", "failure.floor=0.001"],
}
SCHEMES = {
    "usf": ["numerics.scheme=usf"],
    "usf-cutoff-0.0001": ["numerics.scheme=usf", "numerics.mass_cutoff=0.0001"],
    "usf-cfl-0.25": ["numerics.scheme=usf", "numerics.cfl=0.25"],
    "musl": ["numerics.scheme=musl"],
    "musl-cfl-0.9": ["numerics.scheme=musl", "numerics.cfl=0.9"],
    "usavg-quadratic": ["numerics.shape_functions=quadratic"],
    "usavg-single": ["numerics.precision=single"],
    "usavg-no-viscosity": [
        "materials.al2024-liu2015.viscosity.quadratic=0.0",
        "materials.al2024-liu2015.viscosity.linear=0.0",
    ],
}


def model(number: int, *changes: str) -> Scene:
    """The scene of one of the paper's models."""
    target, projectile, cell, radius = MODELS[number]
    table = Scene.load(SCENE, changes).to_dict()
    table["grid"]["cell"] = f"{cell} um"
    table["body"][0]["spacing"] = f"{target} um"
    table["body"][1] |= {
        "spacing": f"{projectile} um",
        "radius": f"{radius} um",
        "center": [0, 0, f"{radius} um"],
    }
    return Scene.from_dict(table)


def main() -> None:
    """Run what is asked for and write the tables."""
    options = arguments(__doc__)
    quick = ["end_time='0.02 us'", "output.snapshots='0.02 us'"] if options.quick else []

    def wanted(name: str) -> bool:
        return not options.only or name in options.only

    def table(file: str, cases: dict[str, tuple[int, list[str]]]) -> None:
        for name, (number, changes) in cases.items():
            if not wanted(name):
                continue
            energy, depth = PAPER[number]
            figures = row(name, model(number, *changes, *quick), options.out, options.threads)
            keep(
                (options.out if options.quick else HERE) / file,
                figures | {"paper_E_i^r": energy, "paper_C_p_um": depth},
            )

    material = "materials.al2024-liu2015."
    models = (1,) if options.quick else MODELS
    table("table-2.csv", {f"model-{n}": (n, []) for n in models})
    cases = {f"treatment-{t}": (1, [material + c for c in changes]) for t, changes in TREATMENTS.items()}
    table("failure-treatments.csv", dict(list(cases.items())[:2]) if options.quick else cases)
    if not options.quick:
        table("schemes.csv", {f"scheme-{s}": (1, changes) for s, changes in SCHEMES.items()})


if __name__ == "__main__":
    main()
