"""The target's surface near the crater: a level set of the target's volume fraction.

Linear tents as wide as the point spacing h carry each point's volume to nodes half a spacing apart; the surface is where
the fraction is one half. Which points count, and why: docs/metrology.md.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

from .scene import Mirror

Array = NDArray[np.float64]
EDGE = 3  # coarse cells at the target's sides that no crater is looked for in: they move with the boundary
MARGIN = np.array(
    [4, 4, 3]
)  # coarse cells kept around the open ones: room for the rim and for the bottom's fit
REACH = 3  # nodes that a tent may reach beyond the box


@dataclass(frozen=True)
class OnNodes:
    """A fraction (nx, ny, nz) at nodes x (nx,), y (ny,), z (nz,), m; point spacing m. What lies behind a symmetry plane
    is there too."""

    x: Array
    y: Array
    z: Array
    fraction: Array
    spacing: float


class Surface(OnNodes):
    """The solid fraction, 1/2 on the surface. Only what is open to the outside is not solid: closed voids are filled,
    pieces that do not hang together with the target are gone."""

    def section(self, axis: int, at: float) -> list[Array]:
        """Lines (n, 2), m, where the surface cuts the plane x (`axis` 0), y or z = `at`; the other axes in their order.
        Empty where the plane lies outside."""
        nodes = (self.x, self.y, self.z)
        place = (at - nodes[axis][0]) / (nodes[axis][1] - nodes[axis][0])
        if not 0 <= place <= len(nodes[axis]) - 1:
            return []
        below = min(int(place), len(nodes[axis]) - 2)
        near = self.fraction.take([below, below + 1], axis=axis)
        plane = near.take(0, axis=axis) * (below + 1 - place) + near.take(1, axis=axis) * (place - below)
        origin = np.array([nodes[a][0] for a in range(3) if a != axis])
        lines = find_contours(plane, 0.5)  # type: ignore[no-untyped-call]
        return [origin + line * self.spacing / 2 for line in lines]


class Field(OnNodes):
    """The target's volume fraction."""

    def surface(self, level: float = 0.5) -> Surface:
        """With `level` as the fraction that is taken as the surface."""
        return Surface(self.x, self.y, self.z, _outside(self.fraction - level + 0.5), self.spacing)


def target_field(
    position: Array, volume: Array, spacing: float, *, mirrors: Sequence[Mirror] = ()
) -> Field | None:
    """Of the target's points: position (n, 3) m, volume (n,) m^3, initial spacing m, surface at z = 0.

    Whole about `mirrors`. None where nothing below z = 0 is open.
    """
    origin = np.zeros(3)
    for mirror in reversed(mirrors):
        origin[mirror.axis] = mirror.at
    box = _neighbourhood(position, volume, spacing, origin, mirrors)
    if box is None:
        return None
    lower, upper = box
    upper[2] = np.inf  # the rim
    near = np.all((position > lower - spacing) & (position < upper + spacing), axis=1)
    position, volume = position[near], volume[near]
    for mirror in mirrors:
        a, face = mirror.axis, (upper if mirror.above else lower)
        if abs(face[a] - mirror.at) < 1e-6 * spacing:
            inside = (position[:, a] < mirror.at) == mirror.above
            position, volume = with_images(position[inside], volume[inside], mirror)
            lower[a], upper[a] = sorted((face[a] - (upper[a] - lower[a]), face[a] + (upper[a] - lower[a])))
    upper[2] = min(float(position[:, 2].max()) + 2 * spacing, float((upper - lower)[:2].max()))
    first = np.floor((lower - origin) / (spacing / 2) + 1e-6).astype(np.int64)
    last = np.ceil((upper - origin) / (spacing / 2) - 1e-6).astype(np.int64)
    fraction = _volume_fraction((position - origin) / spacing, volume / spacing**3, first, last)
    x, y, z = (origin[a] + np.arange(first[a], last[a] + 1) * spacing / 2 for a in range(3))
    return Field(x, y, z, fraction, spacing)


def with_images(position: Array, values: Array, mirror: Mirror) -> tuple[Array, Array]:
    """The points and their mirror images."""
    return with_image(position, mirror), np.concatenate([values, values])


def with_image(position: Array, mirror: Mirror) -> Array:
    """Places (n, 2 or 3) and their mirror images."""
    image = position.copy()
    image[:, mirror.axis] = 2 * mirror.at - image[:, mirror.axis]
    return np.concatenate([position, image])


def filling(position: Array, volume: Array, lower: Array, width: Array, shape: Sequence[int]) -> Array:
    """Share (shape) of each cell lower + i width that the points fill; points elsewhere do not count."""
    cell = np.floor((position - lower) / width).astype(np.int64)
    inside = np.all((cell >= 0) & (cell < np.array(shape)), axis=1)
    flat = np.ravel_multi_index(tuple(cell[inside].T), tuple(shape))
    filled = np.bincount(flat, volume[inside], minlength=int(np.prod(shape)))
    return np.asarray(filled.reshape(shape) / np.prod(width))


