"""Bodies of a scene: their shapes, how points fill them, and whether they overlap."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator
from scipy.spatial import KDTree

from .materials import Model
from .placement import MAX_BALLS, at_random, on_lattice, require_few, sphere_diameter
from .units import ArealDensity, Length

Vector = tuple[Length, Length, Length]
NOISE = 1e-9  # of a spacing: what floats leave of a whole number of spacings
MAX_SEED = 2**63 - 1  # TOML's largest whole number


class Solid(Model):
    """What bodies of every shape have.

    A body has the size and mass that are asked: a whole number of points lies along each of its lengths, `spacing` apart or
    a little less. `rounded` bodies have exactly `spacing` and a size rounded to it, as the paper's authors did.
    """

    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: Annotated[bool, Field(strict=True)] = False
    rounded: Annotated[bool, Field(strict=True)] = False


class Fit(NamedTuple):
    """How points fill a length: how many `pitch`es (m) it has, a whole number, or infinity where no whole number is."""

    number: float
    pitch: float
    length: float  # m, as it is filled

    @classmethod
    def of(cls, length: float, spacing: float, rounded: bool) -> "Fit":
        """Fill a length (m) with pitches of at most `spacing`, or with `rounded` of exactly `spacing`, halves rounded down.

        A length of less than a quarter of a spacing has none.
        """
        ratio = length / spacing
        # NumPy's ceil, because it knows infinity.
        number = float(np.ceil(ratio - (0.5 if rounded else 0.0) - NOISE)) if ratio >= 0.25 else 0.0
        if number == 0 or abs(number - ratio) <= NOISE or not math.isfinite(number):
            return cls(number, spacing, length)
        return cls(number, spacing, number * spacing) if rounded else cls(number, length / number, length)


def require_size(lower: Sequence[float], upper: Sequence[float]) -> None:
    """Raise ValueError unless the corners of a box or patch span something in each direction."""
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
    def fits(self) -> tuple[Fit, Fit, Fit]:
        """How points fill it along x, y and z."""
        x, y, z = (
            Fit.of(u - w, self.spacing, self.rounded) for w, u in zip(self.lower, self.upper, strict=True)
        )
        return x, y, z

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of what its points fill, m; rounding moves the sides away from the lower corner and from
        the top."""
        x, y, z = (fit.length - (u - w) for fit, w, u in zip(self.fits, self.lower, self.upper, strict=True))
        (x0, y0, z0), (x1, y1, z1) = self.lower, self.upper
        return (x0, y0, z0 - z), (x1 + x, y1 + y, z1)

    @property
    def axis(self) -> tuple[float, float]:
        """x and y (m) of the vertical line where it will hit first."""
        return (self.lower[0] + self.upper[0]) / 2, (self.lower[1] + self.upper[1]) / 2


