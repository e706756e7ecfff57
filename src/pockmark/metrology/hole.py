"""The measures of a hole through a wall. The definitions are in docs/metrology.md."""

import math
from dataclasses import dataclass

import numpy as np

from .contours import largest_contour, open_at_edge, polygon_moments
from .crater import Bowl, Openings
from .ellipse import Ellipse, ellipse_of, with_area
from .surface import Surface


@dataclass(frozen=True)
class Hole:
    """The holes of a wall, and the widest one's narrowest section.

    `count` is how many holes there are. `width` is the section's least width, `diameter` that of the circle of its
    area, `place` its centre (x, y, z), all in m. These are None if every hole reaches the edge of what is computed.
    """

    count: int
    width: float | None
    diameter: float | None
    place: tuple[float, float, float] | None


def measure_hole(surface: Surface) -> Hole | None:
    """Return the holes of a wall whose back is free; None if there are none."""
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
    """Return the slice in which a hole's section is narrowest, and that section's ellipse, m.

    None if a section is open at the edge.
    """
    surface, bowl = openings.surface, Bowl(openings, number)
    sections = []
    for k in range(bowl.slices):
        fraction = bowl.slice(k)
        contour = largest_contour(fraction)
        if open_at_edge(fraction) or contour is None:
            return None
        corner = np.array([surface.x[0], surface.y[0]])
        of = polygon_moments(corner + contour * surface.node_distance)
        sections.append((k, ellipse_of(of.centre, with_area(of.covariance, of.area))))
    return min(sections, key=lambda section: section[1].minor, default=None)
