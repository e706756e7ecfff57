"""The measures of an axisymmetric crater or hole, from the section of its surface. They are defined as all others."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .crater import FIT_RADIUS, Bowl, Crater, Openings, at_zero, floor_of, vertex_depth
from .ellipse import Ellipse
from .hole import Hole
from .rim import Rim, crest_along, crest_height
from .surface import Surface

Array = NDArray[np.float64]
Void = tuple[float, float]  # inner and outer radius, m, of what is open in a slice
SIDES = 180  # of the polygon that stands for a round contour


def measure_round_crater(surface: Surface) -> Crater | None:
    """Return the crater of an axisymmetric surface; None if it is less than half a spacing deep, or if there is a hole."""
    if surface.holes.any():
        return None
    floor = floor_of(surface)
    axis = len(floor) // 2
    i = axis + int(np.argmin(ndimage.gaussian_filter(floor, 1.4)[axis:, 0]))
    depth = _depth(surface, floor[:, 0], i)
    if depth < 0.5 * surface.spacing:
        return None
    bowl = Openings.of(surface).bowl(i, 0)
    found = [_voids(surface, bowl.slice(k)) for k in range(bowl.slices)]
    top = found[-1]
    without_edge = Crater(depth, (0.0, 0.0), 0.0, None, None, None, None, None)
    if not top or math.isinf(_outer(top)):
        return without_edge
    count = min(max(1, min(5, int(depth / surface.spacing))), bowl.slices)
    area = float(at_zero(np.array([_outer(voids) ** 2 for voids in found[::-1][:count] if voids]))) * math.pi
    if area <= 0:
        return without_edge
    diameter, crest = 2 * math.sqrt(area / math.pi), crest_height(surface)
    angle = np.linspace(0, 2 * math.pi, SIDES + 1)
    return Crater(
        depth,
        (0.0, 0.0),
        0.0,
        _volume(bowl, found, depth, area),
        float(crest[surface.x >= 0].max()),
        diameter,
        _outer(top) * np.stack([np.cos(angle), np.sin(angle)], axis=1),
        Ellipse((0.0, 0.0), diameter, diameter, 0.0),
        _rim(surface, ndimage.median_filter(crest, size=3)),
    )


def measure_round_hole(surface: Surface) -> Hole | None:
    """Return the holes of an axisymmetric wall whose back is free; None if there are none.

    A hole around a plug is as wide as the gap.
    """
    numbers = surface.holes
    if surface.is_backed or not numbers.any():
        return None
    each = [int(number) for number in np.unique(numbers[surface.x >= 0]) if number]
    openings = Openings(surface, surface.fraction[:, :, surface.within], numbers)
    necks = [neck for number in each if (neck := _neck(Bowl(openings, number)))]
    if not necks:
        return Hole(len(each), None, None, None)
    (inner, outer), z = max(necks, key=lambda neck: _width(neck[0]))
    place = (0.5 * (inner + outer) if inner else 0.0, 0.0, z)
    return Hole(len(each), _width((inner, outer)), 2 * math.sqrt(outer**2 - inner**2), place)


def _depth(surface: Surface, floor: Array, i: int) -> float:
    """Return the depth, m, of the floor (nx,) around node i, by the fit that craters of three dimensions have.

    The floor is turned about the axis for it.
    """
    reach = int(FIT_RADIUS * surface.spacing / surface.node_distance)
    step = np.arange(-reach, reach + 1) * surface.node_distance
    dx, dy = np.meshgrid(step, step, indexing="ij")
    radius = np.hypot(surface.x[i] + dx, dy)
    return vertex_depth(dx, dy, np.interp(radius, surface.x, floor), FIT_RADIUS * surface.spacing)


def _voids(surface: Surface, fraction: Array) -> list[Void]:
    """Return what is open in a slice (nx, 1), from the axis outwards.

    The last outer radius is infinite if the slice is open at the edge.
    """
    r, solid = surface.x[surface.x >= 0], fraction[surface.x >= 0, 0] - 0.5
    ends = [] if solid[0] > 0 else [0.0]
    for k in np.flatnonzero((solid[:-1] > 0) != (solid[1:] > 0)):
        ends.append(float(r[k] + (r[k + 1] - r[k]) * solid[k] / (solid[k] - solid[k + 1])))
    if solid[-1] <= 0:
        ends.append(math.inf)
    return list(zip(ends[::2], ends[1::2], strict=True))


def _outer(voids: list[Void]) -> float:
    """Return the outer radius of what is open in a slice, m."""
    return voids[-1][1]


def _volume(bowl: Bowl, found: list[list[Void]], depth: float, area: float) -> float:
    """Return the volume below z = 0, m^3: the integral of the slices' areas down to -depth (m).

    `area` (m^2) is the pithead's, at z = 0.
    """
    heights = bowl.of.surface.z[: bowl.slices]
    kept = [k for k in range(bowl.slices) if heights[k] > -depth]
    areas = [math.pi * sum(outer**2 - inner**2 for inner, outer in found[k]) for k in kept]
    z = [-depth, *(float(heights[k]) for k in kept), 0.0]
    return float(np.trapezoid([0.0, *areas, area], z))


def _rim(surface: Surface, height: Array) -> Rim | None:
    """Return the rim of a crest (nx, 1), m; None if there is none. One direction stands for all, so no mean helps."""
    crest = crest_along(surface, height, (0.0, 0.0), 0.0)
    return None if crest is None else Rim(2 * crest[0], 2 * crest[1] / math.sqrt(3))


def _neck(bowl: Bowl) -> tuple[Void, float] | None:
    """Return the narrowest section of a hole, and its height, m; None if a section is open at the edge or closed."""
    surface, sections = bowl.of.surface, []
    for k in range(bowl.slices):
        voids = _voids(surface, bowl.slice(k))
        if not voids or math.isinf(_outer(voids)):
            return None
        widest = max(voids, key=_width)
        sections.append((widest, float(surface.z[surface.within][k])))
    return min(sections, key=lambda section: _width(section[0]))


def _width(void: Void) -> float:
    """Return the least width of what is open between two radii, m."""
    inner, outer = void
    return outer - inner if inner else 2 * outer
