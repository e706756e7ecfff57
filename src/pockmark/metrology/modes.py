"""The mode of a group of craters, by rules. Liu et al. 2015, Figs. 17 and 18, found the modes by eye.

| normal impact | oblique | what is so |
|---|---|---|
| I | I | the craters are apart and alike |
| II | II | most neighbours along either direction touch, or inside craters differ from outside ones in size or shape |
| | III | inside craters are no ellipses any more |
| | IV | nor are outside ones |
| III | V | most neighbours along the scraping direction are linked (in a normal impact: along either) |
| | VI | and so are most along the other direction |
| IV | VII | most ridges are gone: there is one bottom |
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from .morphology import Group, Pit, Ridge

# They are the same for every run; docs/metrology.md says where each comes from.
THRESHOLDS = {
    "touching_along": 0.5,
    "touching_across": 0.5,
    "linked_along": 0.5,
    "linked_across": 0.5,
    "levelled": 0.5,
    "unlike": 0.1,
    "irregular_inside": 0.05,
    "irregular_outside": 0.05,
}
LEVEL = 0.1  # share of the depth: a ridge, or the ground between two rims, that is no higher counts as level
LINK = 0.5  # craters are linked where their ridge is lower than this share of the depth: chosen to agree with Table 4
ROMAN = ("I", "II", "III", "IV", "V", "VI", "VII")


@dataclass(frozen=True)
class Measures:
    """The measures that decide a group's mode. docs/metrology.md has their definitions.

    `touching_...` and `linked_...` are shares of the pairs of neighbours, along the scraping direction and across it;
    `levelled` is a share of all ridges. `unlike` is how far inside craters differ from outside ones in an axis or in
    the ratio of the axes. `irregular_...` is the median distance of a pithead from its ellipse over its mean radius.
    """

    touching_along: float
    touching_across: float
    linked_along: float
    linked_across: float
    levelled: float
    unlike: float
    irregular_inside: float
    irregular_outside: float


@dataclass(frozen=True)
class Mode:
    """A group's mode, counted from 1, and the nearest other mode.

    The group would have the nearest mode if one measure changed by `distance` times its threshold.
    """

    number: int
    nearest: int
    distance: float

    @property
    def roman(self) -> str:
        """Return the mode's number as the paper writes it."""
        return ROMAN[self.number - 1]


def measures_of(group: Group, heading: tuple[float, float] = (1.0, 0.0)) -> Measures:
    """Return the measures of a group of two craters or more.

    `heading` is a unit vector (x, y). Along the scraping direction means along the axis, x or y, that is nearer to
    it.
    """
    inside, outside = _by_place(group)
    directions = ("x", "y") if abs(heading[0]) >= abs(heading[1]) else ("y", "x")
    along, across = ([ridge for ridge in group.ridges if ridge.along == d] for d in directions)
    return Measures(
        _share([_touch(group, ridge) for ridge in along]),
        _share([_touch(group, ridge) for ridge in across]),
        _share([_is_linked(group, ridge) for ridge in along]),
        _share([_is_linked(group, ridge) for ridge in across]),
        _share([_is_levelled(group, ridge) for ridge in group.ridges]),
        _difference(inside, outside),
        _irregularity(inside),
        _irregularity(outside),
    )


def mode_of(measures: Measures, *, oblique: bool) -> Mode:
    """Return the mode that the measures decide, and how near the next one is."""
    is_over = {name: value > THRESHOLDS[name] for name, value in asdict(measures).items()}
    number = _number(is_over, oblique)
    others = []
    for name, threshold in THRESHOLDS.items():
        other = _number(is_over | {name: not is_over[name]}, oblique)
        if other != number:
            others.append((abs(getattr(measures, name) - threshold) / threshold, other))
    distance, nearest = min(others)
    return Mode(number, nearest, distance)


def _number(is_over: Mapping[str, bool], oblique: bool) -> int:
    """Return a mode's number, given which measures are over their thresholds."""
    if is_over["levelled"]:
        return 7 if oblique else 4
    if not oblique:
        return 3 if is_over["linked_along"] or is_over["linked_across"] else _second(is_over)
    if is_over["linked_along"]:
        return 6 if is_over["linked_across"] else 5
    if is_over["irregular_inside"]:
        return 4 if is_over["irregular_outside"] else 3
    return _second(is_over)


def _second(is_over: Mapping[str, bool]) -> int:
    """Return mode 2 if craters touch or differ, or else mode 1."""
    return 2 if is_over["touching_along"] or is_over["touching_across"] or is_over["unlike"] else 1


def _touch(group: Group, ridge: Ridge) -> bool:
    """Return whether two craters share a hollow, or their two rims have become one."""
    _, deeper = _depths(group, ridge)
    return ridge.height < -group.spacing / 2 or ridge.saddle < LEVEL * deeper < ridge.rim


def _is_linked(group: Group, ridge: Ridge) -> bool:
    """Return whether the ridge between two craters is lower than LINK times the shallower one's depth."""
    shallower, _ = _depths(group, ridge)
    return ridge.height < -LINK * shallower


def bottoms_of(group: Group) -> int:
    """Return how many separate bottoms a group has: craters with a levelled ridge between them share one."""
    if not (n := len(group.pits)):
        return 0
    joined = np.zeros((n, n), dtype=bool)
    for ridge in group.ridges:
        joined[ridge.pair] = _is_levelled(group, ridge)
    return int(connected_components(joined, directed=False, return_labels=False))


def _is_levelled(group: Group, ridge: Ridge) -> bool:
    """Return whether the ridge between two craters has come down to the shallower one's bottom."""
    shallower, deeper = _depths(group, ridge)
    return ridge.height + shallower < LEVEL * deeper


def _depths(group: Group, ridge: Ridge) -> list[float]:
    """Return the depths of the two craters at a ridge, m, the shallower one first."""
    return sorted(group.pits[i].depth for i in ridge.pair)


def _by_place(group: Group) -> tuple[list[Pit], list[Pit]]:
    """Return the craters with the most neighbours, and those with the fewest.

    If all have as many, both lists hold all.
    """
    neighbours = np.zeros(len(group.pits), dtype=int)
    for ridge in group.ridges:
        neighbours[list(ridge.pair)] += 1
    inside, outside = (
        [pit for pit, n in zip(group.pits, neighbours, strict=True) if n == end]
        for end in (neighbours.max(), neighbours.min())
    )
    return inside, outside


def _difference(inside: Sequence[Pit], outside: Sequence[Pit]) -> float:
    """Return the largest relative difference of inside and outside craters.

    Compared are the medians of the major axis, of the minor axis, and of their ratio. 0 if either have no ellipse.
    """
    shapes = [
        np.median([(e.major, e.minor, e.major / e.minor) for p in pits if (e := p.ellipse)], axis=0)
        for pits in (inside, outside)
        if any(p.ellipse for p in pits)
    ]
    return float(np.max(np.abs(shapes[0] / shapes[1] - 1))) if len(shapes) == 2 else 0.0


def _irregularity(pits: Sequence[Pit]) -> float:
    """Return the median of the craters' distance from their ellipses over the mean radius; 0 of none."""
    found = [
        p.residual / ((p.ellipse.major + p.ellipse.minor) / 4)
        for p in pits
        if p.ellipse is not None and p.residual is not None
    ]
    return float(np.median(found)) if found else 0.0


def _share(of: Sequence[bool]) -> float:
    """Return the share of what is true; 0 of nothing."""
    return sum(of) / len(of) if of else 0.0
