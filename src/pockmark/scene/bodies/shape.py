"""What every shape of a body must give: its keys, and how points fill it."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator

from ...base.geometry import Mirror
from ...base.units import Length, Velocity
from ..model import Model

Array = NDArray[np.floating]
Vector = tuple[Length, Length, Length]
Box = Sequence[Sequence[float]]  # lower and upper corner, m
NOISE = 1e-9  # of a spacing: what floats leave of a whole number of spacings
EVERYWHERE: Box = ((-math.inf,) * 3, (math.inf,) * 3)


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


class Solid(Model):
    """A body of any shape. A shape has a file beside this one, and a place in the closed list `Body`.

    A body has the size and mass that are asked: a whole number of points lies along each of its lengths, `spacing` apart or
    a little less. `rounded` bodies have exactly `spacing` and a size rounded to it, as the paper's authors did.
    """

    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: Annotated[bool, Field(strict=True)] = False
    rounded: Annotated[bool, Field(strict=True)] = False
    velocity: tuple[Velocity, Velocity, Velocity] | None = None  # of its own, at the start

    @field_validator("velocity")
    @classmethod
    def _moves_in_one_way(cls, velocity: Any, known: ValidationInfo) -> Any:
        if velocity is not None and known.data.get("projectile"):
            raise ValueError("found on a projectile, which moves as [impact] says: give one of the two")
        return velocity

    # What a shape must give.

    @property
    @abstractmethod
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the bounding box of what its points fill, m."""

    @property
    @abstractmethod
    def fits(self) -> tuple[Fit, ...]:
        """How points fill each of its lengths."""

    @property
    @abstractmethod
    def points_about(self) -> float:
        """About how many points it has, for the asking before they are counted: it may be infinite."""

    @property
    @abstractmethod
    def point_volume(self) -> float:
        """Volume of each of its points, m^3."""

    @property
    @abstractmethod
    def written_volume(self) -> float:
        """Volume of the size that is written, m^3."""

    @property
    @abstractmethod
    def foot(self) -> tuple[float, float]:
        """x and y (m) of the vertical line where it will hit first."""

    @property
    @abstractmethod
    def diameter(self) -> float:
        """The length that a crater's depth is compared with, as its points fill it, m."""

    @abstractmethod
    def lattice(self, box: Box = EVERYWHERE) -> Array:
        """Return the positions (n, 3) of its points, m, that lie in the box, its upper faces left out."""

    @abstractmethod
    def count(self, box: Box = EVERYWHERE) -> int:
        """Return how many points lattice() makes, without making them."""

    @abstractmethod
    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest one in what its points fill; a place that lies in it comes back as it is."""

    @abstractmethod
    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return the least length across it, m, with its image where it ends at a symmetry plane, to a tolerance (m)."""

    # What a shape may give.

    @property
    def starts(self) -> Array:
        """Places in it (n, 3), m, that an overlap with another body is looked for from; enough where they reach it by nearest()."""
        return np.asarray(np.mean(self.box, axis=0, keepdims=True))

    @property
    def places(self) -> Sequence[Vector]:
        """Centres of the balls that it is made of, m."""
        return ()

    @property
    def ball_diameter(self) -> float | None:
        """Diameter of a ball that it is made of, m."""
        return None

    @property
    def neighbours(self) -> float | None:
        """Distance of neighbouring balls, m, of a body that leaves a group of craters."""
        return None

    @property
    def flat_top(self) -> float | None:
        """Height (m) of its level top, if its sides are those of its box: a crater can be measured in it."""
        return None

    @property
    def coarseness(self) -> str:
        """What is wrong where it has too few points for its shape; empty where they are enough."""
        return ""

    def is_halved_by(self, axis: int, at: float, tolerance: float) -> bool:
        """Return whether a symmetry plane across an axis, at a coordinate (m) to a tolerance (m), may cut it: then its points are mirrored."""
        return False

    def resolved(self, density: float) -> Self:
        """Return the body with what follows from its material's density, kg/m^3. Raises ValueError where that contradicts what is given."""
        return self


def require_size(lower: Sequence[float], upper: Sequence[float]) -> None:
    """Raise ValueError unless the corners of a box or patch span something in each direction."""
    if min(u - w for w, u in zip(lower, upper, strict=True)) <= 0:
        raise ValueError("upper must exceed lower in each direction")
