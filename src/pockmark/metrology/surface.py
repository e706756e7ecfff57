"""The target's surface near the crater: a level set of the target's volume fraction.

Linear tents as wide as the point spacing h carry each point's volume to nodes half a spacing apart; the surface is where
the fraction is one half. Which points count, and why: docs/metrology.md.
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
SIGMA = 12**-0.5  # deviation of a surface that lies evenly within one point spacing, in spacings
EDGE = 3  # coarse cells at the target's sides that no crater is looked for in: they move with the boundary
MARGIN = np.array(
    [4, 4, 3]
)  # coarse cells kept around the open ones: room for the rim and for the bottom's fit
RIM = np.array([0.15, 0.15, 0.0])  # of a wide crater's width: the same
REACH = 3  # nodes that a tent may reach beyond the box


@dataclass(frozen=True)
class OnNodes:
    """A fraction (nx, ny, nz) at nodes x (nx,), y (ny,), z (nz,), m; point spacing m; height of the wall's back, m, and
    whether it stands on what is not computed. What lies behind a symmetry plane is there too."""

    x: Array
    y: Array
    z: Array
    fraction: Array
    spacing: float
    back: float = -np.inf
    is_backed: bool = False


class Surface(OnNodes):
    """The solid fraction, 1/2 on the surface. Only what is open to the outside is not solid: closed voids are filled,
    pieces that do not hang together with the target are gone."""

    @property
    def within(self) -> slice:
        """The nodes along z between the wall's faces, which themselves are on the level: from half a spacing above the back,
        a whole one where it stands on something, to half a spacing below z = 0."""
        low = self.back + (1.0 if self.is_backed else 0.5) * self.spacing
        first, last = np.searchsorted(self.z, [low - 0.1 * self.spacing, -0.25 * self.spacing])
        return slice(int(first), int(last))

    @cached_property
    def holes(self) -> NDArray[np.int32]:
        """For each node `within` the wall the number of the hole that it lies in, 0 for none. A hole is open to the top and
        to what is below the wall; where that is not computed, it comes within a spacing of the back."""
        void, within = self.fraction <= 0.5, self.within
        below, _ = ndimage.label(void[:, :, within.start if self.is_backed else 0 : within.start + 1])
        is_out = np.isin(below[:, :, -1], np.setdiff1d(below[:, :, 0], 0))
        if not is_out.any() or within.start >= within.stop:
            return np.zeros(void[:, :, within].shape, dtype=np.int32)
        inside, _ = ndimage.label(void[:, :, within])
        through = np.setdiff1d(np.intersect1d(inside[:, :, 0][is_out], inside[:, :, -1]), 0)
        return np.where(np.isin(inside, through), inside, 0)

    def crossing(self, k: NDArray[np.int64]) -> Array:
        """Return the height (nx, ny), m, of one half between the nodes k (nx, ny), which are solid, and those above."""
        i, j = np.indices(k.shape)
        solid, void = self.fraction[i, j, k], self.fraction[i, j, np.minimum(k + 1, len(self.z) - 1)]
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.nan_to_num((solid - 0.5) / (solid - void), nan=0.0, posinf=0.0, neginf=0.0)
        return np.asarray(self.z[k] + np.clip(part, 0.0, 1.0) * (self.z[1] - self.z[0]))

    def section(self, axis: int, at: float) -> list[Array]:
        """Return the lines (n, 2), m, where the surface cuts the plane x (`axis` 0), y or z = `at`; the other axes in their order.
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


class Filling(OnNodes):
    """The share of the space around each node that the target's points fill."""

    def surface(self, level: float = 0.5) -> Surface:
        """Return the surface with `level` as the fraction that is taken as the surface."""
        fraction = outside(self.fraction - level + 0.5)
        return Surface(self.x, self.y, self.z, fraction, self.spacing, self.back, self.is_backed)


@dataclass(frozen=True)
class _Target:
    """The target's points: position (n, 3) m, volume (n,) m^3; their setup; where a node lies, m."""

    position: Array
    volume: Array
    setup: Setup
    origin: Array

    @property
    def spacing(self) -> float:
        """Return the initial spacing of the points, m."""
        return self.setup.wall.spacing if self.setup.wall else self.setup.spacing


def target_filling(position: Array, volume: Array, setup: Setup) -> Filling | None:
    """Return the filling near the crater of the target's points: position (n, 3) m, volume (n,) m^3.

    The original surface is z = 0. The spacing is that of the setup's wall, or of the setup where it has none. What lies
    behind a mirror is added. Points that have left the sides of the wall do not count. Returns None where nothing below
    z = 0 is open.
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
    upper[2] = np.inf  # the rim
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
    fraction = _volume_fraction((position - origin) / spacing, volume / spacing**3, first, last)
    x, y, z = (origin[a] + np.arange(first[a], last[a] + 1) * spacing / 2 for a in range(3))
    return Filling(x, y, z, fraction, spacing)


def with_images(position: Array, values: Array, mirror: Mirror) -> tuple[Array, Array]:
    """Return the points and their mirror images."""
    return with_image(position, mirror), np.concatenate([values, values])


def with_image(position: Array, mirror: Mirror) -> Array:
    """Return places (n, 2 or 3) and their mirror images."""
    image = position.copy()
    image[:, mirror.axis] = 2 * mirror.at - image[:, mirror.axis]
    return np.concatenate([position, image])


def _neighbourhood(target: _Target) -> tuple[Array, Array] | None:
    """Return the lower and upper corner, m, of a box around what is open below z = 0; None where nothing is.

    The coarse cells less than half full that hang together with the open ones just below z = 0 are open. Points that have
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


def _volume_fraction(
    position: Array, share: Array, first: NDArray[np.int64], last: NDArray[np.int64]
) -> Array:
    """Return the volume fraction at the nodes first .. last, half a spacing apart; position and share in spacings.

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
    fraction = out.reshape(shape)
    for axis in range(3):
        fraction = ndimage.convolve1d(fraction, [0.5, 1.0, 0.5], axis=axis)
    return np.asarray(fraction[(slice(REACH, -REACH),) * 3])