def _neighbourhood(
    position: Array, volume: Array, spacing: float, origin: Array, mirrors: Sequence[Mirror]
) -> tuple[Array, Array] | None:
    """Corners (m) of a box around what is open below z = 0: coarse cells less than half full that hang together with
    the open ones just below the plane."""
    below = position[:, 2] < 0
    if not below.any():
        return None
    width = spacing * np.array([2.0, 2.0, 1.0])
    position = position[below]
    ends = [(e - origin) / width for e in (position.min(axis=0), position.max(axis=0))]
    first, last = np.floor(ends[0]).astype(np.int64), np.ceil(ends[1]).astype(np.int64)
    last[2] = 0
    lower = origin + first * width
    opened = filling(position, volume[below], lower, width, last - first) < 0.5
    low, high = np.array([EDGE, EDGE, 0]), last - first - [EDGE, EDGE, 0]
    for mirror in mirrors:
        a, cells = mirror.axis, (mirror.at - origin[mirror.axis]) / width[mirror.axis]
        if mirror.above:
            high[a] = int(np.floor(cells + 1e-6)) - first[a]
        else:
            low[a] = int(np.ceil(cells - 1e-6)) - first[a]
    if np.any(high <= low):
        return None
    labels, _ = ndimage.label(opened[tuple(map(slice, low, high))])
    crater = np.isin(labels, np.setdiff1d(labels[:, :, -1], 0))
    if not crater.any():
        return None
    start, stop = (
        np.array(ends) for ends in zip(*((i.min(), i.max() + 1) for i in np.nonzero(crater)), strict=True)
    )
    start, stop = np.maximum(low + start - MARGIN, low), np.minimum(low + stop + MARGIN, high)
    return lower + start * width, lower + stop * width


def _volume_fraction(
    position: Array, share: Array, first: NDArray[np.int64], last: NDArray[np.int64]
) -> Array:
    """Volume fraction at the nodes first .. last, half a spacing apart; position and share in spacings.

    A tent of one spacing is the sum of three of half a spacing, weighted 1/2, 1, 1/2: eight nodes a point are enough.
    """
    local = 2 * position - (first - REACH)
    base = np.floor(local).astype(np.int64)
    shape = tuple(last - first + 1 + 2 * REACH)
    inside = np.all((base >= 0) & (base < np.array(shape) - 1), axis=1)
    base, local, share = base[inside], local[inside], share[inside]
    weights = np.stack([1.0 - (local - base), local - base])
    out = np.zeros(int(np.prod(shape)))
    for i, j, k in np.ndindex(2, 2, 2):
        node = np.ravel_multi_index((base[:, 0] + i, base[:, 1] + j, base[:, 2] + k), shape)
        weight = share * weights[i, :, 0] * weights[j, :, 1] * weights[k, :, 2]
        out += np.bincount(node, weight, minlength=out.size)
    field = out.reshape(shape)
    for axis in range(3):
        field = ndimage.convolve1d(field, [0.5, 1.0, 0.5], axis=axis)
    return np.asarray(field[(slice(REACH, -REACH),) * 3])


def largest_piece(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The largest connected piece of what is solid; nothing of nothing."""
    labels, count = ndimage.label(solid)
    if count == 0:
        return np.zeros_like(solid)
    return np.asarray(labels == np.argmax(np.bincount(labels.ravel())[1:]) + 1)


def _outside(fraction: Array) -> Array:
    """The fraction with only the voids that are open to the top, and then only the solid that hangs together.

    A cube two nodes (one point spacing) wide decides both: what is narrower, clefts between the points of a stretched
    wall, is filled, and what hangs on by less, debris on the rim, is off. Points resolve neither. A last node lets the
    cube see into the corners that it leaves.
    """
    solid = fraction > 0.5
    fraction = np.where(solid & ~largest_piece(solid), 0.0, fraction)
    void = fraction <= 0.5
    fraction = np.where(void & ~_reached_by_cube(void, _open_to_the_top), 1.0, fraction)
    solid = fraction > 0.5
    return np.where(solid & ~_reached_by_cube(solid, largest_piece), 0.0, fraction)


def _reached_by_cube(
    place: NDArray[np.bool_], choose: Callable[[NDArray[np.bool_]], NDArray[np.bool_]]
) -> NDArray[np.bool_]:
    """Of a place, what the cube covers, and one node more, while its centre stays in what is chosen of where it fits."""
    cube = np.ones((3, 3, 3))
    centres = choose(ndimage.binary_erosion(place, cube, border_value=1))
    return np.asarray(ndimage.binary_dilation(centres, cube, iterations=2) & place)


def _open_to_the_top(place: NDArray[np.bool_]) -> NDArray[np.bool_]:
    labels, _ = ndimage.label(place)
    return np.isin(labels, np.setdiff1d(labels[:, :, -1], 0))
