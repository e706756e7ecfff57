"""What a hole through a wall measures. The definitions are in docs/metrology.md."""

import math
from dataclasses import dataclass

import numpy as np

from .contours import largest_contour, open_at_edge, polygon_moments
from .crater import Bowl, Openings
from .ellipse import Ellipse, ellipse_of, with_area
from .surface import Surface


@dataclass(frozen=True)
class Hole:
    """How many holes there are, and of the one whose narrowest section is the widest that section: least width and
    diameter of the circle of its area (m), place (x, y, z; m). None where every hole reaches the edge of the field."""

    count: int
    width: float | None
    diameter: float | None
    place: tuple[float, float, float] | None


def measure_hole(surface: Surface) -> Hole | None:
    """Return the holes of a wall whose back is free; None if there is none."""
    numbers = surface.holes
    if surface.is_backed or not numbers.any():
        return None
    openings = Openings(surface, surface.fraction[:, :, surface.within], numbers)
    each = [int(number) for number in np.unique(numbers) if number]
    necks = [neck for number in each if (neck := _neck(openings, number))]
    if not necks:
        return Hole(len(each), None, None, None)
    k, widest = max(necks, key=lambda neck: neck[1].minor)
    (x, y), z = widest.centre, float(surface.z[surface.within][k])
    return Hole(len(each), widest.minor, math.sqrt(widest.major * widest.minor), (x, y, z))


def _neck(openings: Openings, number: int) -> tuple[int, Ellipse] | None:
    """Return the slice where a hole's section is least wide, and the section's ellipse, m; None if a section is open at the edge."""
    surface, bowl = openings.surface, Bowl(openings, number)
    sections = []
    for k in range(bowl.slices):
        fraction = bowl.slice(k)
        contour = largest_contour(fraction)
        if open_at_edge(fraction) or contour is None:
            return None
        corner = np.array([surface.x[0], surface.y[0]])
        of = polygon_moments(corner + contour * surface.spacing / 2)
        sections.append((k, ellipse_of(of.centre, with_area(of.covariance, of.area))))
    return min(sections, key=lambda section: section[1].minor, default=None)
