"""What a crater measures: depth, pithead, volume, rim. The definitions are in docs/metrology.md."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .contours import contour_area, largest_contour, polygon_moments
from .ellipse import Ellipse, ellipse_of
from .scene import Mirror
from .surface import Surface, target_field

Array = NDArray[np.float64]
SIGMA = 1 / math.sqrt(
    12
)  # standard deviation of a surface that lies evenly within one point spacing, in spacings
SECTORS = 36  # directions that the rim's crest is looked for in
FIT_RADIUS = 3.0  # of the bottom's paraboloid, spacings
PATCH = 16  # columns of a cell's area, whose heights err together


@dataclass(frozen=True)
class Crater:
    """Depth C_p below z = 0 (m), centre of the bottom (x, y; m) and its standard uncertainty along the heading (m), volume (m^3) below
    z = 0, mean height of the rim's crest (m); of the pithead the contour (n, 2; m) h/2 below z = 0, its ellipse at z = 0 and the
    diameter D_c (m) of the circle of its area: None where no closed edge lies around the bottom."""

    depth: float
    bottom: tuple[float, float]
    bottom_uncertainty: float
    volume: float
    rim_height: float
    diameter: float | None
    contour: Array | None
    pithead: Ellipse | None


def measure_target(
    position: Array, volume: Array, spacing: float, *, mirrors: Sequence[Mirror] = (), level: float = 0.5
) -> Crater | None:
    """The crater in the target's points, as for `target_field`, at a level of the fraction; None if there is none."""
    field = target_field(position, volume, spacing, mirrors=mirrors)
    return None if field is None else measure_crater(field.surface(level))


def measure_crater(surface: Surface, heading: tuple[float, float] = (1.0, 0.0)) -> Crater | None:
    """The crater that holds the deepest point of the surface; None if that is less than half a spacing deep. `heading`: the unit
    vector (x, y) that the projectiles move along, which the bottom's uncertainty is for."""
    floor = floor_of(surface)
    smooth = ndimage.gaussian_filter(floor, 1.4)
    i, j = (int(n) for n in np.unravel_index(np.argmin(smooth), floor.shape))
    depth = _depth(surface, floor, i, j)
    if depth < 0.5 * surface.spacing:
        return None
    bottom, uncertainty = _bottom(surface, floor, i, j, depth, heading)
    bowl = Openings.of(surface).bowl(i, j)
    pithead = bowl.pithead(depth)
    area = None if pithead is None else pithead.area
    centre = pithead.ellipse.centre if pithead else bottom
    return Crater(
        depth,
        bottom,
        uncertainty,
        bowl.volume(depth, area),
        _rim_height(surface, centre),
        None if area is None else 2 * math.sqrt(area / math.pi),
        None if pithead is None else pithead.contour,
        None if pithead is None else pithead.ellipse,
    )


