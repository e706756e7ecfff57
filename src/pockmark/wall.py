"""The wall that a crater is measured in: the target's bodies that a projectile meets first."""

from dataclasses import dataclass

import numpy as np

from .bodies import Block, Body, box_gap
from .scene import FaceKind, Scene

Corner = tuple[float, float, float]
LEAST_LAYERS = 1.5  # of points, that a wall must have to be measured


@dataclass(frozen=True)
class Wall:
    """Bodies (their indices) that touch one another from z = 0 down, and the corners of their box, m; the largest of their
    point spacings, m; what the grid's lower face is where their back lies on it, None where their back is free."""

    bodies: tuple[int, ...]
    lower: Corner
    upper: Corner
    spacing: float
    face: FaceKind | None = None

    @property
    def thickness(self) -> float:
        """From z = 0 to the back, m."""
        return -self.lower[2]

    @property
    def layers(self) -> float:
        """Points through it: with fewer than two there is no inside to be told from a hole."""
        return self.thickness / self.spacing

    @property
    def is_backed(self) -> bool:
        """Whether what lies behind the back is not computed: then a hole cannot be told from a deep crater."""
        return self.face not in (None, "free")


def walls(scene: Scene) -> list[tuple[int, ...]]:
    """Return the target's bodies (their indices) in groups that touch one another; what stands behind a gap is another wall."""
    left, found = list(scene.targets), []
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


def _is_at_zero(body: Body) -> bool:
    return isinstance(body, Block) and abs(body.upper[2]) <= body.spacing / 2


def _touch(a: Body, b: Body) -> bool:
    """Return whether no gap of half a point spacing lies between the boxes of two bodies."""
    return box_gap(a, b) < max(a.spacing, b.spacing) / 2
