"""A plane through the points as pixels: where material is, whose it is, and what a cell's width resolves of its fields.

Tents spread each point over the pixels. Where material is, and whose, is told by tents as wide as a point spacing, as
the crater is measured (metrology/surface.py). A field is a mean by mass with tents as wide as a cell: what points of
a cell have beyond each other, the grid does not see, and the picture does not show.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

from ..base.geometry import Setup
from ..metrology.section import section_area
from ..metrology.surface import volume_fraction
from .quantities import Fields, Quantity

Array = NDArray[np.float64]
Limits = tuple[tuple[float, float], tuple[float, float]]  # um, of x and of z
HALF = 0.5 - 1e-6  # of the plane is filled at a surface; a plane one has just that
FINE, FINEST, MOST = 600, 8, 1600  # pixels along the longer side; to a spacing at most; along a side at most


def slice_axis(setup: Setup) -> int:
    """Return the axis across the picture's slice: y, or x if the projectiles move more along y than along x."""
    x, y = setup.heading
    return 1 if abs(x) >= abs(y) else 0


def slice_plane(setup: Setup) -> float:
    """Return the coordinate of the picture's slice on that axis, m.

    It is that of a symmetry plane, or else of the first projectile.
    """
    axis = slice_axis(setup)
    for mirror in setup.mirrors:
        if mirror.axis == axis:
            return mirror.at
    return setup.centre[axis]


@dataclass(frozen=True)
class Cut:
    """The points within a cell of a plane across y or x, as a picture shows them.

    `x` is the other of the two axes, um; what lies behind a symmetry plane or the axis is there, too. All arrays are
    (n,): `width` of a point in um; `area` that it fills of the plane, um^2; `mass` in the plane, to a factor;
    `touches`, whether it comes within a width of the plane. `values` holds quantities by their names, in their units;
    one that the snapshot lacks is not among them.
    """

    x: Array
    z: Array
    width: Array
    area: Array
    mass: Array
    touches: NDArray[np.bool_]
    body: NDArray[Any]
    is_projectile: NDArray[np.bool_]
    values: dict[str, Array]
    time: float  # ns
    spacing: float  # um
    cell: float  # um

    @classmethod
    def of(cls, snapshot: Fields, setup: Setup, quantities: Sequence[Quantity] = ()) -> "Cut":
        """Return the points near the plane of the picture, without those that have no place, volume or mass."""
        across, reach = slice_axis(setup), setup.resolved
        position, volume, mass = snapshot["position"], snapshot["volume"], snapshot["mass"]
        known = np.isfinite(position).all(axis=1) & (volume > 0) & (mass > 0)
        if setup.is_axisymmetric:
            there = np.flatnonzero(known & (position[:, 0] > 0))
            place, volume = position[there], volume[there]
            area = section_area(place, volume)
            width, mass = np.sqrt(area), mass[there] * (area / volume)
            touches = np.ones(len(there), dtype=bool)
            fold = [0.0]  # a ring cuts the plane on both sides of the axis
        else:
            off = position[:, across] - slice_plane(setup)
            there = np.flatnonzero(known & (np.abs(off) < reach))
            place, volume, distance = position[there], volume[there], np.abs(off[there])
            one_sided = (off[known] >= 0).all() or (off[known] <= 0).all()
            share = (
                (1 - distance / reach) / reach * (2 if one_sided else 1)
            )  # 1/m, of a tent across the plane
            width, area, mass = np.cbrt(volume), volume * share, mass[there] * share
            touches = distance < width
            fold = [mirror.at for mirror in setup.mirrors if mirror.axis == 1 - across]
        body = snapshot["body"][there]
        values = {one.name: one.values(snapshot, there) for one in quantities if one.field in snapshot}
        cut = cls(
            place[:, 1 - across] * 1e6,
            place[:, 2] * 1e6,
            width * 1e6,
            area * 1e12,
            mass,
            touches,
            body,
            np.isin(body, setup.projectiles),
            values,
            float(snapshot["time"][0]) * 1e9,
            setup.spacing * 1e6,
            reach * 1e6,
        )
        for at in fold:
            cut = cut._with_images(at * 1e6)
        return cut

    def _with_images(self, at: float) -> "Cut":
        """Return the points followed by their images behind the plane where x is `at` (um)."""
        twice = {
            name: np.tile(array, 2) for name, array in vars(self).items() if isinstance(array, np.ndarray)
        }
        values = {name: np.tile(of, 2) for name, of in self.values.items()}
        twice |= {"x": np.concatenate([self.x, 2 * at - self.x])}
        return Cut(**(vars(self) | twice | {"values": values}))

    @property
    def limits(self) -> Limits:
        """Return the limits of axes that show the whole target, and above it no more air than a third of the width, um."""
        if len(self.x) == 0:
            return (-1.0, 1.0), (-1.0, 1.0)
        half = self.width / 2
        left, right = float((self.x - half).min()), float((self.x + half).max())
        low, top = float((self.z - half).min()), float(self.z[~self.is_projectile].max(initial=0.0))
        width = max(right - left, 1e-3)
        margin = 0.01 * width
        room = min(top + 0.1 * width, 0.33 * width)
        return (left - margin, right + margin), (low - margin, max(0.15 * width, room))


