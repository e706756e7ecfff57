"""The warnings of a scene: what a careful analyst would ask about it before it runs."""

import math

from scipy.optimize import brentq

from ..base.errors import shown
from ..base.geometry import ENOUGH_CELLS_ACROSS, has_few_cells
from ..base.lengths import in_metres
from .bodies import Solid
from .grid import FACES
from .materials import Material
from .prospect import fit_warnings, settling_warnings
from .scene import Scene

MIN_CELLS_ACROSS = 4  # cells across the projectile's diameter
# m/s: below it a plane shock with trilinear functions depends on the frame (docs/theory.md).
FRAME_SPEED = 5000.0


def cells_across(scene: Scene) -> float | None:
    """Return how many cells lie across the smallest projectile, its mirror image included.

    None without a projectile.
    """
    tolerance = 1e-9 * scene.grid.cell
    across = [scene.body[i].least_width(scene.mirrors, tolerance) for i in scene.projectiles]
    return min(across) / scene.grid.cell if across else None


def is_too_coarse(scene: Scene) -> bool:
    """Return whether fewer than MIN_CELLS_ACROSS cells lie across a projectile."""
    across = cells_across(scene)
    return across is not None and across < MIN_CELLS_ACROSS * (1 - 1e-9)


def warnings(scene: Scene) -> list[str]:
    """Return all warnings of a scene, a sentence each."""
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
    """Return the warnings that make a run's result worth less, however the run goes.

    They stand in the result, too.
    """
    out = _motion_warnings(scene) + frame_warnings(scene) + _range_warnings(scene) + settling_warnings(scene)
    for i, body in enumerate(scene.body):
        out += [f"body[{i}] '{shown(body.name)}': {text}" for text in _lattice_warnings(body, scene)]
    return out


def _motion_warnings(scene: Scene) -> list[str]:
    """Say that nothing moves, if that is so."""
    if not any(any(body.velocity or ()) for body in scene.body):
        if not scene.projectiles:
            return ["no body is marked projectile = true: nothing moves"]
        if scene.impact.speed == 0:
            return ["impact.speed is 0: nothing moves"]
    return []


def _top_warning(scene: Scene) -> list[str]:
    """Say that there is nothing in which to measure a crater, if that is so."""
    out = []
    tops = [scene.body[i].box[1][2] for i in scene.targets]
    if not any(abs(top) <= 0.01 * scene.grid.cell for top in tops):
        found = ", ".join(in_metres(top) for top in tops) or "no target"
        out.append(f"no target's top lies at z = 0, where the crater is measured from (found {found})")
    return out


def _resolution_warning(scene: Scene) -> list[str]:
    """Say that few cells lie across the projectile, if that is so."""
    across = cells_across(scene)
    if not has_few_cells(across):
        return []
    return [
        f"{across:.3g} cells across the projectile, fewer than {ENOUGH_CELLS_ACROSS}: its crater comes out too small (model 1 with 5 has "
        "15 um where 10 give 17.5 um)"
        + (f"; fewer than {MIN_CELLS_ACROSS} run with --coarse only" if is_too_coarse(scene) else "")
    ]


def frame_warnings(scene: Scene) -> list[str]:
    """Say what the shape functions do to a plane shock in a moving frame.

    Nothing is said if they do nothing.
    """
    numerics = scene.numerics
    is_smooth = numerics.shape_functions != "trilinear" or numerics.volumetric_strain == "cells"
    if is_smooth or not 0 < scene.impact.speed < FRAME_SPEED:
        return []
    return [
        "trilinear shape functions make a plane shock depend on the frame: where the shocked material is in motion, its pressure is 49 % "
        "low at 1 km/s, 17 % at 2.2 and 4 % at 4.5 km/s after a hundred cells, and right where it stands still (quadratic, or volumetric_strain cells: within 1 %)"
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
    """Return the speed of the target's material behind the shock, m/s, by impedance match.

    There the pressures of target and projectile are equal.
    """

    def excess(up: float) -> float:
        return target.shock_pressure(up) - projectile.shock_pressure(speed - up)

    return float(brentq(excess, 0.0, speed))


def _lattice_warnings(body: Solid, scene: Scene) -> list[str]:
    """Say whether the points are too few for the body or the grid, and what rounding did to the mass."""
    out = []
    if body.coarseness:
        out.append(body.coarseness)
    pitch = max(fit.pitch for fit in body.fits)
    per_cell = scene.grid.cell / pitch
    if per_cell < 2 * (1 - 1e-9):
        out.append(f"{per_cell:.2g} points a cell along an axis; 2 is the usual least")
    whole = scene.volume(body) if scene.grid.is_axisymmetric else body.count() * body.point_volume
    if body.rounded and abs((ratio := whole / body.written_volume) - 1) > 0.01:
        out.append(f"rounded to whole spacings, it has {ratio:.3g} times the mass of the written size")
    return out


def _pitch_warning(body: Solid) -> list[str]:
    """Say that points lie closer than asked, if they do."""
    closest = min(fit.pitch for fit in body.fits)
    if closest >= 0.99 * body.spacing:
        return []
    return [
        f"its points lie {in_metres(closest)} apart, not {in_metres(body.spacing)}, so that a whole number fits"
    ]


def _short_side_warnings(target: Solid, scene: Scene) -> list[str]:
    """Name the sides that end less than a cell short of a face that is not free.

    Such a side is free, for there is a gap.
    """
    out = []
    for i, (face, kind) in enumerate(zip(FACES, scene.boundary.faces, strict=True)):
        axis, above = i // 2, i % 2
        gap = (1 if above else -1) * (scene.grid.box[above][axis] - target.box[above][axis])
        if kind != "free" and 1e-6 < gap / scene.grid.cell < 1 - 1e-6:
            out.append(
                f"its points end {in_metres(gap, 3)} short of the {kind} face {face}, at {in_metres(scene.grid.box[above][axis], 5)}"
            )
    return out


def _face_warnings(projectile: Solid, scene: Scene) -> list[str]:
    """Name the faces closer than two diameters, the one under the target included."""
    lower, upper = projectile.box
    diameter = upper[2] - lower[2]
    faces, mirrored = ("x_lower", "x_upper", "y_lower", "y_upper"), [(m.axis, m.above) for m in scene.planes]
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
        if gap < 2 * diameter * (1 - 1e-9)
    ]


def _failure_warning(name: str, scene: Scene) -> list[str]:
    """Say what has to be known of the failure law of a material, if anything has."""
    caution = scene.materials[name].failure_caution
    return [f"material '{name}': {caution}"] if caution else []
