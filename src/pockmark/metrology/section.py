"""The filling of an axisymmetric wall: a section through its axis, from rings.

A ring (r, 0, z) of volume V has the section V/(2 pi r). Sections lie on both sides of the axis, so that r = -r.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..base.geometry import Setup, Wall
from .pieces import attached, filling_of_cells
from .surface import EDGE, MARGIN, RIM, Filling, volume_fraction

Array = NDArray[np.float64]


def section_area(position: Array, volume: Array) -> Array:
    """Return the areas (n,), m^2, of the sections of rings, position (n, 3) m and volume (n,) m^3."""
    return np.asarray(volume / (2 * np.pi * np.maximum(position[:, 0], 1e-3 * np.cbrt(np.abs(volume)))))


def section_filling(position: Array, volume: Array, setup: Setup) -> Filling | None:
    """Return the filling near the crater of an axisymmetric wall's rings; None if nothing below z = 0 is open.

    It is as that of `target_filling`, with one node along y. `position` is (n, 3) m, `volume` (n,) m^3.
    """
    wall = setup.wall
    assert wall
    places, area = position[:, [0, 2]], section_area(position, volume)
    box = _neighbourhood(places, area, wall)
    if box is None:
        return None
    radius, low = box
    near = _filling_in(places, area, wall, radius, low)
    # What is open at the box's bottom may end farther down, or be a hole: that needs all of the wall.
    if not (near.surface().fraction[:, :, 0] <= 0.5).any():
        return near
    deepest = wall.lower[2]
    if not wall.face:  # it may bulge
        hangs = attached(position, area * 2 * wall.spacing, wall.spacing)
        deepest = places[hangs, 1].min(initial=deepest) - 2 * wall.spacing
    return _filling_in(places, area, wall, radius, min(low, float(deepest)))


def _neighbourhood(places: Array, area: Array, wall: Wall) -> tuple[float, float] | None:
    """Return the radius and the lower end, m, of a box around what is open below z = 0; None if nothing is.

    Places are (n, 2) of r and z, m. Coarse cells are open as those of a wall of three dimensions.
    """
    h = wall.spacing
    width = np.array([2 * h, h])
    cells = np.ceil(np.array([wall.upper[0], -wall.lower[2]]) / width - 1e-6).astype(np.int64)
    below = places[:, 1] < 0
    corner = np.array([0.0, -cells[1] * h])
    filling = filling_of_cells(places[below], area[below], corner, width, cells.tolist())
    opened = filling[: max(cells[0] - EDGE, 0)] < 0.5
    labels, _ = ndimage.label(opened)
    crater = np.isin(labels, np.setdiff1d(labels[:, -1:], 0))
    if not crater.any():
        return None
    i, k = (found for found in np.nonzero(crater))
    wide = int(i.max()) + 1
    margin = max(int(MARGIN[0]), int(np.ceil(RIM[0] * 2 * wide)))
    radius = min(wide + margin, len(opened)) * width[0]
    return float(radius), float(corner[1] + max(int(k.min()) - int(MARGIN[2]), 0) * h)


def _filling_in(places: Array, area: Array, wall: Wall, radius: float, low: float) -> Filling:
    """Return the filling within a radius (m), from a height (m) up as high as the rings reach."""
    h = wall.spacing
    near = (places[:, 0] < radius + h) & (places[:, 1] > low - h)
    places, area = places[near], area[near]
    high = min(float(places[:, 1].max(initial=low)) + 2 * h, 2 * radius)
    last = np.ceil(np.array([radius, high]) / (h / 2) - 1e-6).astype(np.int64)
    first = np.array([-last[0], np.floor(low / (h / 2) + 1e-6)], dtype=np.int64)
    both = np.concatenate([places, places * (-1.0, 1.0)])
    fraction = volume_fraction(both / h, np.tile(area, 2) / h**2, first, last)
    x, z = (np.arange(a, b + 1) * h / 2 for a, b in zip(first, last, strict=True))
    return Filling(x, np.zeros(1), z, fraction[:, None], h, wall.lower[2], wall.is_backed)
