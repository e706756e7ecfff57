"""The depth, pithead, volume and rim of a crater. The definitions are in docs/metrology.md."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..base.geometry import Setup
from .contours import contour_area, largest_contour, open_at_edge, polygon_moments
from .ellipse import Ellipse, ellipse_of, with_area
from .rim import Rim, crest_height, mean_crest, rim_of
from .surface import SIGMA, Surface, target_filling

Array = NDArray[np.float64]
FIT_RADIUS = 3.0  # spacings: radius of what the bottom's paraboloid is fitted to
PATCH = 16  # columns in the area of a cell: their heights err together


@dataclass(frozen=True)
class Crater:
    """A crater below z = 0, SI.

    `depth` is C_p. `bottom` is the centre (x, y) of the bottom, `bottom_uncertainty` its standard uncertainty along
    the heading.

    The rest is None unless a closed edge lies around the bottom: `volume` below z = 0; `rim_height`, the mean height
    of the crest; `diameter` D_c, of the circle of the pithead's area; `contour` (n, 2) of the pithead h/2 below z =
    0; `pithead`, its ellipse at z = 0. `rim` is None, too, where there is no crest.
    """

    depth: float
    bottom: tuple[float, float]
    bottom_uncertainty: float
    volume: float | None
    rim_height: float | None
    diameter: float | None
    contour: Array | None
    pithead: Ellipse | None
    rim: Rim | None = None

    @property
    def rim_diameter(self) -> float | None:
        """Return the rim's diameter from crest to crest, m; None without a rim."""
        return self.rim.diameter if self.rim else None


def measure_target(position: Array, volume: Array, setup: Setup, *, level: float = 0.5) -> Crater | None:
    """Return the crater in the target's points at a `level` of the fraction; None if there is none.

    `position` (n, 3) m, `volume` (n,) m^3 and `setup` are as `target_filling` takes them.
    """
    filling = target_filling(position, volume, setup)
    return None if filling is None else measure_crater(filling.surface(level))


def measure_crater(surface: Surface, heading: tuple[float, float] = (1.0, 0.0)) -> Crater | None:
    """Return the crater that holds the deepest point of the surface.

    None if that is less than half a spacing deep, and if there is a hole, which has no depth. `heading` is the unit
    vector (x, y) along which the projectiles move; the bottom's uncertainty is along it.
    """
    if surface.holes.any():
        return None
    floor = floor_of(surface)
    smooth = ndimage.gaussian_filter(floor, 1.4)
    i, j = (int(n) for n in np.unravel_index(np.argmin(smooth), floor.shape))
    depth = _depth(surface, floor, i, j)
    if depth < 0.5 * surface.spacing:
        return None
    bottom, uncertainty = _bottom(surface, floor, i, j, depth, heading)
    bowl = Openings.of(surface).bowl(i, j)
    pithead = bowl.pithead(depth)
    if pithead is None:
        return Crater(depth, bottom, uncertainty, None, None, None, None, None)
    crest, centre = crest_height(surface), pithead.ellipse.centre
    return Crater(
        depth,
        bottom,
        uncertainty,
        bowl.volume(depth, pithead.area),
        mean_crest(surface, crest, centre),
        2 * math.sqrt(pithead.area / math.pi),
        pithead.contour,
        pithead.ellipse,
        rim_of(surface, crest, centre),
    )


def floor_of(surface: Surface) -> Array:
    """Return the height (nx, ny), m, of the crater's floor, without pits of a column or two."""
    return _without_pits(_lowest(surface), surface.spacing)


def _lowest(surface: Surface) -> Array:
    """Return the height (nx, ny), m, of the lowest point of the surface in each column.

    Under an overhang that is the crater's floor. In a hole it is about the height of the wall's back.
    """
    above = surface.within.start if surface.holes.any() else 0  # below the wall nothing is a crater
    lowest = above + np.argmax(surface.fraction[:, :, above:] <= 0.5, axis=2)
    return surface.crossing(np.maximum(lowest - 1, 0))


def _without_pits(floor: Array, spacing: float) -> Array:
    """Return the floor (nx, ny), m, with pits filled.

    A column more than a spacing below the median of the 5 x 5 columns around it is put to that median.
    """
    median = ndimage.median_filter(floor, size=5)
    return np.where(floor < median - spacing, median, floor)


def _depth(surface: Surface, floor: Array, i: int, j: int) -> float:
    """Return the depth, m, of the floor around column (i, j), by a fit."""
    dx, dy = np.meshgrid(surface.x - surface.x[i], surface.y - surface.y[j], indexing="ij")
    return vertex_depth(dx, dy, floor, FIT_RADIUS * surface.spacing)


def vertex_depth(dx: Array, dy: Array, floor: Array, radius: float) -> float:
    """Return the depth, m, of the vertex of a paraboloid fitted to a floor within a radius (m) of dx = dy = 0.

    dx, dy and the floor's height are (nx, ny), m. If the paraboloid has no vertex there, its depth in the middle is
    returned.
    """
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
    """Return the centre (x, y; m) of the bottom around column (i, j), and its standard uncertainty along the heading, m.

    The centre of gravity of what lies deeper than .95 of the depth, and of what lies deeper than .9, are extrapolated
    to the depth, as the slices of a tilted bowl shift. The vertex of a fit would not do: the floor of an oblique
    crater is flat, with grooves a cell apart.
    """
    (x, y, noise), (x1, y1, noise1) = (
        _deep_centre(surface, floor, i, j, part * depth, heading) for part in (0.95, 0.9)
    )
    return (2 * x - x1, 2 * y - y1), math.hypot(2 * noise, noise1)


