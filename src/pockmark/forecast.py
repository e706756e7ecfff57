"""What is known of a run before it starts: its size, its time, and what a careful analyst would ask."""

import math
from dataclasses import dataclass, field
from pathlib import Path

from scipy.optimize import brentq

from . import _core
from .bodies import Solid
from .cautions import ENOUGH_CELLS_ACROSS
from .errors import shown
from .lengths import in_metres
from .materials import Material, MieGruneisen
from .prospect import fit_warnings, impact_rows, settling_warnings
from .scene import FACES, Scene

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
MIN_CELLS_ACROSS = 4  # of the grid across the projectile's diameter
FRAME_SPEED = (
    3000.0  # m/s: below it a plane shock with trilinear functions depends on the frame (docs/theory.md)
)


@dataclass(frozen=True)
class Forecast:
    """What a run will take, before anything runs."""

    points: int
    cells: int
    steps: int
    memory: float  # bytes: the peak of `pockmark run`, its measuring and drawing included
    disk: float  # bytes of the run folder
    seconds: float
    cells_across: float | None  # of the grid across the smallest projectile
    impact: tuple[tuple[str, str], ...] = ()  # what hits, and how hard: names and values
    warnings: list[str] = field(default_factory=list)


def forecast(scene: Scene, threads: int) -> Forecast:
    """Forecast points, cells, steps, memory, disk and time of a scene, with warnings."""
    points = sum(body.count(scene.grid.box) for body in scene.body)
    steps = math.ceil(scene.steps_about)
    slower = 2.8 if scene.numerics.shape_functions == "quadratic" else 1.0
    rate = TYPICAL_RATE[_core.build_info()["isa"]] * threads
    memory = _peak(scene, points)
    return Forecast(
        points=points,
        cells=scene.grid.cell_count,
        steps=steps,
        memory=memory,
        disk=_disk(scene, points),
        seconds=points * steps * slower / rate,
        cells_across=cells_across(scene),
        impact=tuple(impact_rows(scene)),
        warnings=warnings(scene) + _memory_warning(memory, available_memory()),
    )


def cells_across(scene: Scene) -> float | None:
    """Return the cells of the grid across the smallest projectile, with its mirror image; None without a projectile."""
    tolerance = 1e-9 * scene.grid.cell
    across = [scene.body[i].least_width(scene.mirrors, tolerance) for i in scene.projectiles]
    return min(across) / scene.grid.cell if across else None


def is_too_coarse(scene: Scene) -> bool:
    """Return whether fewer than MIN_CELLS_ACROSS cells lie across a projectile."""
    across = cells_across(scene)
    return across is not None and across < MIN_CELLS_ACROSS * (1 - 1e-9)


def available_memory() -> float | None:
    """Return the memory that can be had without swapping, bytes; None where the system does not tell."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    found = [line.split()[1] for line in lines if line.startswith("MemAvailable:")]
    return 1024.0 * float(found[0]) if found else None


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
    """Say what a careful analyst would ask about this scene."""
    out = lasting_warnings(scene) + _top_warning(scene) + _resolution_warning(scene) + fit_warnings(scene)
    for i, body in enumerate(scene.body):
        said = _pitch_warning(body)
        if body.projectile:
            said += _face_warnings(body, scene)
        else:
            said += _short_side_warnings(body, scene)
        out += [f"body[{i}] '{shown(body.name)}': {text}" for text in said]
    for name in dict.fromkeys(b.material for b in scene.body):
        out += _failure_warning(name, scene)
    return out


def lasting_warnings(scene: Scene) -> list[str]:
    """Say what makes the result of this scene's run worth less, however the run goes: it stands in the result, too."""
    out = _motion_warnings(scene) + frame_warnings(scene) + _range_warnings(scene) + settling_warnings(scene)
    for i, body in enumerate(scene.body):
        out += [f"body[{i}] '{shown(body.name)}': {text}" for text in _lattice_warnings(body, scene)]
    return out


def _motion_warnings(scene: Scene) -> list[str]:
    """Say whether there is an impact at all."""
    if not any(any(body.velocity or ()) for body in scene.body):
        if not scene.projectiles:
            return ["no body is marked projectile = true: nothing moves"]
        if scene.impact.speed == 0:
            return ["impact.speed is 0: nothing moves"]
    return []


def _top_warning(scene: Scene) -> list[str]:
    """Say whether there is something to measure a crater in."""
    out = []
    tops = [scene.body[i].box[1][2] for i in scene.targets]
    if not any(abs(top) <= 0.01 * scene.grid.cell for top in tops):
        found = ", ".join(f"{top * 1e6:.4g} um" for top in tops) or "no target"
        out.append(f"no target's top lies at z = 0, where the crater is measured from (found {found})")
    return out


def _memory_warning(needed: float, available: float | None) -> list[str]:
    if available is None or needed <= available:
        return []
    return [f"it needs {needed / 2**20:,.0f} MiB of memory, {available / 2**20:,.0f} MiB are free"]


