"""The crater as a surface: from the target's points to a height map, and from it depth, diameter and volume.

The target's volume fraction is laid on a grid of its own point spacing with quadratic B-splines; solid is where it
exceeds one half. Only the largest connected piece of solid counts as target: ejecta and fragments drop out, the
projectile's material that lines the crater was never in. In each column the surface is the highest crossing of one
half of that piece, interpolated between grid points.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Surface:
    """Height (nx, ny) of the target's surface over columns x (nx,), y (ny,); m. Half models are mirrored to full ones."""

    x: Array
    y: Array
    height: Array


@dataclass(frozen=True)
class Crater:
    """Depth C_p of the bottom below z = 0, diameter D_c of the circle of the pithead's area, volume; m, m^3."""

    depth: float
    diameter: float
    volume: float
    bottom: tuple[float, float]


def target_surface(position: Array, volume: Array, spacing: float, *, half: bool) -> Surface:
    """Surface of the target's points: position (n, 3) m, volume (n,) m^3, initial spacing m.

    `half`: the points are those of a half model with the mirror plane y = 0.
    """
    if half:
        near = position[:, 1] < 2 * spacing
        position = np.concatenate([position, position[near] * (1.0, -1.0, 1.0)])
        volume = np.concatenate([volume, volume[near]])
    lower = np.floor(position.min(axis=0) / spacing) * spacing - 2 * spacing
    fraction = _volume_fraction(position, volume, lower, spacing)
    height = _height(_largest_piece(fraction), lower[2], spacing)
    x, y = (lower[a] + (np.arange(fraction.shape[a]) + 0.5) * spacing for a in (0, 1))
    if half:
        kept = y > 0
        y, height = y[kept], height[:, kept]
        y, height = np.concatenate([-y[::-1], y]), np.concatenate([height[:, ::-1], height], axis=1)
    return Surface(x, y, height)


def _volume_fraction(position: Array, volume: Array, lower: Array, spacing: float) -> Array:
    """Volume fraction at the centres lower + (i + 1/2) spacing."""
    local = (position - lower) / spacing - 0.5
    base = np.round(local).astype(np.int64) - 1
    shape = tuple(base.max(axis=0) + 5)
    f = local - base
    weights = np.stack([0.5 * (1.5 - f) ** 2, 0.75 - (f - 1.0) ** 2, 0.5 * (f - 0.5) ** 2])
    share = volume / spacing**3
    out = np.zeros(int(np.prod(shape)))
    for i, j, k in np.ndindex(3, 3, 3):
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


def _height(fraction: Array, z0: float, spacing: float) -> Array:
    """Highest crossing of one half in each column; nan where there is none."""
    solid = fraction > 0.5
    top = solid.shape[2] - 1 - np.argmax(solid[:, :, ::-1], axis=2)
    i, j = np.indices(top.shape)
    inside, outside = fraction[i, j, top], fraction[i, j, np.minimum(top + 1, solid.shape[2] - 1)]
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (inside - 0.5) / (inside - outside)
    height = z0 + (top + 0.5 + part) * spacing
    return np.where(solid.any(axis=2), height, np.nan)


def measure_crater(surface: Surface, *, spacing: float) -> Crater | None:
    """Measure the crater that holds the deepest point; None if nothing is deeper than half a spacing.

    C_p is the vertex of a paraboloid fitted to the columns within three spacings of the deepest one, so that no single
    noisy column decides. The pithead is the contour at a tenth of a spacing below z = 0 around it.
    """
    height = np.where(np.isnan(surface.height), 0.0, surface.height)
    inner = _without_edges(height)
    deepest = np.unravel_index(np.argmin(ndimage.gaussian_filter(inner, 0.7)), inner.shape)
    i, j = int(deepest[0]), int(deepest[1])
    depth = -_bottom(surface, inner, i, j, 3 * spacing)
    if depth < 0.5 * spacing:
        return None
    level = -0.1 * spacing
    area = _enclosing_area(inner, i, j, level) * spacing**2
    labels, _ = ndimage.label(inner < level)
    inside = labels == labels[i, j]
    volume = float(-inner[inside].sum()) * spacing**2
    return Crater(depth, float(2 * np.sqrt(area / np.pi)), volume, (float(surface.x[i]), float(surface.y[j])))


def _without_edges(height: Array, margin: int = 5) -> Array:
    """The height map with the rim of the domain, where the fraction fades out, put to zero."""
    out = np.zeros_like(height)
    middle = slice(margin, -margin)
    out[middle, middle] = height[middle, middle]
    return out


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


def _enclosing_area(height: Array, i: int, j: int, level: float) -> float:
    """Area (columns) inside the contour at `level` around column (i, j); the largest if none encloses it."""
    areas = []
    for contour in find_contours(height, level):  # type: ignore[no-untyped-call]
        u, v = contour[:, 0], contour[:, 1]
        area = 0.5 * abs(float(np.dot(u, np.roll(v, 1)) - np.dot(v, np.roll(u, 1))))
        areas.append((_winds_around(u - i, v - j), area))
    return max(areas)[1] if areas else 0.0


def _winds_around(u: Array, v: Array) -> bool:
    """Whether the closed polygon (u, v) goes around the origin."""
    turn = np.diff(np.unwrap(np.arctan2(v, u)))
    return bool(abs(turn.sum()) > np.pi)
