"""The uncertainty of a crater's measures: what a shift of the surface by a fraction of a point spacing does.

A surface made of points is known to within one spacing h. What lies evenly within h has the standard deviation delta
= h/sqrt(12), a seventh of a cell at two points a cell. Near the surface the fraction falls by one over h. So the
surfaces at the levels 1/2 - 1/sqrt(12) and 1/2 + 1/sqrt(12) are the surface moved by delta either way.
"""

import math

from .crater import Crater
from .surface import SIGMA

LEVELS = (0.5 - SIGMA, 0.5 + SIGMA)


def uncertainties(
    crater: Crater, shifted: tuple[Crater | None, Crater | None], spacing: float
) -> dict[str, float | None]:
    """Return standard uncertainties by the keys of the results, in the units of their values.

    None, or no key, if one is not known. For depth, diameter, volume, rim height and axes it is half of the
    difference between the `shifted` craters, at LEVELS. A shift leaves centre, bottom, e1 and e2 as they are. For
    them either end of an axis is taken to be off by delta, and the floor by delta from cell to cell.
    """
    delta = SIGMA * spacing
    low, high = shifted
    out: dict[str, float | None] = {}
    for key in ("depth", "diameter", "volume", "rim_height"):
        out[key] = half_difference(*(None if c is None else getattr(c, key) for c in (low, high)))
    bottom = out["bottom_x"] = crater.bottom_uncertainty
    if crater.diameter and (u := out["depth"]) is not None and (v := out["diameter"]) is not None:
        ratio = crater.depth / crater.diameter
        out["depth_over_diameter"] = ratio * math.hypot(u / crater.depth, v / crater.diameter)
    if crater.rim:
        out["rim_diameter"] = crater.rim.uncertainty
    if crater.pithead is None:
        return out
    axis, e = math.sqrt(2) * delta, crater.pithead
    narrow, wide = max(0.0, e.minor - axis) / e.major, min(1.0, (e.minor + axis) / e.major)
    out["centre_x"] = axis / 2
    if low and high and low.pithead and high.pithead:
        out["major_axis"] = half_difference(low.pithead.major, high.pithead.major)
        out["minor_axis"] = half_difference(low.pithead.minor, high.pithead.minor)
    out["e1"] = 2 * math.hypot(axis / 2, bottom) / e.major
    out["e2"] = (math.sqrt(1 - narrow**2) - math.sqrt(1 - wide**2)) / 2
    if (u := out["depth"]) is not None:
        for key, d in (("depth_over_major_axis", e.major), ("depth_over_minor_axis", e.minor)):
            out[key] = crater.depth / d * math.hypot(u / crater.depth, axis / d)
    return out


def half_difference(a: float | None, b: float | None) -> float | None:
    """Return the standard uncertainty of a measure, given its values at LEVELS.

    None if either is not known.
    """
    return None if a is None or b is None else abs(b - a) / 2
