"""Pieces of solid and void that hang together, in an array of nodes or cells."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Array = NDArray[np.float64]


def filling_of_cells(
    position: Array, volume: Array, lower: Array, width: Array, shape: Sequence[int]
) -> Array:
    """Return the share (shape) of each cell that the points fill.

    Cell i begins at lower + i width, m. `position` is (n, 3) m, `volume` (n,) m^3. Points outside the cells do not
    count.
    """
    cell = np.floor((position - lower) / width).astype(np.int64)
    inside = np.all((cell >= 0) & (cell < np.array(shape)), axis=1)
    flat = np.ravel_multi_index(tuple(cell[inside].T), tuple(shape))
    filled = np.bincount(flat, volume[inside], minlength=int(np.prod(shape)))
    return np.asarray(filled.reshape(shape) / np.prod(width))


def largest_piece(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the largest connected piece of what is solid; nothing if nothing is solid."""
    labels, count = ndimage.label(solid)
    if count == 0:
        return np.zeros_like(solid)
    return np.asarray(labels == np.argmax(np.bincount(labels.ravel())[1:]) + 1)


def outside(fraction: Array) -> Array:
    """Return the fraction with only the voids that are open to the top, and only the solid that hangs together.

    A cube two nodes (one point spacing) wide decides both. A void into which it does not get from the top is filled,
    such as a cleft between the points of a stretched wall. Solid that hangs on by less than the cube is taken off,
    such as debris on the rim. Points resolve neither. A part that the cube reaches includes one node more, so that
    the corners that a cube leaves are in it.
    """
    solid = fraction > 0.5
    fraction = np.where(solid & ~largest_piece(solid), 0.0, fraction)
    void = fraction <= 0.5
    fraction = np.where(void & ~_reached_by_cube(void, _open_to_the_top), 1.0, fraction)
    solid = fraction > 0.5
    return np.where(solid & ~_reached_by_cube(solid, largest_piece), 0.0, fraction)


def attached(
    position: Array, volume: Array, spacing: float, owner: NDArray[Any] | None = None
) -> NDArray[np.bool_]:
    """Return whether each point (n,) is in or next to a largest piece of what hangs together.

    Pieces are made of cells, two spacings wide, more than half full. With `owner` (n,) the largest piece of each
    owner counts: a wall behind another is no debris. Points with an owner below 0 have no piece.
    """
    if len(position) == 0:
        return np.zeros(0, dtype=bool)
    width = np.full(3, 2 * spacing)
    lower = np.floor(position.min(axis=0) / width) * width - width
    cell = np.floor((position - lower) / width).astype(np.int64)
    pieces, count = ndimage.label(
        filling_of_cells(position, volume, lower, width, cell.max(axis=0) + 2) > 0.5
    )
    of_point = pieces[tuple(cell.T)]
    owner = np.zeros(len(position), dtype=int) if owner is None else owner
    largest: list[int] = []
    for one in np.unique(owner[owner >= 0]):
        share = np.bincount(of_point[owner == one], volume[owner == one], minlength=count + 1)
        if share[1:].any():
            largest.append(int(np.argmax(share[1:])) + 1)
    near = ndimage.binary_dilation(np.isin(pieces, largest), np.ones((3, 3, 3)))
    return np.asarray(near[tuple(cell.T)])


def _reached_by_cube(
    place: NDArray[np.bool_], choose: Callable[[NDArray[np.bool_]], NDArray[np.bool_]]
) -> NDArray[np.bool_]:
    """Return the part of a place, solid or void, that a cube of 3 x 3 x 3 nodes reaches.

    The cube fits into the place around some nodes; `choose` takes those of them where it may be. It reaches the nodes
    that it covers there, and one node more.
    """
    cube = np.ones((3, 3, 3))
    centres = choose(ndimage.binary_erosion(place, cube, border_value=1))
    return np.asarray(ndimage.binary_dilation(centres, cube, iterations=2) & place)


def _open_to_the_top(place: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the part of a place that is connected to its uppermost nodes."""
    labels, _ = ndimage.label(place)
    return np.isin(labels, np.setdiff1d(labels[:, :, -1], 0))
