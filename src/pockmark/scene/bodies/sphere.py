"""A sphere: a ball of material."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ...base.units import Length
from ..model import Hint
from .balls import Balls
from .shape import NOISE, NOT_ROUND, Fit, Vector


class Sphere(Balls):
    """A ball of material.

    `center` has three coordinates, or x and y with a `gap` between the ball and z = 0.
    """

    shape: Literal["sphere"] = "sphere"
    """Kind of the body."""
    center: Annotated[tuple[Length, ...], Hint(allowed="[x, y, z], or [x, y] with a gap")]
    """Centre."""
    gap: Annotated[Length, Field(ge=0), Hint("0 m: no time is lost in flight")] | None = None
    """Clear height between the ball and z = 0."""
    radius: Annotated[Length, Field(gt=0)]
    """Radius, of which the ball has the mass."""

    @model_validator(mode="after")
    def _has_one_height(self) -> Self:
        if len(self.center) != (3 if self.gap is None else 2):
            raise ValueError(
                "needs either a center of x, y and z, or one of x and y with gap, the clear height above z = 0"
            )
        return self

    @property
    def places(self) -> tuple[Vector]:
        """Return its own centre, m."""
        x, y = self.center[:2]
        return ((x, y, self.center[2] if self.gap is None else self.gap + self.fit.length),)

    @property
    def fit(self) -> Fit:
        """Return how points fill its radius."""
        return Fit.of(self.radius, self.spacing, self.rounded)

    @property
    def written_radius(self) -> float:
        """Return its radius as it is written, m."""
        return self.radius

    def turned(self) -> Self:
        """Return the sphere itself. Raises ValueError if its centre is off the axis."""
        if max(map(abs, self.center[:2])) > NOISE * self.spacing:
            raise ValueError(NOT_ROUND)
        return self

    def is_halved_by(self, axis: int, at: float, tolerance: float) -> bool:
        """Return whether a plane across an axis goes through its centre, to a tolerance (m)."""
        return abs(self.places[0][axis] - at) <= tolerance