@dataclass(frozen=True)
class Raster:
    """A cut as pixels `pixel` um wide with centres at x (nx,) and z (nz,), um. Its arrays are (nx, nz)."""

    cut: Cut
    x: Array
    z: Array
    pixel: float
    first: NDArray[np.int64]
    last: NDArray[np.int64]

    @classmethod
    def of(cls, cut: Cut, limits: Limits) -> "Raster":
        """Return the pixels within the limits: some 600 along the longer side, and no fewer than one to a spacing."""
        lower, upper = np.array(limits, dtype=np.float64).T
        longest = float((upper - lower).max())
        finer = int(np.clip(np.ceil(FINE * cut.spacing / longest), 1, FINEST))
        pixel = max(cut.spacing / finer, longest / MOST)
        first, last = np.floor(lower / pixel).astype(np.int64), np.ceil(upper / pixel).astype(np.int64)
        x, z = (np.arange(a, b + 1) * pixel for a, b in zip(first, last, strict=True))
        return cls(cut, x, z, pixel, first, last)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Return the left, right, lower and upper edge of the pixels, um."""
        half = self.pixel / 2
        return (
            float(self.x[0]) - half,
            float(self.x[-1]) + half,
            float(self.z[0]) - half,
            float(self.z[-1]) + half,
        )

    def _nodes(self, width: float) -> int:
        """Return how many pixels a tent of a width (um) takes."""
        return max(1, round(width / self.pixel))

    def _spread(self, amount: Array, width: float) -> Array:
        """Return an amount (n,) of the points spread by tents of a width (um), in amounts to such a square."""
        nodes = self._nodes(width)
        places = np.column_stack([self.cut.x, self.cut.z]) / (nodes * self.pixel)
        return volume_fraction(places, np.asarray(amount, np.float64), self.first, self.last, nodes)

    @cached_property
    def filling(self) -> Array:
        """Return the share of the plane that the points fill, by tents of a point spacing."""
        return self.filled(self.cut.spacing)

    def filled(self, width: float) -> Array:
        """Return the share of the plane that the points fill, by tents of a width (um)."""
        return self._spread(self.cut.area / (self._nodes(width) * self.pixel) ** 2, width)

    @cached_property
    def material(self) -> NDArray[np.bool_]:
        """Return where material is: where half of the plane is filled, or a point in the air lies.

        Half of what is as wide as a point spacing, or as a cell: the points of a stretched wall lie that far apart. A
        gap narrower than a spacing is none. One narrower than a cell is none within material. What is wider is air.
        """
        filled = (self.filling > HALF) | (self.filled(self.cut.cell) > HALF)
        solid = _closed(filled | self._loose, self._nodes(self.cut.spacing) / 2)
        within = ndimage.binary_fill_holes(solid) & ~solid
        return np.asarray(solid | (_closed(solid, self._nodes(self.cut.cell) / 2) & within))

    @cached_property
    def _loose(self) -> NDArray[np.bool_]:
        """Return the discs, as wide as they are, of points in the air: those that alone fill too little around them."""
        cut, painted = self.cut, np.zeros(self.filling.shape, dtype=bool)
        pixel = np.round(np.column_stack([cut.x, cut.z]) / self.pixel).astype(np.int64) - self.first
        seen = cut.touches & ((pixel >= 0) & (pixel < painted.shape)).all(axis=1)
        pixel, radius = pixel[seen], np.round(cut.width[seen] / 2 / self.pixel)
        around = tuple(pixel.T)
        alone = (self.filling[around] <= HALF) | (self.filled(self.cut.cell)[around] <= HALF / 2)
        pixel, radius = pixel[alone], radius[alone]
        for one in np.unique(radius):
            centres = np.ones(painted.shape, dtype=bool)
            centres[tuple(pixel[radius == one].T)] = False
            painted |= ndimage.distance_transform_edt(centres) <= one
        return painted

    def share(self, of: NDArray[np.bool_]) -> Array:
        """Return the share of what is around each pixel that is of some points (n,); of the nearest in the air."""
        mine, all_of_it = (
            self._spread(self.cut.area * part, self.cut.spacing) for part in (of, np.ones(len(of)))
        )
        return mean_of(mine, all_of_it)

    @cached_property
    def projectile(self) -> Array:
        """Return the share of the projectile in the material around each pixel; 0 in the air."""
        return np.where(self.material, self.share(self.cut.is_projectile), 0.0)

    @cached_property
    def edges(self) -> tuple[list[Array], list[Array]]:
        """Return the lines (n, 2), um, in which the material and the projectile end."""
        corner, mine = np.array([self.x[0], self.z[0]]), self.projectile > 0.5
        material, projectile = (
            [corner + line * self.pixel for line in edges_of(inside)] for inside in (self.material, mine)
        )
        return material, projectile

    def field(self, values: Array) -> np.ma.MaskedArray[Any, Any]:
        """Return the mean by mass of values (n,) within a cell's width, masked in the air.

        It lies between the values of the points of which it is made. Those that are no number do not count; where no
        point counts, the nearest pixel's mean is taken.
        """
        is_number = np.isfinite(values)
        mass = np.where(is_number, self.cut.mass, 0.0)
        if not mass.any():
            return np.ma.masked_array(np.zeros(self.material.shape), True)
        mass = mass / mass.max()
        amount, weight = (
            self._spread(mass * what, self.cut.cell)
            for what in (np.where(is_number, values, 0.0), np.ones(len(mass)))
        )
        return np.ma.masked_array(mean_of(amount, weight), ~self.material)


def edges_of(inside: NDArray[np.bool_]) -> list[Array]:
    """Return the lines (n, 2), pixels, around what is inside (nx, ny), smoothed over a pixel."""
    if min(inside.shape) < 2:
        return []
    soft = ndimage.gaussian_filter(inside.astype(np.float32), 1.0)
    return list(find_contours(soft, 0.5))  # type: ignore[no-untyped-call]


def mean_of(amount: Array, weight: Array) -> Array:
    """Return amounts over weights; where there is no weight, what is nearest."""
    some = weight > 1e-12 * weight.max(initial=0.0)
    if not some.any():
        return np.zeros_like(weight)
    mean = np.divide(amount, weight, out=np.zeros_like(weight), where=some)
    if some.all():
        return mean
    nearest = ndimage.distance_transform_edt(~some, return_distances=False, return_indices=True)
    return np.asarray(mean[tuple(nearest)])


def _closed(solid: NDArray[np.bool_], radius: float) -> NDArray[np.bool_]:
    """Return what is solid with all into which a disc of a radius (pixels) does not get. Around the array is air."""
    if not solid.any():
        return solid
    rim = int(radius) + 2
    padded = np.pad(solid, rim)
    around = ndimage.distance_transform_edt(~padded) <= radius
    closed = ndimage.distance_transform_edt(around) > radius
    return np.asarray(solid | closed[rim:-rim, rim:-rim])