class Balls(Solid):
    """What bodies made of equal balls have."""

    @property
    @abstractmethod
    def places(self) -> Sequence[Vector]:
        """Centres of the balls, m."""

    @property
    @abstractmethod
    def fit(self) -> Fit:
        """How points fill the radius of a ball."""

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the bounding box of what its points fill, m."""
        (x, y, z), (x1, y1, z1) = (
            tuple(end(axis) for axis in zip(*self.places, strict=True)) for end in (min, max)
        )
        r = self.fit.length
        return (x - r, y - r, z - r), (x1 + r, y1 + r, z1 + r)

    @property
    def axis(self) -> tuple[float, float]:
        """x and y (m) of the vertical line through its first ball."""
        return self.places[0][:2]


class Sphere(Balls):
    """A ball of material, at a `center` of three coordinates, or of x and y with a `gap` between it and z = 0."""

    shape: Literal["sphere"]
    center: tuple[Length, ...]
    gap: Annotated[Length, Field(ge=0)] | None = None
    radius: Annotated[Length, Field(gt=0)]

    @model_validator(mode="after")
    def _has_one_height(self) -> Self:
        if len(self.center) != (3 if self.gap is None else 2):
            raise ValueError(
                "needs either a center of x, y and z, or one of x and y with gap, the clear height above z = 0"
            )
        return self

    @property
    def places(self) -> tuple[Vector]:
        """Its own centre, m."""
        x, y = self.center[:2]
        return ((x, y, self.center[2] if self.gap is None else self.gap + self.fit.length),)

    @property
    def fit(self) -> Fit:
        """How points fill its radius."""
        return Fit.of(self.radius, self.spacing, self.rounded)


class Swarm(Balls):
    """Equal balls of material over a rectangular patch, their centres at one height, or a `gap` between them and z = 0.

    On a lattice with a `pitch`, or at random places of the patch (`seed`), each ball whole in it and clear of the others.
    `flux` is the swarm's mass a patch area: on a lattice it gives the radius (Liu et al. 2015, Eq. 29), at random places
    the number of balls.
    """

    shape: Literal["swarm"]
    lower: tuple[Length, Length]
    upper: tuple[Length, Length]
    height: Length | None = None
    gap: Annotated[Length, Field(ge=0)] | None = None
    pitch: Annotated[Length, Field(gt=0)] | None = None
    seed: Annotated[int, Field(strict=True, ge=0, le=MAX_SEED)] | None = None
    flux: Annotated[ArealDensity, Field(gt=0)] | None = None
    radius: Annotated[Length, Field(gt=0)] | None = None
    number: Annotated[int, Field(strict=True, gt=0, le=MAX_BALLS)] | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        require_size(self.lower, self.upper)
        if (self.height is None) == (self.gap is None):
            raise ValueError("needs either height, of the centres, or gap, the clear height above z = 0")
        if (self.pitch is None) == (self.seed is None):
            raise ValueError("needs either pitch, for balls on a lattice, or seed, for random places")
        if self.pitch is not None and (self.number is not None or (self.flux or self.radius) is None):
            raise ValueError("balls on a lattice need flux or radius, and no number")
        if self.seed is not None and (self.radius is None or (self.flux or self.number) is None):
            raise ValueError("balls at random places need radius, and flux or number")
        return self

    def resolved(self, density: float) -> "Swarm":
        """Return the swarm with what follows from its flux, of a material of `density` kg/m^3. Raises ValueError where that contradicts what
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
        radius = max(self.radius or 0.0, self.fit.length)  # clear of each other as written and as filled
        if self.pitch is None:
            places = at_random(self.lower, self.upper, radius, self.number or 0, self.seed or 0)
        elif 2 * radius <= self.pitch * (1 + 1e-9):
            places = on_lattice(self.lower, self.upper, self.pitch)
        else:
            raise ValueError(f"balls {2 * radius:.4g} m wide overlap at a pitch of {self.pitch:.4g} m")
        height = (self.gap or 0.0) + self.fit.length if self.height is None else self.height
        return tuple((x, y, height) for x, y in places)

    @property
    def places(self) -> tuple[Vector, ...]:
        """Centres of its balls, m."""
        return self.centers

    @property
    def fit(self) -> Fit:
        """How points fill the radius of a ball."""
        return Fit.of(self.radius or 0.0, self.spacing, self.rounded)

    @property
    def distance(self) -> float:
        """Of neighbouring balls, m; at random places that of a lattice of as many."""
        if self.pitch is not None:
            return self.pitch
        area = math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))
        return math.sqrt(area / len(self.centers))


Body = Annotated[Block | Sphere | Swarm, Field(discriminator="shape")]


def box_gap(a: Body, b: Body) -> float:
    """Return the widest gap along an axis between the boxes of two bodies, m; below 0 where the boxes overlap."""
    (al, au), (bl, bu) = a.box, b.box
    return float(np.max(np.maximum(al, bl) - np.minimum(au, bu)))


def overlap(a: Body, b: Body) -> bool:
    """Return whether what the points of two bodies fill shares more than a surface."""
    if isinstance(a, Block) and isinstance(b, Block):
        return box_gap(a, b) < -NOISE * max(a.spacing, b.spacing)
    if isinstance(b, Block):
        return overlap(b, a)
    places, reach = np.array(b.places), b.fit.length * (1 - NOISE)
    if isinstance(a, Block):
        nearest = np.clip(places, *a.box)
        return bool(np.any(((nearest - places) ** 2).sum(axis=1) < reach**2))
    reach += a.fit.length * (1 - NOISE)
    distance, _ = KDTree(np.array(a.places)).query(places)
    return bool(np.min(distance) < reach)
