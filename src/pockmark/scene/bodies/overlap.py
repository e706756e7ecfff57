"""Whether two bodies overlap: any shapes, by what their points fill."""

import numpy as np

from .shape import NOISE, Solid

TURNS = 50  # from one body to the other and back, the most


def box_gap(a: Solid, b: Solid) -> float:
    """Return the widest gap along an axis between the boxes of two bodies, m; below 0 where the boxes overlap."""
    (al, au), (bl, bu) = a.box, b.box
    return float(np.max(np.maximum(al, bl) - np.minimum(au, bu)))


def overlap(a: Solid, b: Solid) -> bool:
    """Return whether what the points of two bodies fill shares more than a surface."""
    if box_gap(a, b) >= -NOISE * max(a.spacing, b.spacing):
        return False
    return _reaches(a, b) or _reaches(b, a)


def _reaches(a: Solid, b: Solid) -> bool:
    """Return whether a place in both is found from the starts of the first: to the nearest place in the other, and back, and so on.

    Between convex shapes that finds one wherever there is one; for a block and balls, or balls and balls, at the first turn.
    """
    here = a.starts
    for _ in range(TURNS):
        there = b.nearest(here)
        back = a.nearest(there)
        if (back == there).all(axis=1).any():
            return True
        if np.abs(back - here).max() <= NOISE * a.spacing:
            return False
        here = back
    return False
