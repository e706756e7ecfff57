"""Axisymmetric scenes: what can be one, and the slice that is computed of it.

x is the radius r and x = y = 0 the axis. The grid is a slice one cell thick along y, which begins at the axis. What a
scene says of y, and of the other side of the axis, is not taken.
"""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .scene import Scene


def obstacles(scene: "Scene") -> Iterator[str]:
    """Say why a scene cannot be axisymmetric."""
    impact, so = scene.impact, "with grid.geometry 'axisymmetric'"
    if impact.angle:
        yield f"impact.angle: found {math.degrees(impact.angle):g} deg, {so} only 0 deg, a normal impact, is allowed"
    if impact.azimuth:
        yield f"impact.azimuth: found {math.degrees(impact.azimuth):g} deg, {so} only 0 deg is allowed"
    if scene.numerics.mass_cutoff:
        yield f"numerics.mass_cutoff: found {scene.numerics.mass_cutoff:g}, {so} only 0 is allowed, for the mass of a cell is not one number"
    if not scene.grid.lower[0] <= 0 < scene.grid.upper[0]:
        yield f"grid.lower, grid.upper: found x from {scene.grid.lower[0]:g} m to {scene.grid.upper[0]:g} m, {so} the axis x = 0 must lie there"
    for i, body in enumerate(scene.body):
        key = f"body[{i}] '{body.name}'"
        if body.velocity and any(body.velocity[:2]):
            yield f"{key}: its velocity has a part along x or y, {so} only one along z is allowed"
        try:
            body.turned()
        except ValueError as error:
            yield f"{key}: {error}"


def slice_of(scene: "Scene") -> "Scene":
    """Return an axisymmetric scene as it is computed.

    Its grid is the slice, with symmetry planes at the axis and at both sides along y. Its bodies are round.
    """
    grid = scene.grid
    (_, _, low), (radius, _, high), half = grid.lower, grid.upper, grid.cell / 2
    planes = dict.fromkeys(("x_lower", "y_lower", "y_upper"), "symmetry")
    changed = {
        "grid": grid.model_copy(update={"lower": (0.0, -half, low), "upper": (radius, half, high)}),
        "boundary": scene.boundary.model_copy(update=planes),
        "body": tuple(body.turned() for body in scene.body),
    }
    return scene.model_copy(update=changed)
