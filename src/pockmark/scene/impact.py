"""The impact: how the projectiles come."""

import math
from typing import Annotated

from pydantic import Field, field_validator

from ..base.units import Angle, Speed
from .model import Hint, Model


class Impact(Model):
    """The velocity of the projectiles.

    `angle` is from the normal of the surface. `azimuth` is the direction along the surface to which a positive angle
    leads: about z, from +x towards +y.
    """

    speed: Annotated[Speed, Field(ge=0), Hint("up to the `max_speed` of the materials")]
    """Speed of the projectiles."""
    angle: Annotated[Angle, Hint(allowed="more than -90 deg, less than 90 deg")] = 0.0
    """Angle between the velocity and the normal of the surface; 0 is head-on."""
    azimuth: Annotated[Angle, Hint("0 deg or 180 deg in a half model about y = 0", "-360 deg to 360 deg")] = (
        0.0
    )
    """Where a positive angle leads to along the surface: about z, from +x towards +y."""

    @field_validator("angle")
    @classmethod
    def _comes_from_above(cls, angle: float) -> float:
        if not abs(angle) < math.pi / 2:
            raise ValueError(
                f"found {math.degrees(angle):g} deg, expected more than -90 deg and less than 90 deg"
            )
        return angle

    @field_validator("azimuth")
    @classmethod
    def _is_within_a_turn(cls, azimuth: float) -> float:
        if not abs(azimuth) <= 2 * math.pi * (1 + 1e-12):
            raise ValueError(f"found {math.degrees(azimuth):g} deg, expected -360 deg to 360 deg")
        return azimuth

    @property
    def velocity(self) -> tuple[float, float, float]:
        """Return the velocity, m/s.

        Across an azimuth that is a multiple of 90 degrees it is exactly 0.
        """
        along = self.speed * math.sin(self.angle)
        x, y = _unit(self.azimuth)
        return along * x + 0.0, along * y + 0.0, -self.speed * math.cos(self.angle)  # + 0.0: no -0.0

    @property
    def heading(self) -> tuple[float, float]:
        """Return the unit vector (x, y) along the surface in which the projectiles move.

        In a normal impact it is that of the azimuth.
        """
        x, y = _unit(self.azimuth)
        return (-x + 0.0, -y + 0.0) if self.angle < 0 else (x, y)


def _unit(azimuth: float) -> tuple[float, float]:
    """Return the cosine and the sine of an angle. Those of a multiple of 90 degrees are exactly 0, 1 or -1."""
    quarters = round(azimuth / (math.pi / 2))
    rest = azimuth - quarters * (math.pi / 2)
    c, s = (1.0, 0.0) if abs(rest) < 1e-12 else (math.cos(rest), math.sin(rest))
    return ((c, s), (-s + 0.0, c), (-c, -s + 0.0), (s, -c))[quarters % 4]
