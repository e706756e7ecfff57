"""Closed contours in a slice, and the moments of what they enclose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skimage.measure import find_contours

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moments:
    """The moments of an area.

    `area` is its size, `centre` (2,) its centre of gravity, `covariance` (2, 2) that of the places in it.
    """

    area: float
    centre: Array
    covariance: Array


def open_at_edge(fraction: Array) -> bool:
    """Return whether a slice (nx, ny) is below one half somewhere along its edge."""
    edges = np.concatenate([fraction[0], fraction[-1], fraction[:, 0], fraction[:, -1]])
    return bool(np.any(edges <= 0.5))


def contour_area(fraction: Array) -> float:
    """Return the area (nodes^2) where a slice (nx, ny) is below one half, without the islands in it."""
    return abs(sum(map(_signed_area, _contours(fraction))))


def largest_contour(fraction: Array) -> Array | None:
    """Return the contour (n, 2), in nodes, around the largest area below one half of a slice (nx, ny).

    None if nothing is below one half.
    """
    around = [contour for contour in _contours(fraction) if _signed_area(contour)]
    return max(around, key=lambda c: abs(_signed_area(c)), default=None)


def polygon_moments(contour: Array) -> Moments:
    """Return the moments of the area in a closed polygon (n, 2), by Green's theorem."""
    middle = contour.mean(axis=0)
    a, b = contour[:-1] - middle, contour[1:] - middle
    cross = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    area = 0.5 * cross.sum()
    centre = cross @ (a + b) / (6 * area)
    both = a + b
    second = np.einsum("n,ni,nj->ij", cross, both, both)
    second += np.einsum("n,ni,nj->ij", cross, a, a) + np.einsum("n,ni,nj->ij", cross, b, b)
    return Moments(abs(float(area)), middle + centre, second / (24 * area) - np.outer(centre, centre))


def _contours(fraction: Array) -> list[Array]:
    """Return all contours (n, 2) of one half in a slice (nx, ny), in nodes."""
    return list(find_contours(fraction, 0.5))  # type: ignore[no-untyped-call]


def _signed_area(contour: Array) -> float:
    """Return the area in a closed contour (n, 2), nodes^2; negative around an island."""
    u, v = contour[:, 0], contour[:, 1]
    return 0.5 * float(np.dot(u, np.roll(v, 1)) - np.dot(v, np.roll(u, 1)))
