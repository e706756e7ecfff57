"""Cautions: what a reader of a crater's measures must know, in sentences for the results."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import shown
from ..base.geometry import ENOUGH_CELLS_ACROSS, LEAST_LAYERS, Setup, has_few_cells
from ..base.lengths import in_metres
from .crater import FIT_RADIUS, Crater
from .hole import Hole
from .results import misplaced
from .surface import Surface

SETTLED = 0.02  # share of the depth: if it changes by no more in the last tenth of a run, it has settled
ENOUGH_LAYERS = 4  # points one behind another through a wall


def missing(snapshot: Mapping[str, NDArray[Any]], setup: Setup) -> Iterator[str]:
    """Say why there is no crater to measure in a snapshot; nothing if there may be one."""
    wall = setup.wall
    if not setup.targets:
        yield "the scene has no target: every body is a projectile, and there is no crater to measure"
    elif wall is None:
        tops = ", ".join(f"{in_metres(top)}" for top in setup.tops)
        yield f"no block of the target has its top at z = 0, where the crater is measured from (found {tops}): nothing is measured"
    elif wall.layers < LEAST_LAYERS:
        yield "the target is one point thick, where neither a crater nor a hole can be told: nothing is measured"
    elif nowhere := misplaced(snapshot):
        yield f"{nowhere:,} points have a place, velocity, volume or mass that is no number: nothing is measured"
    elif not (here := np.isin(snapshot["body"], wall.bodies)).any():
        yield "no point of the target is left in the grid: there is no crater to measure"
    elif not (snapshot["position"][here, 2] < 0).any():
        yield "no point of the target is left below z = 0: there is no crater to measure"


def of_nothing(crater: Crater | None, surface: Surface | None, setup: Setup, time: float) -> Iterator[str]:
    """Say why there is no crater at a time (s), in a target in which one could be measured."""
    wall = setup.wall
    if crater is not None or wall is None or (surface is not None and surface.holes.any()):
        return
    if setup.arrival is not None and time < setup.arrival:
        yield (
            f"there is no crater yet: the run came to {time * 1e9:.4g} ns, and the first projectile is at z = 0 after "
            f"{setup.arrival * 1e9:.4g} ns"
        )
    else:
        yield (
            "there is no crater: the target's surface is whole, with nothing open deeper than half a point spacing, "
            f"{in_metres(wall.spacing / 2)}"
        )


def of_other_walls(setup: Setup) -> Iterator[str]:
    """Name the walls that are not measured."""
    first = setup.wall.bodies if setup.wall else ()
    other = [i for wall in setup.walls or () for i in wall if i not in first]
    if first and other:
        names = ", ".join(f"'{shown(setup.names[i], 40)}'" for i in other[:5])
        more = f" and {len(other) - 5} more" if len(other) > 5 else ""
        yield f"only the first wall is measured: what the impact does to {names}{more} is not in this table"


def of_hole(hole: Hole | None, surface: Surface | None, setup: Setup) -> Iterator[str]:
    """Say what a hole means for the other measures."""
    wall = setup.wall
    if surface is None or wall is None or not surface.holes.any():
        return
    if hole is None:
        yield (
            f"the crater reaches the bottom of what is computed, {in_metres(wall.thickness)} down (z_lower is {wall.face}): "
            "whether it is a hole or a crater cannot be told, and no measure is given"
        )
        return
    which = "a hole" if hole.count == 1 else f"{hole.count} holes"
    yield (
        f"perforated: {which} through the wall of {in_metres(wall.thickness)}; there is no crater depth, diameter or volume"
    )
    if hole.width is None:
        yield "every hole reaches the edge of what is computed: its width is not known"


def of_crater(crater: Crater | None, surface: Surface | None, setup: Setup) -> Iterator[str]:
    """Say where a crater is too large for its target, mirror images included."""
    wall = setup.wall
    if crater is None or surface is None or wall is None:
        return
    depth, thickness = crater.depth, wall.thickness
    if depth > thickness / 2:
        yield (
            f"the crater, {in_metres(depth)} deep, is deeper than half of the target of {in_metres(thickness)}: "
            "the target's back has a share in it"
        )
    edge, (x, y) = FIT_RADIUS * surface.spacing, crater.bottom
    sides = [x - surface.x[0], surface.x[-1] - x]
    if not surface.is_section:
        sides += [y - surface.y[0], surface.y[-1] - y]
    if min(sides) < edge:
        yield "the crater's floor touches a side face of what is computed: it may be deeper beyond"
    if crater.contour is None:
        yield (
            "the crater's opening reaches the edge of what is computed: it has no diameter, volume or rim, and the depth is "
            "not free of the edge"
        )
        return
    wide = np.ptp(crater.contour, axis=0)
    doubled = [2 if axis in [m.axis for m in setup.mirrors] else 1 for axis in (0, 1)]
    room = (np.array(wall.upper[:2]) - wall.lower[:2]) * doubled
    axis = int(np.argmax(wide / room))
    if wide[axis] > room[axis] / 2:
        yield (
            f"the crater, {in_metres(wide[axis])} wide along {'xy'[axis]}, is wider than half of the target's "
            f"{in_metres(room[axis])}: the side faces have a share in it"
        )


def of_resolution(setup: Setup, crater: Crater | None, change: float | None) -> Iterator[str]:
    """Say where points, cells or time are too few.

    `change` is how much the depth changed in the last tenth of the run, as a share; None if it is not known.
    """
    wall, cells = setup.wall, setup.cells_across
    if has_few_cells(cells):
        yield (
            f"resolution: {cells:.3g} cells across the projectile, fewer than {ENOUGH_CELLS_ACROSS}: a finer grid gives "
            "other measures"
        )
    if wall and LEAST_LAYERS <= wall.layers < ENOUGH_LAYERS - 0.5:
        yield (
            f"the target is {wall.layers:.2g} points thick, fewer than {ENOUGH_LAYERS}: whether it is perforated is not resolved"
        )
    if change is not None and change > SETTLED:
        yield f"the depth still changes by {change:.1%} in the last tenth of the run: it has not settled"
    elif change is None and crater is not None:
        forecast = (
            "" if setup.settled is None else f" (it should have after about {setup.settled * 1e9:.3g} ns)"
        )
        yield (
            "whether the depth has settled is not known: in the last tenth of the run the history has no estimate of it"
            + forecast
        )
