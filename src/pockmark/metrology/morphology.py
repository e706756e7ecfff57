"""The shape of a group of craters: pitheads, bottoms, and the ridges between neighbours.

The definitions, and the thresholds of the modes, are in docs/metrology.md.
"""

import itertools
import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.interpolate import interpn
from skimage.segmentation import watershed

from ..base.geometry import Setup
from .contours import polygon_moments
from .crater import Openings, Pithead, floor_of
from .ellipse import Ellipse, ellipse_of
from .surface import Surface, with_image

Array = NDArray[np.float64]
SMOOTH = (
    1.4  # nodes: deviation of the Gaussian that smooths the floor to find bottoms; ridges are not smoothed
)


@dataclass(frozen=True)
class Pit:
    """One crater of a group, SI.

    `place` (x, y) is its lowest point, `depth` that point's depth below z = 0, `roughness` the root mean square of
    what smoothing takes from its bottom. `hollow` is the number of its hollow, which joined craters share. `contour`
    (n, 2) is its pithead's h/2 below z = 0, `ellipse` the pithead's at z = 0, `residual` the root mean square
    distance of the contour from its own ellipse. The last three are None if the pithead is open at the edge.
    """

    place: tuple[float, float]
    depth: float
    roughness: float
    hollow: int
    contour: Array | None
    ellipse: Ellipse | None
    residual: float | None


@dataclass(frozen=True)
class Ridge:
    """The ridge between two neighbouring craters, `pair` their numbers, m.

    `height` is that of its lowest pass above z = 0, negative below. `rim` is the height of the lower of the two rims
    on the line from bottom to bottom, `saddle` how far the ground between the rims lies below it.
    """

    pair: tuple[int, int]
    along: str  # "x" or "y"
    height: float
    rim: float
    saddle: float


@dataclass(frozen=True)
class Group:
    """The craters of a group, and the ridges between neighbours; `spacing` is that of the points, m.

    `holes` is how many balls went through the wall, or came to its back if that is not computed: they have no crater.
    """

    pits: list[Pit]
    ridges: list[Ridge]
    spacing: float
    holes: int = 0


def group_of(surface: Surface | None, setup: Setup) -> Group | None:
    """Return the craters that a scene's swarm left in the surface; None without a swarm or a surface."""
    if surface is None or not setup.hits:
        return None
    hits = np.array(setup.hits)
    for mirror in setup.mirrors:
        hits = with_image(hits, mirror)
    return measure_group(surface, hits, setup.pitch)


def measure_group(surface: Surface, centers: Array, pitch: float) -> Group:
    """Return the craters nearest to where the balls hit.

    `centers` (n, 2) are the places of all balls, mirror images included, `pitch` is the distance of neighbours, m. A
    place without a crater deeper than half a spacing is left out.
    """
    floor = floor_of(surface)
    smooth = ndimage.gaussian_filter(floor, SMOOTH)
    through = np.asarray(surface.holes.any(axis=2))
    found = [_lowest_near(surface, smooth, center, pitch / 2) for center in centers]
    # Balls that hit side by side may have one lowest point: that is one crater.
    places = {
        n: ij
        for n, ij in enumerate(found)
        if ij and smooth[ij] < -surface.spacing / 2 and ij not in found[:n] and not through[ij]
    }
    markers = np.zeros(floor.shape, dtype=np.int32)
    for label, ij in enumerate(places.values(), 1):
        markers[ij] = label
    basins = watershed(smooth, markers)  # type: ignore[no-untyped-call]
    pits = _pits(surface, floor, smooth, basins, list(places.values()))
    ridges = [
        Ridge((a, b), along, height, *_rims(surface, floor, pits[a].place, pits[b].place))
        for (a, na), (b, nb) in itertools.combinations(enumerate(places), 2)
        if (along := _direction(centers[nb] - centers[na], pitch))
        and (height := _pass(floor, basins, a + 1, b + 1)) is not None
    ]
    return Group(pits, ridges, surface.spacing, sum(bool(ij and through[ij]) for ij in found))


