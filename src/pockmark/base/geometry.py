"""What a measure has to know of a scene: symmetry planes, the wall, the bodies.

It is plain data. The measures never see the scene itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

Corner = tuple[float, float, float]
ENOUGH_CELLS_ACROSS = 10  # cells across the projectile's diameter
LEAST_LAYERS = 1.5  # layers of points in a wall that is measured


@dataclass(frozen=True)
class Mirror:
    """A symmetry plane across an axis, at coordinate `at` (m).

    If `above` is true it is the upper face of what is computed, else the lower one.
    """

    axis: int
    at: float
    above: bool


@dataclass(frozen=True)
class Wall:
    """Bodies of the target that touch one another, from z = 0 down.

    `bodies` are their indices, `lower` and `upper` the corners of their box, m. `spacing` is the largest of their
    point spacings, m. `face` is the kind of the grid's lower face if their back lies on it, None if their back is
    free.
    """

    bodies: tuple[int, ...]
    lower: Corner
    upper: Corner
    spacing: float
    face: str | None = None

    @property
    def thickness(self) -> float:
        """Return the distance from z = 0 to the back, m."""
        return -self.lower[2]

    @property
    def layers(self) -> float:
        """Return how many points lie one behind another through the wall.

        With fewer than two, no inside can be told from a hole.
        """
        return self.thickness / self.spacing

    @property
    def is_backed(self) -> bool:
        """Return whether what lies behind the back is not computed.

        A hole then cannot be told from a deep crater.
        """
        return self.face not in (None, "free")


@dataclass(frozen=True)
class Setup:
    """What a measure or a picture has to know of a scene, SI. It is built once for a scene."""

    spacing: float  # m, the largest of the target's points; of the projectiles' where there is no target
    mirrors: tuple[Mirror, ...] = ()
    names: tuple[str, ...] = ()  # of the bodies, in the order of their indices
    projectiles: tuple[int, ...] = ()  # indices of the projectiles
    wall: Wall | None = None  # in which the crater is measured
    walls: tuple[tuple[int, ...], ...] | None = None  # indices of the bodies of each wall; None: all are one
    tops: tuple[float, ...] = ()  # m, heights of the tops of the target's bodies
    projectile_mass: float = 0.0  # kg, at the start, of what is computed
    projectile_diameter: float = 0.0  # m, of the first projectile as its points fill it; 0 without one
    momentum: float = 0.0  # kg m/s, at the start, into the target, of what is computed
    cells_across: float | None = None  # how many cells lie across the smallest projectile
    heading: tuple[float, float] = (1.0, 0.0)  # unit vector x, y along which the projectiles move
    is_oblique: bool = False
    hits: tuple[
        tuple[float, float], ...
    ] = ()  # m, x and y where a swarm's balls meet z = 0, no mirror images
    pitch: float = 0.0  # m, between a swarm's neighbours
    centre: tuple[float, float] = (0.0, 0.0)  # m, x and y of the first projectile, or of the grid
    arrival: float | None = None  # s: when the first projectile meets z = 0; None where none moves
    settled: float | None = None  # s: when the crater should have settled; None where nothing is known
    is_axisymmetric: bool = False  # points are rings: x their radius, mass and volume those of the circle
    cell: float = 0.0  # m, the width of the grid's cells; 0 where there is no grid

    @property
    def resolved(self) -> float:
        """Return what a picture can resolve, m: a cell, and no less than a spacing."""
        return max(self.cell, self.spacing)

    @property
    def targets(self) -> tuple[int, ...]:
        """Return the indices of the bodies that are no projectiles."""
        return tuple(i for i in range(len(self.names)) if i not in self.projectiles)


def has_few_cells(across: float | None) -> bool:
    """Return whether fewer than ENOUGH_CELLS_ACROSS cells lie across a projectile.

    A difference in the last bit decides nothing. None, for no projectile, is not few.
    """
    return across is not None and across < ENOUGH_CELLS_ACROSS * (1 - 1e-9)


def copies(mirrors: Sequence[Mirror]) -> int:
    """Return how many times the whole impact holds what is computed."""
    return int(2 ** len(mirrors))
