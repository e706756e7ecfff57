"""The rim around a crater: the height of its crest, and its diameter from crest to crest (docs/metrology.md)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .surface import SIGMA, Surface

Array = NDArray[np.float64]
SECTORS = 36  # directions in which the rim's crest is looked for
FIT = 1.5  # spacings to either side of the crest to which its parabola is fitted
PATCH = 2.0  # spacings along the crest: heights closer than a cell err together


@dataclass(frozen=True)
class Rim:
    """A rim: its diameter from crest to crest, and the standard uncertainty of that, m."""

    diameter: float
    uncertainty: float


def crest_height(surface: Surface) -> Array:
    """Return the height (nx, ny), m, of the target's highest point in each column.

    In a column without solid it is the height of the lowest node.
    """
    solid = surface.fraction > 0.5
    top = len(surface.z) - 1 - np.argmax(solid[:, :, ::-1], axis=2)
    return np.where(solid.any(axis=2), surface.crossing(top), surface.z[0])


def mean_crest(surface: Surface, height: Array, centre: tuple[float, float]) -> float:
    """Return the mean of the highest points (m) in all directions from the centre (x, y; m)."""
    dx, dy = np.meshgrid(surface.x - centre[0], surface.y - centre[1], indexing="ij")
    sector = np.floor((np.arctan2(dy, dx) / (2 * math.pi) % 1.0) * SECTORS).astype(int) % SECTORS
    return float(np.mean(ndimage.maximum(height, sector, np.unique(sector))))


def rim_of(surface: Surface, height: Array, centre: tuple[float, float]) -> Rim | None:
    """Return the rim around a centre (x, y; m); None if fewer than half of the directions have a crest."""
    height = ndimage.median_filter(height, size=3)  # takes off what sticks out by a column or two
    angles = (np.arange(SECTORS) + 0.5) * 2 * math.pi / SECTORS
    found = [crest for angle in angles if (crest := crest_along(surface, height, centre, angle))]
    if 2 * len(found) < SECTORS:
        return None
    radius, flatness = np.array(found).T
    diameter = 2 * float(radius.mean())
    # The top is flat: where the surface is off by SIGMA spacings, the crest may be anywhere that is as high.
    independent = max(1.0, min(len(found), math.pi * diameter / (PATCH * surface.spacing)))
    return Rim(diameter, 2 * math.sqrt(float(np.mean(flatness**2)) / 3 / independent))


def crest_along(
    surface: Surface, height: Array, centre: tuple[float, float], angle: float
) -> tuple[float, float] | None:
    """Return the distance of the crest in a direction, m, and how flat it is, m.

    The flatness is half of the length along which the profile is as high, to SIGMA spacings. None if the crest is no
    more than half a spacing above z = 0, or if the profile still rises at the edge.
    """
    h = surface.spacing
    reach = math.hypot(surface.x[-1] - surface.x[0], surface.y[-1] - surface.y[0])
    r = np.arange(0.0, reach, h / 4)
    nodes = [
        (start + r * share - axis[0]) / surface.node_distance
        for start, share, axis in zip(
            centre, (math.cos(angle), math.sin(angle)), (surface.x, surface.y), strict=True
        )
    ]
    profile = ndimage.map_coordinates(height, nodes, order=1, mode="constant", cval=np.nan)
    profile = profile[: int(np.argmax(np.isnan(profile)))] if np.isnan(profile).any() else profile
    if len(profile) == 0 or profile.max() <= h / 2:
        return None
    top = int(np.argmax(profile))
    near = slice(max(0, top - int(4 * FIT)), top + int(4 * FIT) + 1)
    if near.stop > len(profile):
        return None
    _, b, a = np.polynomial.polynomial.polyfit(r[near] - r[top], profile[near], 2)
    vertex = float(np.clip(-b / (2 * a), -h, h)) if a < 0 else 0.0
    low = np.flatnonzero(profile < profile[top] - SIGMA * h)
    inner, outer = low[low < top].max(initial=0), low[low > top].min(initial=len(profile) - 1)
    return float(r[top]) + vertex, float(r[outer] - r[inner]) / 2
