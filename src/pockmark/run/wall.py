"""The wall that a crater is measured in: the target's bodies that a projectile meets first."""

import numpy as np

from ..base.geometry import Wall
from ..scene.bodies import Solid, box_gap
from ..scene.scene import Scene


def walls(scene: Scene) -> list[tuple[int, ...]]:
    """Return the target's bodies (their indices) in groups that touch one another; what stands behind a gap is another wall, and what
    moves by itself is none."""
    left, found = [i for i in scene.targets if scene.body[i].velocity is None], []
    while left:
        group = [left.pop(0)]
        for i in group:  # grows while it is walked
            group += [j for j in left if _touch(scene.body[i], scene.body[j])]
            left = [j for j in left if j not in group]
        found.append(tuple(sorted(group)))
    return found


def first_wall(scene: Scene) -> Wall | None:
    """Return the wall, or those side by side, with a block whose top lies at z = 0, to half a point spacing; None without one."""
    bodies = tuple(
        sorted(i for wall in walls(scene) if any(_is_at_zero(scene.body[i]) for i in wall) for i in wall)
    )
    if not bodies:
        return None
    lower, upper = zip(*(scene.body[i].box for i in bodies), strict=True)
    (x, y, z), (x1, y1, z1) = np.min(lower, axis=0).tolist(), np.max(upper, axis=0).tolist()
    spacing = max(scene.body[i].spacing for i in bodies)
    stands = z - scene.grid.lower[2] < spacing / 2
    return Wall(bodies, (x, y, z), (x1, y1, z1), spacing, scene.boundary.z_lower if stands else None)


def _is_at_zero(body: Solid) -> bool:
    return body.flat_top is not None and abs(body.flat_top) <= body.spacing / 2


def _touch(a: Solid, b: Solid) -> bool:
    """Return whether no gap of half a point spacing lies between the boxes of two bodies."""
    return box_gap(a, b) < max(a.spacing, b.spacing) / 2
