"""The rules that must hold between the tables of a scene."""

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..base.errors import found
from ..base.lengths import in_metres
from .bodies import Solid, overlap
from .grid import FACES, MAX_NODES
from .materials import Material

if TYPE_CHECKING:
    from .scene import Scene

MAX_POINTS = 2**32 - 2  # what the core can number
MAX_BODIES = 255
MAX_STEPS = 1e9  # they would take years
MAX_OUTPUTS = 1e6


def broken_rules(scene: "Scene") -> list[str]:
    """Return a sentence for each rule that a scene breaks.

    If it asks for too many points, that is the only sentence, for such points cannot be looked at.
    """
    for i, body in enumerate(scene.body):
        if body.material not in scene.materials:
            return [f"body[{i}].material: {found(body.material)}, which is not among the materials"]
    rules = (
        _can_be_saved,
        _bodies_fit,
        _contact_has_two_sides,
        _bodies_have_points,
        _symmetry_planes_are_kept,
        _scheme_can_use_cells,
        _velocities_can_be_carried,
        _comes_to_an_end,
    )
    # Points that are too many cannot be looked at.
    return [*_points_can_be_numbered(scene)] or [fault for rule in rules for fault in rule(scene)]


def _can_be_saved(scene: "Scene") -> Iterator[str]:
    """Say which character of a text cannot be written to a file."""
    try:
        scene.to_toml().encode()
    except UnicodeEncodeError as error:
        yield f"found {error.object[error.start]!r} in a text, expected Unicode"


def _points_can_be_numbered(scene: "Scene") -> Iterator[str]:
    """Say which body's points are too many for the core."""
    total = 0.0
    for i, body in enumerate(scene.body):
        about = body.rings_about if scene.grid.is_axisymmetric else body.points_about
        total += about
        if not total <= MAX_POINTS:
            key = f"body[{i}] '{body.name}': a spacing of {body.spacing:g} m"
            yield f"{key} makes {about:.3g} points, at most {MAX_POINTS} fit"
            return


def _bodies_fit(scene: "Scene") -> Iterator[str]:
    """Say which bodies are too many, share a name, lie outside the grid, or overlap."""
    if len(scene.body) > MAX_BODIES:
        yield f"body: found {len(scene.body)} bodies, at most {MAX_BODIES} are allowed"
        return
    names = [b.name for b in scene.body]
    for i, b in enumerate(scene.body):
        key = f"body[{i}] '{b.name}'"
        if names.count(b.name) > 1:
            yield f"{key}: two bodies have this name"
        yield from _outside(scene, key, b)
    for (i, a), (j, b) in itertools.combinations(enumerate(scene.body), 2):
        if overlap(a, b):
            yield f"body[{j}] '{b.name}': overlaps body[{i}] '{a.name}'"


def _contact_has_two_sides(scene: "Scene") -> Iterator[str]:
    """Say why contact is impossible."""
    if scene.contact and not (scene.projectiles and scene.targets):
        yield "contact: needs a body with projectile = true and one without"
    if scene.contact and 2 * scene.grid.node_count > MAX_NODES:
        nodes = 2 * scene.grid.node_count
        yield f"contact: doubles the nodes to {nodes:.3g}, at most {MAX_NODES} fit"


def _bodies_have_points(scene: "Scene") -> Iterator[str]:
    """Say which bodies have no points in the grid."""
    for i, body in enumerate(scene.body):
        if scene.count(body) == 0:
            yield f"body[{i}] '{body.name}': a spacing of {body.spacing:g} m leaves it without points"


def _symmetry_planes_are_kept(scene: "Scene") -> Iterator[str]:
    """Say what moves across a symmetry plane."""
    impact = scene.impact
    for mirror in scene.mirrors:
        face = FACES[2 * mirror.axis + mirror.above]
        for i, body in enumerate(scene.body):
            if body.velocity and body.velocity[mirror.axis]:
                yield f"body[{i}] '{body.name}': its velocity moves it across the symmetry plane {face}: compute what lies behind it, too"
        if scene.projectiles and impact.velocity[mirror.axis]:
            yield (
                f"impact.angle: {math.degrees(impact.angle):g} deg at an azimuth of {math.degrees(impact.azimuth):g} deg moves "
                f"the projectiles across the symmetry plane {face}: compute what lies behind it, too, or turn impact.azimuth"
            )


def _scheme_can_use_cells(scene: "Scene") -> Iterator[str]:
    # It strains by the velocities of slivers of mass, which cells would carry farther: the step falls to nothing.
    if scene.numerics.scheme == "usl" and scene.numerics.volumetric_strain == "cells":
        yield "numerics.volumetric_strain: found 'cells' with scheme 'usl', which goes with 'points' only"


def _velocities_can_be_carried(scene: "Scene") -> Iterator[str]:
    """Say what does not go with velocities that are carried to the nodes."""
    if scene.numerics.node_velocity != "linear":
        return
    if scene.numerics.shape_functions != "trilinear":
        yield f"numerics.node_velocity: found 'linear' with shape_functions '{scene.numerics.shape_functions}', which goes with 'trilinear' only"


def _comes_to_an_end(scene: "Scene") -> Iterator[str]:
    """Say which law has impossible constants, and why a run would never end or write too often."""
    for name, material in scene.materials.items():
        yield from _unlawful(name, material)
    if not scene.steps_about <= MAX_STEPS:
        yield (
            f"end_time: {scene.end_time:g} s takes about {scene.steps_about:.3g} steps with waves of {scene.wave_speed:.3g} "
            f"m/s in cells of {scene.grid.cell:g} m, at most {MAX_STEPS:.0e} are allowed"
        )
    for key in ("snapshots", "history"):
        if (interval := getattr(scene.output, key)) < scene.end_time / MAX_OUTPUTS:
            least = f"at least end_time/{MAX_OUTPUTS:.0e} = {scene.end_time / MAX_OUTPUTS:g} s is needed"
            yield f"output.{key}: found {interval:g} s, {least}"


def _outside(scene: "Scene", key: str, body: Solid) -> Iterator[str]:
    """Say where the space that a body's points fill lies outside the grid.

    A `rounded` body may reach half a spacing beyond, for its points themselves do not. A sphere or a cylinder may be
    cut by a symmetry plane through its centre.
    """
    tolerance = 1e-9 * scene.grid.cell
    lower, upper = body.box
    for face, kind in zip(FACES, scene.boundary.faces, strict=True):
        axis, is_upper = FACES.index(face) // 2, face.endswith("upper")
        if axis == 1 and scene.grid.is_axisymmetric:  # a body is round, its slice is not
            continue
        limit = scene.grid.corner[axis] if is_upper else scene.grid.lower[axis]
        beyond = upper[axis] - limit if is_upper else limit - lower[axis]
        if beyond <= tolerance + (body.spacing / 2 if body.rounded and kind != "symmetry" else 0.0):
            continue
        if kind == "symmetry" and body.is_halved_by(axis, limit, tolerance):
            continue
        yield f"{key}: reaches {in_metres(beyond)} outside the grid's face {face}"


def _unlawful(name: str, material: Material) -> Iterator[str]:
    """Say what the core's own check says of a material's constants."""
    try:
        material.to_core()
    except ValueError as error:
        yield f"materials.{name}: {error}"
