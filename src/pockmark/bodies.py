"""Bodies of a scene: their shapes and whether they overlap."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from .materials import Model
from .placement import MAX_BALLS, at_random, on_lattice, require_few, sphere_diameter
from .units import ArealDensity, Length

Vector = tuple[Length, Length, Length]
MAX_SEED = 2**63 - 1  # TOML's largest whole number


class Solid(Model):
    """What bodies of every shape have."""

    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: Annotated[bool, Field(strict=True)] = False


def require_size(lower: Sequence[float], upper: Sequence[float]) -> None:
    """Raises ValueError unless the corners of a box or patch span something in each direction."""
    if min(u - w for w, u in zip(lower, upper, strict=True)) <= 0:
        raise ValueError("upper must exceed lower in each direction")


class Block(Solid):
    """A brick of material between two corners."""

    shape: Literal["block"]
    lower: Vector
    upper: Vector

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        require_size(self.lower, self.upper)
        return self

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners, m."""
        return self.lower, self.upper

    @property
    def axis(self) -> tuple[float, float]:
        """x and y (m) of the vertical line where it will hit first."""
        return (self.lower[0] + self.upper[0]) / 2, (self.lower[1] + self.upper[1]) / 2


class Ball(NamedTuple):
    """A ball of points: centre (m), and radius in point spacings."""

    center: Vector
    reach: float


class Balls(Solid):
    """What bodies made of balls have."""

    @property
    @abstractmethod
    def balls(self) -> tuple[Ball, ...]:
        """Of points; of reach 0 where the spacing is too coarse for any."""

    @property
    def axis(self) -> tuple[float, float]:
        """x and y (m) of the vertical line through its first ball."""
        return self.balls[0].center[:2]


class Sphere(Balls):
    """A ball of material. Its radius is rounded to a whole number of point spacings."""

    shape: Literal["sphere"]
    center: Vector
    radius: Annotated[Length, Field(gt=0)]

    @property
    def balls(self) -> tuple[Ball, ...]:
        """Itself."""
        return (Ball(self.center, float(np.round(self.radius / self.spacing))),)  # may be infinite

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the ball's bounding box, m."""
        return _box_of([self.center], self.radius)


class Swarm(Balls):
    """Equal balls of material over a rectangular patch, their centres at one height.

    On a lattice with a `pitch`, or at random places of the patch (`seed`), each ball whole in it and clear of the others.
    `flux` is the swarm's mass a patch area: on a lattice it gives the radius (Liu et al. 2015, Eq. 29), at random places
    the number of balls.
    """

    shape: Literal["swarm"]
    lower: tuple[Length, Length]
    upper: tuple[Length, Length]
    height: Length
    pitch: Annotated[Length, Field(gt=0)] | None = None
    seed: Annotated[int, Field(strict=True, ge=0, le=MAX_SEED)] | None = None
    flux: Annotated[ArealDensity, Field(gt=0)] | None = None
    radius: Annotated[Length, Field(gt=0)] | None = None
    number: Annotated[int, Field(strict=True, gt=0, le=MAX_BALLS)] | None = None
    rounded: Annotated[bool, Field(strict=True)] = (
        True  # the radius to a whole number of point spacings, as the paper's authors did
    )

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        require_size(self.lower, self.upper)
        if (self.pitch is None) == (self.seed is None):
            raise ValueError("needs either pitch, for balls on a lattice, or seed, for random places")
        if self.pitch is not None and (self.number is not None or (self.flux or self.radius) is None):
            raise ValueError("balls on a lattice need flux or radius, and no number")
        if self.seed is not None and (self.radius is None or (self.flux or self.number) is None):
            raise ValueError("balls at random places need radius, and flux or number")
        return self

    def resolved(self, density: float) -> "Swarm":
        """With what follows from its flux, of a material of `density` kg/m^3. Raises ValueError where that contradicts what
        is given."""
        if self.flux is None:
            return self
        if self.pitch is not None:
            diameter = sphere_diameter(self.flux, area=self.pitch**2, number=1, density=density)
            return self._with("radius", diameter / 2)
        area = math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))
        ball = 4 / 3 * math.pi * (self.radius or 0.0) ** 3 * density
        number = self.flux * area / ball if ball else math.inf
        require_few(number)
        return self._with("number", round(number))

    def _with(self, key: str, value: float) -> "Swarm":
        given = getattr(self, key)
        if given is not None and not math.isclose(given, value, rel_tol=1e-9):
            raise ValueError(f"flux makes the {key} {value:.6g}, found {given:.6g}: give one of the two")
        return self.model_copy(update={key: value})

    @cached_property
    def centers(self) -> tuple[Vector, ...]:
        """Of the balls, m. Raises ValueError if they do not fit into the patch."""
        radius = self.radius or 0.0
        if self.pitch is None:
            places = at_random(self.lower, self.upper, radius, self.number or 0, self.seed or 0)
        elif 2 * radius <= self.pitch * (1 + 1e-9):
            places = on_lattice(self.lower, self.upper, self.pitch)
        else:
            raise ValueError(f"balls {2 * radius:.4g} m wide overlap at a pitch of {self.pitch:.4g} m")
        return tuple((x, y, self.height) for x, y in places)

    @property
    def distance(self) -> float:
        """Of neighbouring balls, m; at random places that of a lattice of as many."""
        if self.pitch is not None:
            return self.pitch
        area = math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))
        return math.sqrt(area / len(self.centers))

    @property
    def balls(self) -> tuple[Ball, ...]:
        """In the order of the centres."""
        reach = (self.radius or 0.0) / self.spacing
        return tuple(
            Ball(center, float(np.round(reach)) if self.rounded else reach) for center in self.centers
        )

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the bounding box of its balls, m."""
        return _box_of(self.centers, self.radius or 0.0)


Body = Annotated[Block | Sphere | Swarm, Field(discriminator="shape")]


def overlap(a: Body, b: Body) -> bool:
    """Whether two bodies share more than a surface."""
    if isinstance(a, Block) and isinstance(b, Block):
        gaps = [
            max(al, bl) - min(au, bu)
            for al, au, bl, bu in zip(a.lower, a.upper, b.lower, b.upper, strict=True)
        ]
        return max(gaps) < -1e-9 * max(a.spacing, b.spacing)
    if isinstance(b, Block):
        return overlap(b, a)
    reach = (b.radius or 0.0) * (1 - 1e-9)
    if isinstance(a, Block):
        corners = list(zip(a.lower, a.upper, strict=True))
        return any(
            math.dist([min(max(c, w), u) for c, (w, u) in zip(center, corners, strict=True)], center) < reach
            for center in _centers(b)
        )
    reach += (a.radius or 0.0) * (1 - 1e-9)
    return any(math.dist(p, q) < reach for p in _centers(a) for q in _centers(b))


def _centers(body: Sphere | Swarm) -> Sequence[Vector]:
    return [body.center] if isinstance(body, Sphere) else body.centers


def _box_of(centers: Sequence[Vector], radius: float) -> tuple[Vector, Vector]:
    (x, y, z), (x1, y1, z1) = (tuple(end(axis) for axis in zip(*centers, strict=True)) for end in (min, max))
    return (x - radius, y - radius, z - radius), (x1 + radius, y1 + radius, z1 + radius)
