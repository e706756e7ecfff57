"""The walls of a scene. The crater is measured in the first one."""

import numpy as np

from ..base.geometry import Wall
from ..scene.bodies import Solid, box_gap
from ..scene.scene import Scene


def walls(scene: Scene) -> list[tuple[int, ...]]:
    """Return the walls, each as the indices of its bodies: bodies of the target that touch one another.

    A body behind a gap is of another wall. One that moves by itself is of none.
    """
    left, found = [i for i in scene.targets if scene.body[i].velocity is None], []
    while left:
        group = [left.pop(0)]
        for i in group:  # grows while it is walked
            group += [j for j in left if _touch(scene.body[i], scene.body[j])]
            left = [j for j in left if j not in group]
        found.append(tuple(sorted(group)))
    return found


def first_wall(scene: Scene) -> Wall | None:
    """Return the wall with a block whose top lies at z = 0, to half a point spacing; None without one.

    Several such walls side by side are one.
    """
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
    """Return whether a body has a level top at z = 0, to half a point spacing."""
    return body.flat_top is not None and abs(body.flat_top) <= body.spacing / 2


def _touch(a: Solid, b: Solid) -> bool:
    """Return whether the gap between the boxes of two bodies is less than half a point spacing."""
    return box_gap(a, b) < max(a.spacing, b.spacing) / 2
