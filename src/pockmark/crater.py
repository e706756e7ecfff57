"""The crater as a surface: from the target's points to a height map, and from it depth, diameter and volume.

The target's volume fraction is laid on a grid of its own point spacing with linear tents; solid is where it
exceeds one half. Only the largest connected piece of solid counts as target: ejecta and fragments drop out, the
projectile's material that lines the crater was never in. In each column the surface is the highest crossing of one
half of that piece, interpolated between grid points.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

from .scene import Mirror

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """The target on a grid x (nx,), y (ny,), z (nz,) m: volume fraction (nx, ny, nz) of its connected piece, height
    (nx, ny) m of its surface, nan in empty columns. What lies behind a symmetry plane is there too; `computed` are the
    columns (two slices) that do not."""

    x: Array
    y: Array
    z: Array
    fraction: Array
    height: Array
    computed: tuple[slice, slice]

    def slice(self, z: float) -> Array:
        """Volume fraction (nx, ny) at height z (m), interpolated."""
        k = int(np.clip(np.searchsorted(self.z, z) - 1, 0, len(self.z) - 2))
        part = (z - self.z[k]) / (self.z[k + 1] - self.z[k])
        return np.asarray((1 - part) * self.fraction[:, :, k] + part * self.fraction[:, :, k + 1])


@dataclass(frozen=True)
class Crater:
    """Depth C_p of the bottom below z = 0, diameter D_c of the circle of the pithead's area, volume; m, m^3.

    `diameter` is None where no closed edge lies around the bottom.
    """

    depth: float
    diameter: float | None
    volume: float
    bottom: tuple[float, float]


def target_surface(
    position: Array, volume: Array, spacing: float, *, mirrors: Sequence[Mirror] = ()
) -> Surface:
    """Surface of the target's points: position (n, 3) m, volume (n,) m^3, initial spacing m; whole about `mirrors`."""
    for mirror in mirrors:
        position, volume = _with_images(position, volume, mirror, 2 * spacing)
    # The first mirror of an axis lies between two columns; the mirrored half is then the other's exact image.
    origin = np.zeros(3)
    for mirror in reversed(mirrors):
        origin[mirror.axis] = mirror.at
    lower = origin + (np.floor((position.min(axis=0) - origin) / spacing) - 2) * spacing
    fraction = _largest_piece(_volume_fraction(position, volume, lower, spacing))
    computed = [slice(0, n) for n in fraction.shape[:2]]
    for mirror in sorted(mirrors, key=lambda m: not m.above):
        fraction = _unfolded(fraction, computed, lower, spacing, mirror)
    x, y, z = (lower[a] + (np.arange(fraction.shape[a]) + 0.5) * spacing for a in range(3))
    return Surface(x, y, z, fraction, _height(fraction, z), (computed[0], computed[1]))


def _with_images(position: Array, volume: Array, mirror: Mirror, reach: float) -> tuple[Array, Array]:
    """The points with the mirror images of those within `reach` of the mirror, whose tents cross it."""
    near = np.abs(position[:, mirror.axis] - mirror.at) < reach
    image = position[near]
    image[:, mirror.axis] = 2 * mirror.at - image[:, mirror.axis]
    return np.concatenate([position, image]), np.concatenate([volume, volume[near]])


def _unfolded(fraction: Array, computed: list[slice], lower: Array, spacing: float, mirror: Mirror) -> Array:
    """The fraction on both sides of the mirror; `computed` and `lower` are moved along."""
    a = mirror.axis
    wall = round((mirror.at - lower[a]) / spacing)  # the first column above the mirror
    kept = fraction.take(range(wall) if mirror.above else range(wall, fraction.shape[a]), axis=a)
    image = np.flip(kept, axis=a)
    n = kept.shape[a]
    if mirror.above:
        computed[a] = slice(computed[a].start, wall)
        return np.concatenate([kept, image], axis=a)
    lower[a] += (wall - n) * spacing
    computed[a] = slice(n, n + computed[a].stop - wall)
    return np.concatenate([image, kept], axis=a)


def _volume_fraction(position: Array, volume: Array, lower: Array, spacing: float) -> Array:
    """Volume fraction at the centres lower + (i + 1/2) spacing."""
    local = (position - lower) / spacing - 0.5
    base = np.floor(local).astype(np.int64)
    shape = tuple(base.max(axis=0) + 4)
    weights = np.stack([1.0 - (local - base), local - base])
    share = volume / spacing**3
    out = np.zeros(int(np.prod(shape)))
    for i, j, k in np.ndindex(2, 2, 2):
        node = np.ravel_multi_index((base[:, 0] + i, base[:, 1] + j, base[:, 2] + k), shape)
        out += np.bincount(
            node, share * weights[i, :, 0] * weights[j, :, 1] * weights[k, :, 2], minlength=out.size
        )
    return out.reshape(shape)


