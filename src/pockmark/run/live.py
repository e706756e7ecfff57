"""The depth of a crater while its run goes on: an estimate from cells, made often, without a snapshot."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..base.geometry import LEAST_LAYERS, Wall
from ..metrology.pieces import largest_piece
from ..metrology.surface import EDGE
from ..scene.scene import Scene
from .simulation import Simulation
from .wall import first_wall

Array = NDArray[np.float64]
OUTSIDE = 1  # layers of nodes that the core keeps beyond each face


@dataclass(frozen=True)
class Live:
    """The crater at a moment of a run.

    `depth` is that of the deepest column of the first wall, m; nan if it cannot be told.
    """

    depth: float
    is_perforated: bool = False


def live_depth(simulation: Simulation) -> Live:
    """Return the depth of the deepest place that is open to the top, wherever it is.

    The surface is taken where the target's points fill half of the space around a node. The depth is within a tenth
    of C_p, unless the crater is only a few cells wide.
    """
    scene = simulation.scene
    wall = first_wall(scene)
    if wall is None or wall.layers < LEAST_LAYERS or simulation.points == 0:
        return Live(math.nan)
    within, z = _within(wall, scene)
    if any(s.start >= s.stop for s in within) or len(z) < 2:
        return Live(math.nan)
    fraction = _whole_at_mirrors(simulation.volume_fraction(wall.bodies), scene)[within]
    solid = fraction > 0.5
    solid[:, :, -1] = False  # every column is open at z = 0
    near = _around(~solid[:, :, :-1])
    fraction, solid, z = fraction[near], solid[near], z[near[2]]
    solid &= largest_piece(solid)
    if not solid.any():
        return Live(math.nan)
    labels, _ = ndimage.label(~solid)
    is_open = labels == labels[0, 0, -1]
    if is_open[:, :, 0].any():
        return Live(math.nan, is_perforated=not wall.is_backed)
    return Live(float(-_floor(fraction, is_open, z).min()))


def _within(wall: Wall, scene: Scene) -> tuple[tuple[slice, slice, slice], Array]:
    """Return the nodes to look at, and their heights, m.

    They lie within the wall's sides, which move with the faces. They go from the first ones at or above z = 0 down to
    the wall's back; if that is free, down to the grid's bottom.
    """
    grid, mirrored = scene.grid, {(m.axis, m.above) for m in scene.planes}
    ends = []
    for axis in (0, 1):
        low, high = ((end[axis] - grid.lower[axis]) / grid.cell for end in (wall.lower, wall.upper))
        first = 0 if (axis, False) in mirrored else math.ceil(low - 1e-6) + EDGE
        last = grid.cells[axis] if (axis, True) in mirrored else math.floor(high + 1e-6) - EDGE
        ends.append(slice(first, last + 1))
    top = math.ceil(-grid.lower[2] / grid.cell - 1e-6)
    bottom = math.ceil((wall.lower[2] - grid.lower[2]) / grid.cell + 0.5) if wall.face else 0
    z = np.asarray(grid.lower[2] + np.arange(bottom, top + 1) * grid.cell, dtype=np.float64)
    return (ends[0], ends[1], slice(bottom, top + 1)), z


def _whole_at_mirrors(fraction: NDArray[np.float32], scene: Scene) -> NDArray[np.float32]:
    """Return the fraction at the grid's own nodes.

    To nodes on a symmetry plane it adds the images of their points.
    """
    fraction = fraction[(slice(OUTSIDE, -OUTSIDE),) * 3]
    for mirror in scene.planes:
        fraction[(slice(None),) * mirror.axis + (-1 if mirror.above else 0,)] *= 2
    return fraction


def _around(void: NDArray[np.bool_]) -> tuple[slice, slice, slice]:
    """Return the box of nodes around all voids (nx, ny, nz), a node wider to each side.

    It reaches from a node below the voids to a node above the array. Without voids it has all columns, two nodes
    high.
    """
    if not void.any():
        return slice(None), slice(None), slice(void.shape[2] - 1, None)
    ends = []
    for axis in range(3):
        found = np.flatnonzero(void.any(axis=tuple(a for a in range(3) if a != axis)))
        ends.append(slice(max(int(found[0]) - 1, 0), int(found[-1]) + 2))
    return ends[0], ends[1], slice(ends[2].start, None)


def _floor(fraction: NDArray[np.float32], is_open: NDArray[np.bool_], z: Array) -> Array:
    """Return the height of the surface in each column, m.

    It is interpolated linearly between the lowest open node and the node below it.
    """
    k = np.argmax(is_open, axis=2)
    i, j = np.indices(k.shape)
    below, above = fraction[i, j, k - 1], np.minimum(fraction[i, j, k], 0.5)
    return np.asarray(z[k - 1] + (z[1] - z[0]) * np.clip((below - 0.5) / (below - above), 0, 1))