def _deep_centre(
    surface: Surface, floor: Array, i: int, j: int, depth: float, heading: tuple[float, float]
) -> tuple[float, float, float]:
    """Return the centre of gravity x, y of what is deeper than `depth` around column (i, j), and its uncertainty, m.

    The standard uncertainty is along the heading. It takes the height of each patch of a cell to be off by SIGMA
    spacings, independently of the others.
    """
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
    """The space below z = 0 that is open.

    `fraction` (nx, ny, nz') is the solid fraction there. `hollow` has the number of the hollow at each node, 0 for
    solid.
    """

    surface: Surface
    fraction: Array
    hollow: NDArray[np.int32]

    @classmethod
    def of(cls, surface: Surface) -> "Openings":
        """Return the openings of a surface. Their slices are the surface's nodes below z = 0."""
        return cls._labelled(surface, surface.fraction[:, :, surface.z < -0.25 * surface.spacing])

    def within(self, columns: NDArray[np.bool_]) -> "Openings":
        """Return what is open in some columns (nx, ny). The others count as solid."""
        return self._labelled(self.surface, np.where(columns[:, :, None], self.fraction, 1.0))

    @classmethod
    def _labelled(cls, surface: Surface, fraction: Array) -> "Openings":
        """Return the openings of a fraction, with a number for each hollow."""
        return cls(surface, fraction, ndimage.label(fraction <= 0.5)[0])

    def bowl(self, i: int, j: int) -> "Bowl":
        """Return the hollow that is open in column (i, j)."""
        column = self.hollow[i, j][self.hollow[i, j] > 0]
        return Bowl(self, int(column[0]) if len(column) else -1)


@dataclass(frozen=True)
class Pithead:
    """The opening of a bowl at z = 0: its area (m^2) and its ellipse.

    `contour` (n, 2), m, is that of the slice h/2 below.
    """

    contour: Array
    area: float
    ellipse: Ellipse


def at_zero(values: Array) -> Array:
    """Return what values (n, m) would be at z = 0, by straight lines.

    They are those of the slices 1, 2, ... n node distances below z = 0.
    """
    if len(values) == 1:
        return np.asarray(values[0])
    depth = np.arange(1, len(values) + 1)
    return np.asarray(np.polynomial.polynomial.polyfit(depth, values, 1)[0])


@dataclass(frozen=True)
class Bowl:
    """One hollow of a surface. All others count as filled."""

    of: Openings
    number: int

    @property
    def slices(self) -> int:
        """Return how many slices there are. The last one is half a point spacing below z = 0."""
        return int(self.of.fraction.shape[2])

    def slice(self, k: int) -> Array:
        """Return the solid fraction (nx, ny) of the k-th slice from below."""
        near = self.of.hollow[:, :, max(k - 1, 0) : k + 2] == self.number
        reached = ndimage.binary_dilation(near.any(axis=2), np.ones((3, 3)))
        here = self.of.hollow[:, :, k]
        return np.where(reached & ((here == self.number) | (here == 0)), self.of.fraction[:, :, k], 1.0)

    def pithead(self, depth: float) -> "Pithead | None":
        """Return the pithead of a bowl `depth` (m) deep; None if it is open at the edge.

        At z = 0 itself the fraction of an untouched surface is one half, too, so no contour can be taken there. Area
        and centre are taken in the slices from h/2 down to 5h/2, or to half the depth, and carried on to z = 0 along
        straight lines; those of a paraboloid are straight. The axes' ratio and direction are the mean of these
        slices: parallel sections of an ellipsoid are alike.
        """
        surface, top = self.of.surface, self.slice(self.slices - 1)
        contour = largest_contour(top)
        if open_at_edge(top) or contour is None:
            return None
        count = min(max(1, min(5, int(depth / surface.spacing))), self.slices)
        lines = [contour, *(largest_contour(self.slice(self.slices - 1 - n)) for n in range(1, count))]
        found = [polygon_moments(line) for line in lines if line is not None]
        area = float(at_zero(np.array([m.area for m in found])))
        if area <= 0:  # a pit that widens below z = 0 so much that it has no opening
            return None
        centre = at_zero(np.array([m.centre for m in found]))
        shape = np.mean([m.covariance / m.area for m in found], axis=0)
        shape = with_area(shape, area)
        apart, corner = surface.node_distance, np.array([surface.x[0], surface.y[0]])
        ellipse = ellipse_of(corner + centre * apart, shape * apart**2)
        return Pithead(corner + contour * apart, area * apart**2, ellipse)

    def volume(self, depth: float, area: float) -> float:
        """Return the volume below z = 0, m^3: the integral of the slices' areas down to -depth (m).

        `area` (m^2) is the pithead's, at z = 0.
        """
        heights = self.of.surface.z[: self.slices]
        square = self.of.surface.node_distance**2
        kept = [k for k in range(self.slices) if heights[k] > -depth]
        areas = [contour_area(self.slice(k)) * square for k in kept]
        z = [-depth, *(float(heights[k]) for k in kept), 0.0]
        return float(np.trapezoid([0.0, *areas, area], z))