def _crossing(surface: Surface, k: NDArray[np.int64]) -> Array:
    """Height (nx, ny) of one half between the nodes k (nx, ny), which are solid, and those above."""
    i, j = np.indices(k.shape)
    solid, void = surface.fraction[i, j, k], surface.fraction[i, j, np.minimum(k + 1, len(surface.z) - 1)]
    step = surface.z[1] - surface.z[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.nan_to_num((solid - 0.5) / (solid - void), nan=0.0, posinf=0.0, neginf=0.0)
    return np.asarray(surface.z[k] + np.clip(part, 0.0, 1.0) * step)


def floor_of(surface: Surface) -> Array:
    """The crater's floor (nx, ny), m, without pits of a column or two."""
    return _without_pits(_lowest(surface), surface.spacing)


def _lowest(surface: Surface) -> Array:
    """Lowest point (nx, ny) of the surface in each column, m: under an overhang it is the crater's floor."""
    lowest = np.argmax(surface.fraction <= 0.5, axis=2)
    return _crossing(surface, np.maximum(lowest - 1, 0))


def _without_pits(floor: Array, spacing: float) -> Array:
    """The floor with columns more than a spacing below the median of the 5 x 5 around them put to that median."""
    median = ndimage.median_filter(floor, size=5)
    return np.where(floor < median - spacing, median, floor)


def _depth(surface: Surface, floor: Array, i: int, j: int) -> float:
    """Depth of the vertex of a paraboloid fitted to the floor around column (i, j), m; the paraboloid's at the column
    if it has no vertex there."""
    radius = FIT_RADIUS * surface.spacing
    dx, dy = np.meshgrid(surface.x - surface.x[i], surface.y - surface.y[j], indexing="ij")
    near = dx**2 + dy**2 <= radius**2
    u, v = dx[near] / radius, dy[near] / radius
    basis = np.stack([np.ones_like(u), u, v, u**2, u * v, v**2], axis=1)
    a, b, c, d, e, f = np.linalg.lstsq(basis, floor[near], rcond=None)[0]
    hessian = np.array([[2 * d, e], [e, 2 * f]])
    if np.all(np.linalg.eigvalsh(hessian) > 0):
        vertex = -np.linalg.solve(hessian, [b, c])
        if float(vertex @ vertex) <= 1.0:
            return -float(a + 0.5 * (b * vertex[0] + c * vertex[1]))
    return -float(a)


def _bottom(
    surface: Surface, floor: Array, i: int, j: int, depth: float, heading: tuple[float, float]
) -> tuple[tuple[float, float], float]:
    """Centre (x, y) of the bowl's bottom around column (i, j) and its standard uncertainty along the heading, m.

    The centres of gravity of what lies deeper than .95 and than .9 of the depth are extrapolated to the depth, as the
    slices of a tilted bowl shift. The vertex of a fit is no use here: the floor of an oblique crater is flat, with
    grooves a cell apart.
    """
    (x, y, noise), (x1, y1, noise1) = (
        _deep_centre(surface, floor, i, j, part * depth, heading) for part in (0.95, 0.9)
    )
    return (2 * x - x1, 2 * y - y1), math.hypot(2 * noise, noise1)


def _deep_centre(
    surface: Surface, floor: Array, i: int, j: int, depth: float, heading: tuple[float, float]
) -> tuple[float, float, float]:
    """Centre of gravity x, y of the bowl around column (i, j) below `depth`, and its standard uncertainty along the heading, m:
    the height of each patch of a cell is off by SIGMA spacings, independently."""
    excess = -floor - depth
    excess[i, j] = max(excess[i, j], 1e-3 * depth)  # the column itself always counts
    labels, _ = ndimage.label(excess > 0)
    excess = np.where(labels == labels[i, j], excess, 0.0)
    x = float(np.average(surface.x, weights=excess.sum(axis=1)))
    y = float(np.average(surface.y, weights=excess.sum(axis=0)))
    along = heading[0] * (surface.x[:, None] - x) + heading[1] * (surface.y[None, :] - y)
    arm = float((along[excess > 0] ** 2).sum())
    return x, y, SIGMA * surface.spacing * math.sqrt(PATCH * arm) / float(excess.sum())


@dataclass(frozen=True)
class Openings:
    """What is open below z = 0: the solid fraction there (nx, ny, nz'), and a number for each hollow (0: solid)."""

    surface: Surface
    fraction: Array
    hollow: NDArray[np.int32]

    @classmethod
    def of(cls, surface: Surface) -> "Openings":
        """Of a surface; slices are its nodes below z = 0."""
        return cls._labelled(surface, surface.fraction[:, :, surface.z < -0.25 * surface.spacing])

    def within(self, columns: NDArray[np.bool_]) -> "Openings":
        """What of it is open in some columns (nx, ny); the others count as solid."""
        return self._labelled(self.surface, np.where(columns[:, :, None], self.fraction, 1.0))

    @classmethod
    def _labelled(cls, surface: Surface, fraction: Array) -> "Openings":
        return cls(surface, fraction, ndimage.label(fraction <= 0.5)[0])

    def bowl(self, i: int, j: int) -> "Bowl":
        """The hollow that is open in column (i, j)."""
        column = self.hollow[i, j][self.hollow[i, j] > 0]
        return Bowl(self, int(column[0]) if len(column) else -1)


@dataclass(frozen=True)
class Pithead:
    """Where a bowl meets z = 0: contour (n, 2) m, of the slice h/2 below; area (m^2) and ellipse at z = 0."""

    contour: Array
    area: float
    ellipse: Ellipse


def _at_zero(values: Array) -> Array:
    """What values (n, m) in slices 1, 2 ... steps below z = 0 are there, by straight lines."""
    if len(values) == 1:
        return np.asarray(values[0])
    depth = np.arange(1, len(values) + 1)
    return np.asarray(np.polynomial.polynomial.polyfit(depth, values, 1)[0])


@dataclass(frozen=True)
class Bowl:
    """One hollow of a surface: all others count as filled."""

    of: Openings
    number: int

    @property
    def slices(self) -> int:
        """How many there are, the last one half a point spacing below z = 0."""
        return int(self.of.fraction.shape[2])

    def slice(self, k: int) -> Array:
        """Solid fraction (nx, ny) of the k-th slice from below."""
        near = self.of.hollow[:, :, max(k - 1, 0) : k + 2] == self.number
        reached = ndimage.binary_dilation(near.any(axis=2), np.ones((3, 3)))
        here = self.of.hollow[:, :, k]
        return np.where(reached & ((here == self.number) | (here == 0)), self.of.fraction[:, :, k], 1.0)

    def pithead(self, depth: float) -> "Pithead | None":
        """Of a bowl `depth` (m) deep; None if it is open at the edge.

        At z = 0 itself an untouched surface is on the level too. So area and centre are taken in the slices from h/2 down
        to 5h/2, or half the depth, and carried on to z = 0 along straight lines; a paraboloid's are straight. The axes' ratio
        and direction are the mean of these slices: parallel sections of an ellipsoid are alike.
        """
        surface, top = self.of.surface, self.slice(self.slices - 1)
        edges = np.concatenate([top[0], top[-1], top[:, 0], top[:, -1]])
        contour = largest_contour(top)
        if np.any(edges <= 0.5) or contour is None:
            return None
        steps = min(max(1, min(5, int(depth / surface.spacing))), self.slices)
        lines = [contour, *(largest_contour(self.slice(self.slices - 1 - n)) for n in range(1, steps))]
        found = [polygon_moments(line) for line in lines if line is not None]
        area = float(_at_zero(np.array([m.area for m in found])))
        centre = _at_zero(np.array([m.centre for m in found]))
        shape = np.mean([m.covariance / m.area for m in found], axis=0)
        # An ellipse's covariance has the determinant (area / 4 pi)^2; a region that is none keeps its area.
        shape *= area / (4 * math.pi * math.sqrt(np.linalg.det(shape)))
        step, corner = surface.spacing / 2, np.array([surface.x[0], surface.y[0]])
        ellipse = ellipse_of(corner + centre * step, shape * step**2)
        return Pithead(corner + contour * step, area * step**2, ellipse)

    def volume(self, depth: float, area: float | None) -> float:
        """Integral of the slices' areas from z = 0 (the pithead's `area`, or that of the first slice) to -depth, m^3."""
        heights = self.of.surface.z[: self.slices]
        cell = (self.of.surface.spacing / 2) ** 2
        kept = [k for k in range(self.slices) if heights[k] > -depth]
        areas = [contour_area(self.slice(k)) * cell for k in kept]
        top = contour_area(self.slice(self.slices - 1)) * cell if area is None else area
        z = [-depth, *(float(heights[k]) for k in kept), 0.0]
        return float(np.trapezoid([0.0, *areas, top], z))


def _rim_height(surface: Surface, centre: tuple[float, float]) -> float:
    """Mean over directions of the highest point of the target, m; 0 at least."""
    top = len(surface.z) - 1 - np.argmax(surface.fraction[:, :, ::-1] > 0.5, axis=2)
    height = _crossing(surface, top)
    dx, dy = np.meshgrid(surface.x - centre[0], surface.y - centre[1], indexing="ij")
    sector = np.floor((np.arctan2(dy, dx) / (2 * math.pi) % 1.0) * SECTORS).astype(int) % SECTORS
    crest = ndimage.maximum(height, sector, np.unique(sector))
    return max(0.0, float(np.mean(crest)))