def _largest_piece(fraction: Array) -> Array:
    """The fraction without what does not hang together with the largest piece of solid."""
    labels, count = ndimage.label(fraction > 0.5)
    if count == 0:
        return np.zeros_like(fraction)
    largest = np.argmax(np.bincount(labels.ravel())[1:]) + 1
    others = (labels > 0) & (labels != largest)
    return np.where(others, 0.0, fraction)


def _height(fraction: Array, z: Array) -> Array:
    """Highest crossing of one half in each column; nan where there is none."""
    solid = fraction > 0.5
    top = solid.shape[2] - 1 - np.argmax(solid[:, :, ::-1], axis=2)
    i, j = np.indices(top.shape)
    inside, outside = fraction[i, j, top], fraction[i, j, np.minimum(top + 1, solid.shape[2] - 1)]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (inside - 0.5) / (inside - outside)
    height = z[top] + part * (z[1] - z[0])
    return np.where(solid.any(axis=2), height, np.nan)


def measure_crater(surface: Surface, *, spacing: float) -> Crater | None:
    """Measure the crater that holds the deepest point; None if nothing is deeper than half a spacing.

    C_p is the vertex of a paraboloid fitted to the columns within three spacings of the deepest one, pits of a column
    filled first, so that no single noisy column decides. The tents round an edge within a spacing of it, so the pithead's area is extrapolated to z = 0
    (linearly, as of a paraboloid) from the slices one and two spacings below; for a crater shallower than three
    spacings it is that of the slice half a spacing below.
    """
    height = np.where(np.isnan(surface.height), 0.0, surface.height)
    inner = _without_edges(height)
    bowl = _without_pits(inner, spacing)
    i, j = _deepest(ndimage.gaussian_filter(bowl, 0.7), surface.computed)
    depth = -_bottom(surface, bowl, i, j, 3 * spacing)
    if depth < 0.5 * spacing:
        return None

    def area(level: float) -> float:
        return _enclosing_area(surface.slice(level * spacing), i, j) * spacing**2

    pithead = area(-0.5) if depth < 3 * spacing else 2 * area(-1.0) - area(-2.0)
    labels, _ = ndimage.label(inner < -0.1 * spacing)
    inside = labels == labels[i, j]
    volume = float(-inner[inside].sum()) * spacing**2
    diameter = 2 * float(np.sqrt(pithead / np.pi)) if pithead > 0 else None
    return Crater(depth, diameter, volume, (float(surface.x[i]), float(surface.y[j])))


def _deepest(height: Array, columns: tuple[slice, slice]) -> tuple[int, int]:
    """Indices of the lowest of the columns."""
    part = height[columns]
    i, j = np.unravel_index(np.argmin(part), part.shape)
    return int(i) + columns[0].start, int(j) + columns[1].start


def _without_edges(height: Array, margin: int = 5) -> Array:
    """The height map with the rim of the domain, where the fraction fades out, put to zero."""
    out = np.zeros_like(height)
    middle = slice(margin, -margin)
    out[middle, middle] = height[middle, middle]
    return out


def _without_pits(height: Array, spacing: float) -> Array:
    """The height map with columns more than a spacing below the median of the 3 x 3 around them put to that median."""
    median = ndimage.median_filter(height, size=3)
    return np.where(height < median - spacing, median, height)


def _bottom(surface: Surface, height: Array, i: int, j: int, radius: float) -> float:
    """Lowest height of a paraboloid fitted around column (i, j), m; the column's own height if the fit has no vertex there."""
    dx, dy = np.meshgrid(surface.x - surface.x[i], surface.y - surface.y[j], indexing="ij")
    near = dx**2 + dy**2 <= radius**2
    u, v, z = dx[near] / radius, dy[near] / radius, height[near]
    basis = np.stack([np.ones_like(u), u, v, u**2, u * v, v**2], axis=1)
    a, b, c, d, e, f = np.linalg.lstsq(basis, z, rcond=None)[0]
    hessian = np.array([[2 * d, e], [e, 2 * f]])
    if np.all(np.linalg.eigvalsh(hessian) > 0):
        vertex = -np.linalg.solve(hessian, [b, c])
        if float(vertex @ vertex) <= 1.0:
            return float(a + 0.5 * (b * vertex[0] + c * vertex[1]))
    return float(height[i, j])


def _enclosing_area(fraction: Array, i: int, j: int) -> float:
    """Area (columns) inside the contour of one half around column (i, j); the largest if none encloses it."""
    areas = []
    for contour in find_contours(fraction, 0.5):  # type: ignore[no-untyped-call]
        u, v = contour[:, 0], contour[:, 1]
        area = 0.5 * abs(float(np.dot(u, np.roll(v, 1)) - np.dot(v, np.roll(u, 1))))
        areas.append((_winds_around(u - i, v - j), -area))
    # The block's own outline winds around too: the smallest contour that does is the crater's.
    return -max(areas)[1] if areas else 0.0


def _winds_around(u: Array, v: Array) -> bool:
    """Whether the closed polygon (u, v) goes around the origin."""
    turn = np.diff(np.unwrap(np.arctan2(v, u)))
    return bool(abs(turn.sum()) > np.pi)
