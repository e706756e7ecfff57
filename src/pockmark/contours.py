"""Closed contours in a slice: their area, and their extrapolation from two slices to the original plane."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree
from skimage.measure import find_contours

Array = NDArray[np.float64]


def contour_area(fraction: Array) -> float:
    """Area (nodes^2) where a slice (nx, ny) is below one half; islands are taken off."""
    return abs(sum(map(_signed_area, _contours(fraction, 0.5))))


def extrapolated_contour(upper: Array, lower: Array | None) -> Array | None:
    """The contour (n, 2), in nodes, half a spacing above the slice `upper` (nx, ny), which lies a spacing above `lower`.

    The signed distances to the two contours of one half are extrapolated, so that it may have any shape. Without
    `lower` it is the contour of `upper`. The largest, if there are several; None without any.
    """
    distance = _signed_distance(upper)
    if distance is None:
        return None
    below = None if lower is None else _signed_distance(lower)
    if below is not None:
        distance = 1.5 * distance - 0.5 * below
    contours = _contours(distance, 0.0)
    return max(contours, key=polygon_area) if contours else None


def polygon_area(contour: Array) -> float:
    """Area of a closed polygon (n, 2)."""
    return abs(_signed_area(contour))


def _contours(field: Array, level: float) -> list[Array]:
    return list(find_contours(field, level))  # type: ignore[no-untyped-call]


def _signed_area(contour: Array) -> float:
    u, v = contour[:, 0], contour[:, 1]
    return 0.5 * float(np.dot(u, np.roll(v, 1)) - np.dot(v, np.roll(u, 1)))


def _signed_distance(fraction: Array) -> Array | None:
    """Distance (nx, ny), in nodes, to the contour of one half, positive inside; None without a contour."""
    contours = _contours(fraction, 0.5)
    if not contours:
        return None
    # Points an eighth of a node apart stand for the segments between them.
    part = np.arange(8)[:, None, None] / 8
    dense = [((1 - part) * c[:-1] + part * c[1:]).reshape(-1, 2) for c in contours]
    nodes = np.indices(fraction.shape).reshape(2, -1).T
    distance: Array = KDTree(np.concatenate(dense)).query(nodes)[0].reshape(fraction.shape)
    return np.where(fraction < 0.5, distance, -distance)
