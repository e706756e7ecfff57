"""The contract of a body's shape: its keys, and how points fill it."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator

from ...base.geometry import Mirror
from ...base.units import Length, Velocity
from ..model import Hint, Model

Array = NDArray[np.floating]
Vector = tuple[Length, Length, Length]
Box = Sequence[Sequence[float]]  # lower and upper corner, m
NOISE = 1e-9  # spacings: by so much rounding may be off a whole number of them
NOT_ROUND = "is not round about the axis x = y = 0, as grid.geometry 'axisymmetric' needs it"
EVERYWHERE: Box = ((-math.inf,) * 3, (math.inf,) * 3)


class Fit(NamedTuple):
    """A length that points fill.

    It holds `number` pitches of `pitch` (m): a whole number, or infinity where floats have none. `length` (m) is what
    is filled.
    """

    number: float
    pitch: float
    length: float  # m, as it is filled

    @classmethod
    def of(cls, length: float, spacing: float, rounded: bool) -> "Fit":
        """Fill a length (m) with pitches of at most `spacing` (m).

        With `rounded` they are exactly `spacing`, and their number is rounded, halves down. A length of less than a
        quarter of a spacing holds none.
        """
        ratio = length / spacing
        # NumPy's ceil, for Python's refuses infinity.
        number = float(np.ceil(ratio - (0.5 if rounded else 0.0) - NOISE)) if ratio >= 0.25 else 0.0
        if number == 0 or abs(number - ratio) <= NOISE or not math.isfinite(number):
            return cls(number, spacing, length)
        return cls(number, spacing, number * spacing) if rounded else cls(number, length / number, length)


class Solid(Model):
    """A body of any shape. A shape has a file beside this one, and a place in the closed list `Body`.

    A body has the size and the mass that are asked. A whole number of points lies along each of its lengths,
    `spacing` apart or a little less. A `rounded` body has exactly `spacing`, and a size rounded to it, as the paper's
    bodies have.
    """

    name: str
    """Name of the body; no two have the same."""
    material: str
    """Name of its material, in the scene or in the library."""
    spacing: Annotated[Length, Field(gt=0), Hint("half a cell in the target, a quarter in the projectile")]
    """Distance of its points; they lie a little closer where it does not divide the body's size."""
    projectile: Annotated[bool, Field(strict=True)] = False
    """Whether it moves as [impact] says."""
    rounded: Annotated[bool, Field(strict=True), Hint("false")] = False
    """Whether its points lie exactly `spacing` apart, in a size rounded to that, as in the paper."""
    velocity: tuple[Velocity, Velocity, Velocity] | None = None
    """Velocity (x, y, z) at the start of a body that is no projectile."""

    def model_post_init(self, context: Any) -> None:
        """Count the shape as written, though a body that is made in Python has it by default."""
        self.model_fields_set.add("shape")

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
        """Return the lower and the upper corner of a box around what its points fill, m."""

    @property
    @abstractmethod
    def fits(self) -> tuple[Fit, ...]:
        """Return how points fill each of its lengths."""

    @property
    @abstractmethod
    def points_about(self) -> float:
        """Return about how many points it has; it may be infinite.

        It is asked before the points are counted.
        """

    @property
    @abstractmethod
    def point_volume(self) -> float:
        """Return the volume of each of its points, m^3."""

    @property
    @abstractmethod
    def written_volume(self) -> float:
        """Return the volume of the size that is written, m^3."""

    @property
    @abstractmethod
    def foot(self) -> tuple[float, float]:
        """Return x and y (m) of the vertical line on which it will hit first."""

    @property
    @abstractmethod
    def diameter(self) -> float:
        """Return the length with which a crater's depth is compared, as its points fill it, m."""

    @abstractmethod
    def lattice(self, box: Box = EVERYWHERE) -> Array:
        """Return the positions (n, 3), m, of its points in the box, whose upper faces do not belong to it."""

    @abstractmethod
    def count(self, box: Box = EVERYWHERE) -> int:
        """Return how many points lattice() makes, without making them."""

    @abstractmethod
    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest place in what its points fill.

        A place that lies in it comes back as it is.
        """

    @abstractmethod
    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return the shortest length across it, m.

        Where it ends at a symmetry plane, to a tolerance (m), its image is a part of it.
        """

    # What a shape may give.

    @property
    def starts(self) -> Array:
        """Return places in it (n, 3), m, from which an overlap with another body is looked for.

        There must be enough of them for nearest() to lead to each overlap.
        """
        return np.asarray(np.mean(self.box, axis=0, keepdims=True))

    @property
    def places(self) -> Sequence[Vector]:
        """Return the centres, m, of the balls of which it is made; empty if it is made of none."""
        return ()

    @property
    def ball_diameter(self) -> float | None:
        """Return the diameter, m, of a ball of which it is made; None if it is made of none."""
        return None

    @property
    def neighbours(self) -> float | None:
        """Return the distance of neighbouring balls, m; None for a body that leaves no group of craters."""
        return None

    @property
    def flat_top(self) -> float | None:
        """Return the height (m) of its level top, in which a crater can be measured.

        None unless its sides are those of its box.
        """
        return None

    @property
    def coarseness(self) -> str:
        """Return what is wrong if it has too few points for its shape; empty if they are enough."""
        return ""

    def is_halved_by(self, axis: int, at: float, tolerance: float) -> bool:
        """Return whether a symmetry plane may cut it, with its points mirrored.

        The plane lies across an axis, at a coordinate (m) to a tolerance (m).
        """
        return False

    @property
    def rings_about(self) -> float:
        """Return about how many rings it has in an axisymmetric scene; it may be infinite."""
        return 2 * self.fits[0].number * self.fits[-1].number

    def turned(self) -> "Solid":
        """Return the body as an axisymmetric scene has it.

        Raises ValueError if it is not round about the axis x = y = 0.
        """
        raise ValueError(NOT_ROUND)

    def rings(self) -> Array:
        """Return the positions (n, 3), m, of its points in an axisymmetric scene: r, 0 and z.

        They are the row of its lattice that lies nearest to the plane y = 0.
        """
        row = self.lattice(((0.0, 0.0, -math.inf), (math.inf, self.fits[0].pitch, math.inf)))
        return np.asarray(row * (1.0, 0.0, 1.0))

    def ring_volumes(self, rings: Array) -> Array:
        """Return the volumes (n,) of its rings, m^3: 2 pi r dr dz, of the whole circle.

        They share its volume in proportion to that. Those of a `rounded` body are as they come.
        """
        volume = 2 * math.pi * rings[:, 0] * self.fits[0].pitch * self.fits[-1].pitch
        return np.asarray(volume if self.rounded else volume * (self.written_volume / volume.sum()))

    def resolved(self, density: float) -> Self:
        """Return the body with what follows from its material's density, kg/m^3.

        Raises ValueError if that contradicts what is given.
        """
        return self


def require_size(lower: Sequence[float], upper: Sequence[float]) -> None:
    """Raise ValueError unless the upper corner of a box or patch exceeds the lower one in each direction."""
    if min(u - w for w, u in zip(lower, upper, strict=True)) <= 0:
        raise ValueError("upper must exceed lower in each direction")