def _resolution_warning(scene: Scene) -> list[str]:
    across = cells_across(scene)
    if across is None or across >= ENOUGH_CELLS_ACROSS * (1 - 1e-9):
        return []
    return [
        f"{across:.3g} cells across the projectile, fewer than {ENOUGH_CELLS_ACROSS}: its crater comes out too small (model 1 with 5 has "
        "15 um where 10 give 17.5 um)"
        + (f"; fewer than {MIN_CELLS_ACROSS} run with --coarse only" if is_too_coarse(scene) else "")
    ]


def frame_warnings(scene: Scene) -> list[str]:
    """Return what the shape functions do to a plane shock in a moving frame; nothing where they do not."""
    if scene.numerics.shape_functions != "trilinear" or not 0 < scene.impact.speed < FRAME_SPEED:
        return []
    return [
        "trilinear shape functions make a plane shock depend on the frame: where the shocked material is in motion, its pressure is 49 % "
        "low at 1 km/s and 17 % at 2.2 km/s after a hundred cells, and right where it stands still (quadratic: within 1 %)"
    ]


def _range_warnings(scene: Scene) -> list[str]:
    """Name the materials that the impact shocks beyond the range of their laws."""
    normal = scene.impact.speed * math.cos(scene.impact.angle)
    reached: dict[str, float] = {}
    for a in scene.projectiles:
        for b in scene.targets:
            names = (scene.body[a].material, scene.body[b].material)
            p, t = (scene.materials[name] for name in names)
            behind = _particle_speed(t, p, normal)
            for name, up in zip(names, (normal - behind, behind), strict=True):
                reached[name] = max(reached.get(name, 0.0), up)
    return [
        f"material '{name}': the impact drives it to {up / 1e3:.3g} km/s behind the shock, as {up / 5e2:.3g} km/s on itself would; its "
        f"laws are meant for up to {limit / 1e3:.3g} km/s"
        for name, up in reached.items()
        if (limit := scene.materials[name].max_speed) is not None and 2 * up > limit * (1 + 1e-9)
    ]


def _particle_speed(target: Material, projectile: Material, speed: float) -> float:
    """Return the particle speed of the target behind the shock, m/s, by impedance match: the pressures of both are equal."""

    def pressure(of: Material, up: float) -> float:
        c0 = math.sqrt(of.bulk_modulus / of.density)
        return of.density * up * (c0 + (of.eos.s if isinstance(of.eos, MieGruneisen) else 0.0) * up)

    return float(brentq(lambda up: pressure(target, up) - pressure(projectile, speed - up), 0.0, speed))


def _lattice_warnings(body: Solid, scene: Scene) -> list[str]:
    """Say whether the points are enough for the body and the grid, and what its mass was rounded to."""
    out = []
    if body.coarseness:
        out.append(body.coarseness)
    pitch = max(fit.pitch for fit in body.fits)
    per_cell = scene.grid.cell / pitch
    if per_cell < 2 * (1 - 1e-9):
        out.append(f"{per_cell:.2g} points a cell along an axis; 2 is the usual least")
    if body.rounded and abs((ratio := body.count() * body.point_volume / body.written_volume) - 1) > 0.01:
        out.append(f"rounded to whole spacings, it has {ratio:.3g} times the mass of the written size")
    return out


def _pitch_warning(body: Solid) -> list[str]:
    """Say whether points lie closer than asked."""
    closest = min(fit.pitch for fit in body.fits)
    if closest >= 0.99 * body.spacing:
        return []
    return [
        f"its points lie {in_metres(closest)} apart, not {in_metres(body.spacing)}, so that a whole number fits"
    ]


def _short_side_warnings(target: Solid, scene: Scene) -> list[str]:
    """Name the sides that end less than a cell short of a face which is not free: there is a gap, and they are free."""
    out = []
    for i, (face, kind) in enumerate(zip(FACES, scene.boundary.faces, strict=True)):
        axis, above = i // 2, i % 2
        gap = (1 if above else -1) * (scene.grid.box[above][axis] - target.box[above][axis])
        if kind != "free" and 1e-6 < gap / scene.grid.cell < 1 - 1e-6:
            out.append(
                f"its points end {gap * 1e6:.3g} um short of the {kind} face {face}, at {scene.grid.box[above][axis] * 1e6:.5g} um"
            )
    return out


def _face_warnings(projectile: Solid, scene: Scene) -> list[str]:
    """Name the faces, the one under the target included, that lie closer than two diameters."""
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
    if scene.targets:
        gaps["z_lower, under the target's surface"] = -scene.grid.lower[2]
    return [
        f"{in_metres(gap, 3)} from the face {face}, less than two diameters; the crater may feel it"
        for face, gap in gaps.items()
        if gap < 2 * diameter
    ]


def _failure_warning(name: str, scene: Scene) -> list[str]:
    f = scene.materials[name].failure
    if f.treatment == "inactive" or f.D2 == 0.0 or f.D3 == 0.0 or -f.D1 / f.D2 <= 0.0:
        return []
    limit = math.log(-f.D1 / f.D2) / f.D3
    return [
        f"material '{name}': its failure strain is <= 0 above a triaxiality of {limit:.4f}; there the treatment "
        f"'{f.treatment}' decides the crater"
    ]
