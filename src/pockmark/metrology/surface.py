"""The target's surface near the crater: a level set of the target's volume fraction.

Linear tents as wide as the point spacing h spread each point's volume over nodes half a spacing apart. The surface
lies where the fraction is one half. docs/metrology.md says which points count, and why.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

from ..base.geometry import Mirror, Setup
from .pieces import attached, filling_of_cells, outside

Array = NDArray[np.float64]
SIGMA = 12**-0.5  # spacings: standard deviation of what lies evenly within one spacing
EDGE = 3  # coarse cells at the target's sides in which no crater is looked for: they move with the boundary
# Room around the open cells for the rim and for the bottom's fit: in coarse cells, or as a share of a wide crater's width.
MARGIN = np.array([4, 4, 3])
RIM = np.array([0.15, 0.15, 0.0])


@dataclass(frozen=True)
class OnNodes:
    """A fraction (nx, ny, nz) at nodes x (nx,), y (ny,), z (nz,), m, half a spacing apart.

    `spacing` is that of the points, m, `back` the height of the wall's back, m. `is_backed` says that what lies
    behind the back is not computed. What lies behind a symmetry plane is in the arrays, too. With one node along y it
    is a section through the axis of what is axisymmetric (section.py).
    """

    x: Array
    y: Array
    z: Array
    fraction: Array
    spacing: float
    back: float = -np.inf
    is_backed: bool = False

    @property
    def is_section(self) -> bool:
        """Return whether it is a section through the axis of what is axisymmetric."""
        return len(self.y) == 1

    @property
    def node_distance(self) -> float:
        """Return the distance between neighbouring nodes, m: half a point spacing."""
        return self.spacing / 2


class Surface(OnNodes):
    """The solid fraction of the target, 1/2 on its surface.

    Only what is open to the outside is not solid: closed voids are filled. Pieces that do not hang together with the
    target are gone.
    """

    @property
    def within(self) -> slice:
        """Return the nodes along z that lie between the wall's faces, which are on the level themselves.

        They begin half a spacing above the back, or a whole one if the wall is backed, and end half a spacing below z
        = 0.
        """
        low = self.back + (1.0 if self.is_backed else 0.5) * self.spacing
        first, last = np.searchsorted(self.z, [low - 0.1 * self.spacing, -0.25 * self.spacing])
        return slice(int(first), int(last))

    @cached_property
    def holes(self) -> NDArray[np.int32]:
        """Return for each node `within` the wall the number of the hole in which it lies, 0 for none.

        A hole is open to the top and to what is below the wall. If that is not computed, it is one that comes within
        a spacing of the back.
        """
        void, within = self.fraction <= 0.5, self.within
        below, _ = ndimage.label(void[:, :, within.start if self.is_backed else 0 : within.start + 1])
        is_out = np.isin(below[:, :, -1], np.setdiff1d(below[:, :, 0], 0))
        if not is_out.any() or within.start >= within.stop:
            return np.zeros(void[:, :, within].shape, dtype=np.int32)
        inside, _ = ndimage.label(void[:, :, within])
        through = np.setdiff1d(np.intersect1d(inside[:, :, 0][is_out], inside[:, :, -1]), 0)
        return np.where(np.isin(inside, through), inside, 0)

    def crossing(self, k: NDArray[np.int64]) -> Array:
        """Return the height (nx, ny), m, at which the fraction is one half.

        It lies between the nodes k (nx, ny), which are solid, and the nodes above them.
        """
        i, j = np.indices(k.shape)
        solid, void = self.fraction[i, j, k], self.fraction[i, j, np.minimum(k + 1, len(self.z) - 1)]
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.nan_to_num((solid - 0.5) / (solid - void), nan=0.0, posinf=0.0, neginf=0.0)
        return np.asarray(self.z[k] + np.clip(part, 0.0, 1.0) * (self.z[1] - self.z[0]))

    def section(self, axis: int, at: float) -> list[Array]:
        """Return the lines (n, 2), m, in which the surface cuts the plane where the coordinate of an axis is `at` (m).

        Their columns are the two other axes, in order. The list is empty if the plane lies outside.
        """
        nodes = (self.x, self.y, self.z)
        if self.is_section and axis == 1 and at == self.y[0]:
            return self._lines(self.fraction[:, 0], axis)
        place = (at - nodes[axis][0]) / (nodes[axis][1] - nodes[axis][0])
        if not 0 <= place <= len(nodes[axis]) - 1:
            return []
        below = min(int(place), len(nodes[axis]) - 2)
        near = self.fraction.take([below, below + 1], axis=axis)
        plane = near.take(0, axis=axis) * (below + 1 - place) + near.take(1, axis=axis) * (place - below)
        return self._lines(plane, axis)

    def _lines(self, plane: Array, axis: int) -> list[Array]:
        """Return the lines (n, 2), m, of the surface in a plane across an axis, given the fraction in it."""
        origin = np.array([nodes[0] for a, nodes in enumerate((self.x, self.y, self.z)) if a != axis])
        lines = find_contours(plane, 0.5)  # type: ignore[no-untyped-call]
        return [origin + line * self.node_distance for line in lines]


class Filling(OnNodes):
    """The share of the space around each node that the target's points fill."""

    def surface(self, level: float = 0.5) -> Surface:
        """Return the surface that lies where the fraction is `level`."""
        fraction = self.fraction - level + 0.5
        if self.is_section:  # both sides are of the same rings: a hole does not part them
            half = outside(fraction[len(self.x) // 2 :])
            fraction = np.concatenate([half[:0:-1], half])
        else:
            fraction = outside(fraction)
        return Surface(self.x, self.y, self.z, fraction, self.spacing, self.back, self.is_backed)


@dataclass(frozen=True)
class _Target:
    """The target's points, position (n, 3) m and volume (n,) m^3, with their setup.

    `origin` (3,) is a place of a node, m.
    """

    position: Array
    volume: Array
    setup: Setup
    origin: Array

    @property
    def spacing(self) -> float:
        """Return the initial spacing of the points, m."""
        return self.setup.wall.spacing if self.setup.wall else self.setup.spacing


def target_filling(position: Array, volume: Array, setup: Setup) -> Filling | None:
    """Return the filling near the crater of the target's points; None if nothing below z = 0 is open.

    `position` is (n, 3) m, `volume` (n,) m^3. The original surface is z = 0. The points' spacing is that of the
    setup's wall, or of the setup if it has none. What lies behind a mirror is added. Points that have left the sides
    of the wall do not count.
    """
    origin = np.zeros(3)
    for mirror in reversed(setup.mirrors):
        origin[mirror.axis] = mirror.at
    target, wall = _Target(position, volume, setup, origin), setup.wall
    box = _neighbourhood(target)
    if box is None:
        return None
    lower, upper = box
    near = _filling_in(target, lower, upper)
    if wall is None:
        return near
    near = replace(near, back=wall.lower[2], is_backed=wall.is_backed)
    # What is open at the box's bottom may end farther down, or be a hole: that needs all of the wall.
    if not ((near.fraction[:, :, 0] <= 0.5).any() and (near.surface().fraction[:, :, 0] <= 0.5).any()):
        return near
    deepest = wall.lower[2]
    if not wall.face:  # it may bulge
        hangs = attached(position, volume, target.spacing)
        deepest = position[hangs, 2].min(initial=deepest) - 2 * target.spacing
    lower[2] = min(lower[2], deepest)
    whole = _filling_in(target, lower, upper)
    return replace(whole, back=near.back, is_backed=near.is_backed)


def _filling_in(target: _Target, lower: Array, upper: Array) -> Filling:
    """Return the filling in a box between two corners, m, and above it as high as the points reach.

    The nodes are half a spacing apart, counted from the target's origin.
    """
    position, volume, spacing, origin = target.position, target.volume, target.spacing, target.origin
    lower, upper = lower.copy(), upper.copy()
    upper[2] = np.inf  # for the rim
    near = np.all((position > lower - spacing) & (position < upper + spacing), axis=1)
    position, volume = position[near], volume[near]
    for mirror in target.setup.mirrors:
        a, face = mirror.axis, (upper if mirror.above else lower)
        if abs(face[a] - mirror.at) < 1e-6 * spacing:
            inside = (position[:, a] < mirror.at) == mirror.above
            position, volume = with_images(position[inside], volume[inside], mirror)
            lower[a], upper[a] = sorted((face[a] - (upper[a] - lower[a]), face[a] + (upper[a] - lower[a])))
    upper[2] = min(
        float(position[:, 2].max(initial=lower[2])) + 2 * spacing, float((upper - lower)[:2].max())
    )
    first = np.floor((lower - origin) / (spacing / 2) + 1e-6).astype(np.int64)
    last = np.ceil((upper - origin) / (spacing / 2) - 1e-6).astype(np.int64)
    fraction = volume_fraction((position - origin) / spacing, volume / spacing**3, first, last)
    x, y, z = (origin[a] + np.arange(first[a], last[a] + 1) * spacing / 2 for a in range(3))
    return Filling(x, y, z, fraction, spacing)


def with_images(position: Array, values: Array, mirror: Mirror) -> tuple[Array, Array]:
    """Return points, positions (n, 2 or 3) and values (n, ...), followed by their mirror images."""
    return with_image(position, mirror), np.concatenate([values, values])


def with_image(position: Array, mirror: Mirror) -> Array:
    """Return places (n, 2 or 3), m, followed by their mirror images."""
    image = position.copy()
    image[:, mirror.axis] = 2 * mirror.at - image[:, mirror.axis]
    return np.concatenate([position, image])


def _neighbourhood(target: _Target) -> tuple[Array, Array] | None:
    """Return the corners, m, of a box around what is open below z = 0; None if nothing is.

    Coarse cells less than half full are open if they are connected to such a cell just below z = 0. Points that have
    left the wall sideways or through its back do not count.
    """
    position, volume, spacing, origin = target.position, target.volume, target.spacing, target.origin
    wall = target.setup.wall
    below = position[:, 2] < 0
    if not below.any():
        return None
    width = spacing * np.array([2.0, 2.0, 1.0])
    position = position[below]
    lower, upper = (wall.lower, wall.upper) if wall else (position.min(axis=0), position.max(axis=0))
    first = np.floor((np.array(lower) - origin) / width + 1e-6).astype(np.int64)
    last = np.ceil((np.array(upper) - origin) / width - 1e-6).astype(np.int64)
    last[2] = 0
    lower = origin + first * width
    opened = filling_of_cells(position, volume[below], lower, width, (last - first).tolist()) < 0.5
    low, high = np.array([EDGE, EDGE, 0]), last - first - [EDGE, EDGE, 0]
    for mirror in target.setup.mirrors:
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
    margin = np.maximum(MARGIN, np.ceil(RIM * (stop - start))).astype(np.int64)
    start, stop = np.maximum(low + start - margin, low), np.minimum(low + stop + margin, high)
    return lower + start * width, lower + stop * width


def volume_fraction(
    position: Array, share: Array, first: NDArray[np.int64], last: NDArray[np.int64], nodes: int = 2
) -> Array:
    """Return the fraction at the nodes first .. last, `nodes` of them to a tent's width, of space or of a plane.

    `position` (n, 3 or 2) is in widths, `share` (n,) in cubes or squares of a width. A tent as wide as two nodes is
    the sum of three of one node's, weighted 1/2, 1, 1/2: so eight nodes a point are enough, or four. Of wider ones it
    is the same, with more of them.
    """
    reach = nodes + 1  # nodes that a tent may reach beyond the box
    local = nodes * position - (first - reach)
    base = np.floor(local).astype(np.int64)
    shape = tuple(last - first + 1 + 2 * reach)
    inside = np.all((base >= 0) & (base < np.array(shape) - 1), axis=1)
    base, local, share = base[inside], local[inside], share[inside]
    weights = np.stack([1.0 - (local - base), local - base])
    out = np.zeros(int(np.prod(shape)))
    axes = range(len(shape))
    for corner in np.ndindex(*(2 for _ in axes)):
        node = np.ravel_multi_index(tuple((base + corner).T), shape)
        weight = share
        for axis, side in zip(axes, corner, strict=True):
            weight = weight * weights[side, :, axis]
        out += np.bincount(node, weight, minlength=out.size)
    fraction = out.reshape(shape)
    tent = 1 - np.abs(np.arange(1 - nodes, nodes)) / nodes
    for axis in axes:
        fraction = ndimage.convolve1d(fraction, tent, axis=axis)
    return np.asarray(fraction[(slice(reach, -reach),) * len(shape)])
