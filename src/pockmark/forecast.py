"""What is known of a run before it starts: its size, its time, and what a careful analyst would ask."""

import math
from dataclasses import dataclass, field

from . import _core
from .bodies import Block, Sphere
from .points import block_counts, lattice
from .scene import Scene

BYTES_PER_POINT = 190  # fields, indices and the sort's scratch, fp64
BYTES_PER_NODE = 164
# Particle-steps a second a core, measured with the default scheme (benchmarks/README.md).
TYPICAL_RATE = {"avx512": 9e6, "avx2": 6e6, "scalar": 2.5e6}


@dataclass(frozen=True)
class Forecast:
    """What a run will take, before anything runs."""

    points: int
    cells: int
    steps: int
    memory: float  # bytes
    seconds: float
    warnings: list[str] = field(default_factory=list)


def forecast(scene: Scene, threads: int) -> Forecast:
    """Points, cells, steps, memory and time of a scene, with warnings."""
    points = sum(_point_count(scene, i) for i in range(len(scene.body)))
    speed = max(m.dilatational_speed for m in scene.materials.values()) + scene.impact.speed
    # Shocked material is faster and strain limits some steps: 1.35 is what model 1 needed.
    steps = math.ceil(1.35 * scene.end_time / (scene.numerics.cfl * scene.grid.cell / speed))
    nodes = math.prod(n + 3 for n in scene.grid.cells)
    slower = 2.0 if scene.numerics.shape_functions == "quadratic" else 1.0
    size = 1.0 if scene.numerics.precision == "double" else 0.5
    rate = TYPICAL_RATE[_core.build_info()["isa"]] * threads
    return Forecast(
        points=points,
        cells=scene.grid.cell_count,
        steps=steps,
        memory=size * (points * BYTES_PER_POINT + nodes * BYTES_PER_NODE),
        seconds=points * steps * slower / rate,
        warnings=warnings(scene),
    )


def _point_count(scene: Scene, index: int) -> int:
    x = lattice(scene.body[index])
    lower, upper = scene.grid.lower, scene.grid.corner
    return int(((x >= lower) & (x < upper)).all(axis=1).sum())


def warnings(scene: Scene) -> list[str]:
    """What a careful analyst would ask about this scene."""
    out = []
    for i, body in enumerate(scene.body):
        lower, upper = body.box
        if isinstance(body, Sphere) and round(2 * body.radius / body.spacing) < 4:
            out.append(f"body[{i}] '{body.name}': fewer than 4 points across the sphere")
        per_cell = scene.grid.cell / body.spacing
        if per_cell < 2:
            out.append(
                f"body[{i}] '{body.name}': {per_cell:.2g} points a cell along an axis; 2 is the usual least"
            )
        if abs(off := _surface_offset(body)) > 0.01 * body.spacing:
            out.append(
                f"body[{i}] '{body.name}': its points' surface lies {off * 1e6:+.3g} um from the written one, as its "
                "spacing does not divide its size"
            )
        if not body.projectile:
            continue
        diameter = upper[2] - lower[2]
        for axis, name in ((0, "x"), (1, "y")):
            faces = (scene.boundary.faces[2 * axis], scene.boundary.faces[2 * axis + 1])
            gaps = (lower[axis] - scene.grid.lower[axis], scene.grid.corner[axis] - upper[axis])
            near = [g for g, f in zip(gaps, faces, strict=True) if f != "symmetry" and g < 2 * diameter]
            if near:
                out.append(
                    f"body[{i}] '{body.name}': {min(near) * 1e6:.3g} um from a face along {name}, less than two "
                    "diameters; the crater may feel it"
                )
    for name in dict.fromkeys(b.material for b in scene.body):
        out += _failure_warning(name, scene)
    return out


def _surface_offset(body: Block | Sphere) -> float:
    """How far the points reach beyond a block's upper face in z, or a sphere's radius, m; negative if short of it."""
    if isinstance(body, Sphere):
        return max(1, round(body.radius / body.spacing)) * body.spacing - body.radius
    return block_counts(body)[2] * body.spacing - (body.upper[2] - body.lower[2])


def _failure_warning(name: str, scene: Scene) -> list[str]:
    f = scene.materials[name].failure
    if f.treatment == "inactive" or f.D2 == 0.0 or f.D3 == 0.0 or -f.D1 / f.D2 <= 0.0:
        return []
    limit = math.log(-f.D1 / f.D2) / f.D3
    return [
        f"material '{name}': its failure strain is <= 0 above a triaxiality of {limit:.4f}; there the treatment "
        f"'{f.treatment}' decides the crater"
    ]
