"""What is known of a run before it starts: its size, its time, and what a careful analyst would ask."""

import math
from dataclasses import dataclass, field

from . import _core
from .bodies import Block, Body
from .lattice import block_counts, count
from .scene import Scene

# Peak of the resident memory, measured (benchmarks/README.md, "Memory"). The core keeps, by the bytes of a number:
NUMBERS_PER_POINT, BYTES_PER_POINT = 21, 22  # fields, the sort's scratch; body, id, cell, order, runs
NUMBERS_PER_NODE, BYTES_PER_NODE = 16, 4
BYTES_PER_POINT_WRITTEN = (
    72  # while a snapshot is written: the deviator as doubles, the effective stress and its terms
)
BYTES_PER_POINT_MEASURED = 140  # when the core is gone: the fields that are read, and the crater's
RUNNING, DRAWING = 148 * 2**20, 180 * 2**20  # Python and the libraries; with what matplotlib loads to draw
# On the disk, whatever the precision:
BYTES_PER_POINT_KEPT = 174  # of a snapshot
BYTES_PER_ROW = 450  # of the history
BYTES_PER_SNAPSHOT, BYTES_OF_PICTURES = 25_000, 300_000
# Particle-steps a second a core, measured with the default scheme (benchmarks/README.md).
TYPICAL_RATE = {"avx512": 19e6, "avx2": 15e6, "scalar": 4e6}


@dataclass(frozen=True)
class Forecast:
    """What a run will take, before anything runs."""

    points: int
    cells: int
    steps: int
    memory: float  # bytes: the peak of `pockmark run`, its measuring and drawing included
    disk: float  # bytes of the run folder
    seconds: float
    warnings: list[str] = field(default_factory=list)


def forecast(scene: Scene, threads: int) -> Forecast:
    """Points, cells, steps, memory, disk and time of a scene, with warnings."""
    points = sum(count(body, scene.grid.box) for body in scene.body)
    steps = math.ceil(scene.steps_about)
    slower = 2.8 if scene.numerics.shape_functions == "quadratic" else 1.0
    rate = TYPICAL_RATE[_core.build_info()["isa"]] * threads
    return Forecast(
        points=points,
        cells=scene.grid.cell_count,
        steps=steps,
        memory=_peak(scene, points),
        disk=_disk(scene, points),
        seconds=points * steps * slower / rate,
        warnings=warnings(scene),
    )


def _peak(scene: Scene, points: int) -> float:
    """Return the largest resident memory, bytes: while a snapshot is written, or while the crater is measured and drawn."""
    number = 8 if scene.numerics.precision == "double" else 4
    nodes = scene.grid.node_count * (2 if scene.contact else 1)
    core = points * (NUMBERS_PER_POINT * number + BYTES_PER_POINT)
    core += nodes * (NUMBERS_PER_NODE * number + BYTES_PER_NODE)
    running = RUNNING + core + points * BYTES_PER_POINT_WRITTEN
    return max(running, DRAWING + points * BYTES_PER_POINT_MEASURED)


def _disk(scene: Scene, points: int) -> float:
    """Return the size of the run folder, bytes, if no point leaves the grid."""
    # The last ones, at the end, are not counted twice where the interval divides it.
    snapshots, rows = (
        1 + math.ceil(scene.end_time / interval - 1e-9)
        for interval in (scene.output.snapshots, scene.output.history)
    )
    kept = snapshots * (points * BYTES_PER_POINT_KEPT + BYTES_PER_SNAPSHOT)
    return kept + rows * BYTES_PER_ROW + BYTES_OF_PICTURES


def warnings(scene: Scene) -> list[str]:
    """What a careful analyst would ask about this scene."""
    out = _impact_warnings(scene)
    for i, body in enumerate(scene.body):
        said = _lattice_warnings(body, scene)
        if body.projectile:
            said += _face_warnings(body, scene)
        out += [f"body[{i}] '{body.name}': {text}" for text in said]
    for name in dict.fromkeys(b.material for b in scene.body):
        out += _failure_warning(name, scene)
    return out


def _impact_warnings(scene: Scene) -> list[str]:
    """Whether there is an impact at all, and where its depth is measured from."""
    out = []
    if not scene.projectiles:
        out.append("no body is marked projectile = true: nothing moves")
    elif scene.impact.speed == 0:
        out.append("impact.speed is 0: nothing moves")
    tops = [scene.body[i].box[1][2] for i in scene.targets]
    if not any(abs(top) <= 0.01 * scene.grid.cell for top in tops):
        found = ", ".join(f"{top * 1e6:.4g} um" for top in tops) or "no target"
        out.append(f"no target's top lies at z = 0, where the crater is measured from (found {found})")
    return out


def _lattice_warnings(body: Body, scene: Scene) -> list[str]:
    """Whether the points are enough for the body and the grid, and lie where the body is written."""
    out = []
    if not isinstance(body, Block) and round(2 * body.balls[0].reach) < 4:
        out.append("fewer than 4 points across the sphere")
    per_cell = scene.grid.cell / body.spacing
    if per_cell < 2:
        out.append(f"{per_cell:.2g} points a cell along an axis; 2 is the usual least")
    if abs(off := _surface_offset(body)) > 0.01 * body.spacing:
        out.append(
            f"its points' surface lies {off * 1e6:+.3g} um from the written one, as its spacing does not divide its size"
        )
    return out


def _face_warnings(projectile: Body, scene: Scene) -> list[str]:
    """Faces, the one under the target included, that lie closer than two diameters."""
    lower, upper = projectile.box
    diameter = upper[2] - lower[2]
    faces, mirrored = ("x_lower", "x_upper", "y_lower", "y_upper"), [(m.axis, m.above) for m in scene.mirrors]
    gaps = {}
    for i, face in enumerate(faces):
        axis, above = i // 2, bool(i % 2)
        if (axis, above) not in mirrored:
            gaps[face] = (
                scene.grid.corner[axis] - upper[axis] if above else lower[axis] - scene.grid.lower[axis]
            )
    gaps["z_lower, under the target's surface"] = -scene.grid.lower[2]
    return [
        f"{gap * 1e6:.3g} um from the face {face}, less than two diameters; the crater may feel it"
        for face, gap in gaps.items()
        if gap < 2 * diameter
    ]


def _surface_offset(body: Body) -> float:
    """How far the points reach beyond a block's upper face in z, or a sphere's radius, m; negative if short of it."""
    if not isinstance(body, Block):
        return body.balls[0].reach * body.spacing - (body.radius or 0.0)
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
