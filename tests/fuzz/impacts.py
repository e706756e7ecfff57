"""Random scenes that are valid and small: each is made from its seed alone and runs in seconds on one thread."""

import math
import random
from typing import Any

from pockmark.scene.materials import library

Table = dict[str, Any]
POINT_STEPS = 1e7  # the most of a run
POINTS = 30_000
FACES = ("transmitting", "transmitting", "free", "fixed", "symmetry")
TITLES = ("", "plain", "a $ b", "x [/b] y", "[red]x", "cost $\\frac{$", "a_{b", "M\u00fcller 100 %")
TREATMENTS = ("inactive", "no_damage", "signed", "floor", "clamp_triaxiality")


def impact(seed: int) -> Table:
    """Return a scene as a table: bodies of the library's materials under any laws, speeds of 0.1 to 30 km/s, sizes of
    0.1 to 1000 um, every face, scheme, shape function and precision."""
    rng = random.Random(f"run {seed}")
    names = rng.choices(list(library()), k=2)
    materials = {name: _material(rng, name) for name in names}
    speed = 10 ** rng.uniform(2.0, math.log10(30e3))
    angle = rng.choice((0.0, 0.0, rng.uniform(5, 80)))
    diameter = 10 ** rng.uniform(-7, -3)
    cell = diameter / rng.choice((2, 3, 4, 4, 5, 6, 8))
    while True:  # coarser until it fits
        scene = _scene(rng, names, diameter, cell)
        scene |= {"impact": {"speed": speed, "angle": f"{angle} deg"}, "materials": materials}
        if points_about(scene) <= POINTS:
            break
        cell *= 1.2
    if angle:  # an oblique impact breaks the symmetry about a plane x
        scene["boundary"] |= {
            face: "transmitting" for face in ("x_lower", "x_upper") if scene["boundary"][face] == "symmetry"
        }
    scene["title"] = TITLES[seed // 2 % len(TITLES)]
    scene["body"][0]["name"] = scene["title"] or "target"
    numerics = scene["numerics"] = _numerics(rng)
    if rng.random() < 0.4:
        scene["contact"] = {"friction": rng.choice((0.0, 0.1, 1.0))}
    fastest = speed + 8e3
    steps = min(POINT_STEPS / points_about(scene), 600)
    end = min(rng.uniform(1, 10) * diameter / speed, steps * numerics["cfl"] * cell / fastest / 1.35)
    scene["end_time"] = end
    scene["output"] = {"snapshots": end / 2, "history": end / 40}
    return scene


def points_about(scene: Table) -> float:
    """Return about how many points the scene has."""
    return sum(_volume(body) / body["spacing"] ** 3 for body in scene["body"])


def _volume(body: Table) -> float:
    if body["shape"] == "block":
        return math.prod(u - w for w, u in zip(body["lower"], body["upper"], strict=True))
    if body["shape"] == "cylinder":
        return math.pi * (body["radius"] ** 2 - body["inner_radius"] ** 2) * body["length"]
    return body.get("number", 1) * 4 / 3 * math.pi * body["radius"] ** 3


def _scene(rng: random.Random, names: list[str], diameter: float, cell: float) -> Table:
    """Return the grid, its faces and the bodies: a half model, a quarter or a whole one."""
    wide, below, above = (
        math.ceil(rng.uniform(*r) * diameter / cell) for r in ((1.2, 2.5), (1, 2.5), (1.3, 2.5))
    )
    half = rng.random() < 0.5
    lower = [-wide * cell, 0.0 if half else -wide * cell, -below * cell]
    upper = [wide * cell, wide * cell, above * cell]
    boundary = {f"{axis}_{side}": rng.choice(FACES) for axis in "xyz" for side in ("lower", "upper")}
    boundary["z_upper"] = rng.choice(("free", "free", *FACES))
    if half:
        boundary["y_lower"] = "symmetry"
    bodies = [
        *_targets(rng, names[0], lower, upper, cell),
        _projectile(rng, names[1], diameter, cell, lower, upper),
    ]
    return {"grid": {"lower": lower, "upper": upper, "cell": cell}, "boundary": boundary, "body": bodies}


def _targets(
    rng: random.Random, material: str, lower: list[float], upper: list[float], cell: float
) -> list[Table]:
    """Return a block on the grid's floor, two layers, or a plate with room below."""
    spacing = cell / rng.choice((1, 1.5, 2, 2, 2, 3))
    depth = -lower[2]
    kind = rng.choice(("block", "block", "block", "layers", "plate"))
    cuts = {"block": (depth,), "layers": (depth / 2, depth), "plate": (depth * rng.uniform(0.1, 0.5),)}[kind]
    return [
        {
            "name": f"target {i}",
            "shape": "block",
            "lower": [*lower[:2], -bottom],
            "upper": [*upper[:2], -top],
            "spacing": min(spacing, (bottom - top) / 2),
            "material": material,
        }
        for i, (top, bottom) in enumerate(zip((0.0, *cuts), cuts, strict=False))
    ]


def _projectile(
    rng: random.Random, material: str, diameter: float, cell: float, lower: list[float], upper: list[float]
) -> Table:
    """Return a ball, a brick, a swarm, a rod, a disc or a tube that touches the surface or starts up to a cell above it."""
    radius = diameter / 2
    spacing = radius / max(1, round(radius / (cell / rng.choice((1, 1.5, 2, 2, 2, 3, 4)))))
    gap = rng.choice((0.0, 0.0, rng.random())) * cell
    common = {"name": "projectile", "spacing": spacing, "material": material, "projectile": True}
    kind = rng.choice(("sphere", "sphere", "sphere", "block", "swarm", "cylinder"))
    if kind == "sphere":
        return common | {"shape": kind, "center": [0.0, 0.0, radius + gap], "radius": radius}
    if kind == "block":
        low = [-radius, lower[1] if lower[1] == 0 else -radius, gap]
        return common | {"shape": kind, "lower": low, "upper": [radius, radius, gap + diameter]}
    if kind == "cylinder":
        inner = rng.choice((0.0, rng.uniform(0.1, 0.6) * radius if radius > 3 * spacing else 0.0))
        size = {"radius": radius, "inner_radius": inner, "length": diameter * rng.uniform(0.3, 1.0)}
        return common | size | {"shape": kind, "axis": rng.choice("xyz"), "center": [0.0, 0.0], "gap": gap}
    patch = {"lower": [0.8 * x for x in lower[:2]], "upper": [0.8 * x for x in upper[:2]]}
    number = rng.choice((1, 2))
    small = {"radius": radius / 2, "spacing": spacing / 2, "height": radius / 2 + gap}
    return common | small | patch | {"shape": kind, "seed": rng.randrange(1000), "number": number}


def _material(rng: random.Random, name: str) -> Table:
    """Return a material of the library under other laws; none with a failure that its strength cannot feel."""
    row = library()[name]
    table: Table = {"based_on": name}
    if rng.random() < 0.15:
        table["eos"] = {"model": "linear", "bulk_modulus": f"{rng.choice((76, 130, 160))} GPa"}
    law = rng.choice(("johnson-cook", "johnson-cook", "johnson-cook", "elastic", "fluid"))
    if law == "johnson-cook":  # the library's own
        treatment = rng.choice(TREATMENTS)
        if row["failure"]["model"] == "johnson-cook":
            table["failure"] = {"treatment": treatment}
    else:
        modulus = {"shear_modulus": row["strength"]["shear_modulus"]} if law == "elastic" else {}
        table |= {"strength": {"model": law} | modulus, "failure": {"treatment": "inactive"}}
    if rng.random() < 0.2:
        table["viscosity"] = {"quadratic": rng.choice((0.0, 0.5, 2.0)), "linear": rng.choice((0.0, 0.2))}
    return table


def _numerics(rng: random.Random) -> Table:
    return {
        "scheme": rng.choice(("usavg", "usavg", "usf", "musl", "usl")),
        "shape_functions": rng.choice(("trilinear", "trilinear", "quadratic")),
        "cfl": rng.choice((0.2, 0.5, 0.5, 0.8)),
        "strain_limit": rng.choice((0.05, 0.2, 0.2)),
        "pic_fraction": rng.choice((0.0, 0.0, 0.1, 1.0)),
        "mass_cutoff": rng.choice((0.0, 0.0, 1e-4)),
        "precision": rng.choice(("double", "double", "single")),
    }
