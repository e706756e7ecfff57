"""Ellipses with the moments of an area, and the eccentricity ratios of Liu et al. 2015, Eqs. 23 and 24."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ellipse:
    """An ellipse: centre (m), lengths of the major and the minor axis (m), direction of the major axis (rad).

    The direction is the angle from x, between -pi/2 and pi/2.
    """

    centre: tuple[float, float]
    major: float
    minor: float
    orientation: float

    @property
    def e2(self) -> float:
        """Return sqrt(1 - (D_min / D_max)^2), Liu et al. 2015, Eq. 24."""
        return math.sqrt(1 - (self.minor / self.major) ** 2)

    def residual(self, contour: Array) -> float:
        """Return the root mean square distance (m) of a contour (n, 2) from the ellipse, to first order."""
        c, s = math.cos(self.orientation), math.sin(self.orientation)
        x, y = ((contour - np.array(self.centre)) @ np.array([[c, -s], [s, c]])).T
        a, b = self.major / 2, self.minor / 2
        level, slope = (x / a) ** 2 + (y / b) ** 2 - 1, 2 * np.hypot(x / a**2, y / b**2)
        return float(np.sqrt(np.mean((level / slope) ** 2)))

    def e1(self, bottom: tuple[float, float], heading: tuple[float, float]) -> float:
        """Return 2 (C_xs - C_xb) / D_max along the heading, Liu et al. 2015, Eq. 23 as printed.

        `bottom` is (x, y; m), `heading` a unit vector (x, y). e1 is positive where the bottom lies behind the centre.
        """
        ahead = sum((c - b) * h for c, b, h in zip(self.centre, bottom, heading, strict=True))
        return 2 * ahead / self.major


def with_area(covariance: Array, area: float) -> Array:
    """Return a covariance (2, 2) scaled to that of an ellipse of an area.

    The determinant of the covariance of an ellipse is (area / 4 pi)^2.
    """
    return covariance * (area / (4 * math.pi * math.sqrt(np.linalg.det(covariance))))


def ellipse_of(centre: Array, covariance: Array) -> Ellipse:
    """Return the ellipse with given moments: centre (2,) m, covariance (2, 2) m^2 of the places in it."""
    spread, axes = np.linalg.eigh(covariance)
    minor, major = (4 * math.sqrt(max(float(s), 0.0)) for s in spread)
    angle = math.atan2(float(axes[1, 1]), float(axes[0, 1]))
    return Ellipse((float(centre[0]), float(centre[1])), major, minor, math.remainder(angle, math.pi))
