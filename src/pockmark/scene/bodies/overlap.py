"""Overlaps of two bodies of any shape, by what their points fill."""

import numpy as np

from .shape import NOISE, Solid

TURNS = 50  # the most ways from one body to the other and back


def box_gap(a: Solid, b: Solid) -> float:
    """Return the widest gap along an axis between the boxes of two bodies, m.

    It is below 0 if the boxes overlap.
    """
    (al, au), (bl, bu) = a.box, b.box
    return float(np.max(np.maximum(al, bl) - np.minimum(au, bu)))


def overlap(a: Solid, b: Solid) -> bool:
    """Return whether the spaces that the points of two bodies fill share more than a surface."""
    if box_gap(a, b) >= -NOISE * max(a.spacing, b.spacing):
        return False
    return _reaches(a, b) or _reaches(b, a)


def _reaches(a: Solid, b: Solid) -> bool:
    """Return whether a place in both bodies is found from the starts of the first one.

    The way goes to the nearest place in the other body, back, and so on. Between convex shapes that finds a place in
    both wherever there is one. For a block and balls, or balls and balls, the first turn does.
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