def _pits(
    surface: Surface, floor: Array, smooth: Array, basins: NDArray[np.int32], places: list[tuple[int, int]]
) -> list[Pit]:
    """Return the craters with their lowest points in given columns, and with the basins 1, 2, ... around them."""
    openings = Openings.of(surface)
    bowls = [openings.bowl(*ij) for ij in places]
    shared = Counter(bowl.number for bowl in bowls)
    pits = []
    for label, ((i, j), bowl) in enumerate(zip(places, bowls, strict=True), 1):
        depth = -float(smooth[i, j])
        # Where craters share a hollow, each has what lies in its own basin.
        own = openings.within(basins == label).bowl(i, j) if shared[bowl.number] > 1 else bowl
        roughness = _roughness((floor - smooth)[(basins == label) & (smooth < -depth / 2)])
        place = (float(surface.x[i]), float(surface.y[j]))
        pits.append(Pit(place, depth, roughness, bowl.number, *_outline(own.pithead(depth))))
    return pits


def _lowest_near(surface: Surface, floor: Array, center: Array, radius: float) -> tuple[int, int] | None:
    """Return the column of the floor's lowest point within `radius` (m) of a place; None off the surface.

    The radius is measured along x and along y.
    """
    dx, dy = np.meshgrid(surface.x - center[0], surface.y - center[1], indexing="ij")
    near = np.maximum(abs(dx), abs(dy)) <= radius
    if not near.any():
        return None
    i, j = np.unravel_index(np.argmin(np.where(near, floor, np.inf)), floor.shape)
    return int(i), int(j)


def _roughness(deviation: Array) -> float:
    """Return the root mean square of what smoothing takes from a bottom, m; 0 of nothing."""
    return float(np.sqrt(np.mean(deviation**2))) if deviation.size else 0.0


def _outline(pithead: Pithead | None) -> tuple[Array | None, Ellipse | None, float | None]:
    """Return the contour, the ellipse and the residual of a pithead; None for each if there is none."""
    if pithead is None:
        return None, None, None
    own = polygon_moments(pithead.contour)
    residual = ellipse_of(own.centre, own.covariance).residual(pithead.contour)
    return pithead.contour, pithead.ellipse, residual


def _direction(apart: Array, pitch: float) -> str:
    """Return the axis along which two balls are neighbours, "x" or "y"; empty if they are not."""
    for axis, name in enumerate("xy"):
        if abs(abs(apart[axis]) - pitch) < 0.5 * pitch and abs(apart[1 - axis]) < 0.5 * pitch:
            return name
    return ""


def _pass(floor: Array, basins: NDArray[np.int32], a: int, b: int) -> float | None:
    """Return the lowest height, m, of the border between two basins; None if they do not touch."""
    lowest = math.inf
    for axis in (0, 1):
        first, second = (np.take(basins, range(n, basins.shape[axis] - 1 + n), axis=axis) for n in (0, 1))
        high = np.maximum(*(np.take(floor, range(n, floor.shape[axis] - 1 + n), axis=axis) for n in (0, 1)))
        border = ((first == a) & (second == b)) | ((first == b) & (second == a))
        if border.any():
            lowest = min(lowest, float(high[border].min()))
    return lowest if math.isfinite(lowest) else None


def _rims(
    surface: Surface, floor: Array, a: tuple[float, float], b: tuple[float, float]
) -> tuple[float, float]:
    """Return the height of the lower of two rims, and how far the ground between them lies below it, m.

    The rims are the highest points of the two halves of the line between two places (x, y; m).
    """
    place = np.linspace(a, b, len(surface.x))
    height = interpn((surface.x, surface.y), floor, place)
    half = len(height) // 2
    first, second = int(np.argmax(height[:half])), half + int(np.argmax(height[half:]))
    rim = min(height[first], height[second])
    return float(rim), float(rim - height[first : second + 1].min())
