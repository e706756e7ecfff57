"""What a measure needs to know of a scene: symmetry planes, the wall, the bodies. Plain data, without the scene itself."""

from collections.abc import Sequence
from dataclasses import dataclass

Corner = tuple[float, float, float]
ENOUGH_CELLS_ACROSS = 10  # of the grid across the projectile's diameter
LEAST_LAYERS = 1.5  # of points, that a wall must have to be measured


@dataclass(frozen=True)
class Mirror:
    """A symmetry plane at coordinate `at` (m) of an axis; `above`: it is the upper face of what is computed."""

    axis: int
    at: float
    above: bool


@dataclass(frozen=True)
class Wall:
    """Bodies (their indices) that touch one another from z = 0 down, and the corners of their box, m; the largest of their
    point spacings, m; what the grid's lower face is where their back lies on it, None where their back is free."""

    bodies: tuple[int, ...]
    lower: Corner
    upper: Corner
    spacing: float
    face: str | None = None

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


@dataclass(frozen=True)
class Setup:
    """What a measure or a picture needs to know of a scene, SI. It is built once a scene."""

    spacing: float  # of the target's points, the coarsest; the projectile's where there is no target
    mirrors: tuple[Mirror, ...] = ()
    names: tuple[str, ...] = ()  # of the bodies, by index
    projectiles: tuple[int, ...] = ()  # indices of bodies
    wall: Wall | None = None  # that the crater is measured in
    walls: tuple[tuple[int, ...], ...] | None = None  # the target's bodies that touch; None: all are one
    tops: tuple[float, ...] = ()  # of the target's bodies
    projectile_mass: float = 0.0  # at the start, of what is computed
    projectile_diameter: float = 0.0  # of the first projectile, as its points fill it; 0 without one
    momentum: float = 0.0  # at the start, into the target, of what is computed
    cells_across: float | None = None  # of the grid across the smallest projectile
    heading: tuple[float, float] = (1.0, 0.0)  # unit vector x, y along which the projectiles move
    is_oblique: bool = False
    hits: tuple[tuple[float, float], ...] = ()  # where a swarm's balls meet z = 0, without mirror images
    pitch: float = 0.0  # of a swarm's neighbours
    centre: tuple[float, float] = (0.0, 0.0)  # x and y of the first projectile, or of the grid
    arrival: float | None = None  # s: when the first projectile meets z = 0; None where none moves
    settled: float | None = None  # s: when the crater should have settled; None where nothing is known

    @property
    def targets(self) -> tuple[int, ...]:
        """Indices of the bodies that are no projectiles."""
        return tuple(i for i in range(len(self.names)) if i not in self.projectiles)


def has_few_cells(across: float | None) -> bool:
    """Return whether fewer than ENOUGH_CELLS_ACROSS cells lie across a projectile; a last bit decides nothing."""
    return across is not None and across < ENOUGH_CELLS_ACROSS * (1 - 1e-9)


def copies(mirrors: Sequence[Mirror]) -> int:
    """Return how many times the whole impact holds what is computed."""
    return int(2 ** len(mirrors))
