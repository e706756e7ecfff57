"""What a snapshot fills of space behind the plane of the picture, and the mean of a quantity in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..base.geometry import Setup
from ..metrology.surface import volume_fraction, with_images
from .quantities import Fields, Quantity
from .raster import Array, Cut, Raster, mean_of, slice_axis, slice_plane

MOST_NODES = 2_000_000


@dataclass(frozen=True)
class Solid:
    """What the points fill on one side of the picture's plane, at nodes x, y and z, um.

    Arrays are (nx, ny, nz): the share that is filled, one half at the surface; the mean of a quantity by mass within
    a cell's width; the share of the projectile in what is filled.
    """

    nodes: tuple[Array, Array, Array]
    filling: Array
    values: Array
    projectile: Array
    time: float  # ns

    @classmethod
    def of(cls, snapshot: Fields, setup: Setup, quantity: Quantity) -> "Solid":
        """Return what a snapshot fills. Raises PockmarkError if it lacks the quantity's field."""
        quantity.values(snapshot, slice(0))
        of = _of_rings if setup.is_axisymmetric else _of_points
        return of(snapshot, setup, quantity)


def _of_rings(snapshot: Fields, setup: Setup, quantity: Quantity) -> Solid:
    """Return what rings fill: their section, turned around the axis by half a turn."""
    cut = Cut.of(snapshot, setup, [quantity])
    raster = Raster.of(cut, cut.limits)
    (left, right), (low, high) = cut.limits
    x, y, z = nodes = _nodes((left, 0.0, low), (right, right, high), cut.cell)
    radius, height = np.broadcast_arrays(np.hypot(x[:, None], y)[:, :, None], z)
    at = [(radius - raster.x[0]) / raster.pixel, (height - raster.z[0]) / raster.pixel]

    def turned(section: Array) -> Array:
        return np.asarray(ndimage.map_coordinates(section, at, order=1, mode="nearest"))

    filling = np.where(radius > right, 0.0, turned(raster.filled(cut.cell)))
    field = np.asarray(raster.field(cut.values[quantity.name]).data)
    return Solid(nodes, filling, turned(field), turned(raster.share(cut.is_projectile)), cut.time)


def _of_points(snapshot: Fields, setup: Setup, quantity: Quantity) -> Solid:
    """Return what the points, and what lies behind planes of symmetry, fill on one side of the picture's plane."""
    position, volume, mass = snapshot["position"], snapshot["volume"], snapshot["mass"]
    values = quantity.values(snapshot)
    known = np.isfinite(position).all(axis=1) & np.isfinite(values) & (volume > 0) & (mass > 0)
    mine = np.isin(snapshot["body"], setup.projectiles)
    position, amounts = position[known], np.column_stack([volume, mass, values, mine])[known]
    for mirror in setup.mirrors:
        position, amounts = with_images(position, amounts, mirror)
    position, cell = position * 1e6, setup.resolved * 1e6
    nodes = _nodes(*_box(position, Cut.of(snapshot, setup), setup), cell)
    apart = float(nodes[0][1] - nodes[0][0])
    wide = max(1, round(cell / apart))
    origin = np.array([along[0] for along in nodes])
    last: NDArray[np.int64] = np.array([len(along) - 1 for along in nodes])

    def spread(amount: Array) -> Array:
        return volume_fraction((position - origin) / (wide * apart), amount, 0 * last, last, wide)

    volume, mass, values, mine = amounts.T
    mass = mass / mass.max(initial=1e-300)
    share = volume * 1e18 / (wide * apart) ** 3
    filling = spread(share)
    field, ours = mean_of(spread(mass * values), spread(mass)), mean_of(spread(share * mine), filling)
    return Solid(nodes, filling, field, ours, float(snapshot["time"][0]) * 1e9)


def _box(position: Array, cut: Cut, setup: Setup) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the corners, um, of the box behind the picture's plane, to the side where more is."""
    across, plane = slice_axis(setup), slice_plane(setup) * 1e6
    off = position[:, across] - plane
    far, near = float(off.max(initial=0.0)), float(off.min(initial=0.0))
    depth = (plane, plane + far) if far >= -near else (plane + near, plane)
    along, high = cut.limits
    sides = [along, depth, high] if across == 1 else [depth, along, high]
    lower, upper = zip(*sides, strict=True)
    return lower, upper


def _nodes(lower: tuple[float, ...], upper: tuple[float, ...], cell: float) -> tuple[Array, Array, Array]:
    """Return nodes (n,) along each axis, um, from the lower corner: two to a cell, fewer where they would be too many."""
    size, apart = np.array(upper) - lower, cell / 2
    while np.prod(np.ceil(size / apart) + 1) > MOST_NODES:
        apart *= 2
    counts = np.maximum(np.ceil(size / apart).astype(np.int64), 1)
    x, y, z = (low + apart * np.arange(count + 1) for low, count in zip(lower, counts, strict=True))
    return x, y, z
