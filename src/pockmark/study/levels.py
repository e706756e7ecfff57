"""The cells of a convergence study: a scene's own, with coarser and finer ones at a constant ratio, within a budget."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..base.errors import PockmarkError
from ..base.lengths import in_metres
from ..run.pipeline import require_cells_across
from ..scene.forecast import Forecast, forecast
from ..scene.scene import Scene
from ..scene.warnings import is_too_coarse

# Of neighbouring cells, tried in turn. Below 1.3 the differences drown in what else changes (Celik et al. 2008); beyond
# 2, four cells reach from those that are too coarse to those that nobody can wait for.
RATIOS = (2.0, 1.9, 1.8, 1.7, 1.6, 1.5, 1.4, 1.3)
ROUNDING = 0.97  # of a ratio that is left where cells must divide the grid
FEWEST = 2


@dataclass(frozen=True)
class Level:
    """A scene on one of the cells, and what it will take."""

    scene: Scene
    expected: Forecast

    @property
    def cell(self) -> float:
        """Return the width of its cells, m."""
        return self.scene.grid.cell


@dataclass(frozen=True)
class Plan:
    """The levels of a study, the coarsest first. `own` is the place of the one with the cells that were asked for."""

    levels: tuple[Level, ...]
    own: int
    ratio: float
    why_3d: str = ""  # why the impact is not computed as an axisymmetric one; empty if it is

    @property
    def seconds(self) -> float:
        """Return the forecast of all times together, s."""
        return sum(level.expected.seconds for level in self.levels)


def plan_of(
    scene: Scene, *, most: int, budget: float, threads: int, coarse: bool = False, in_3d: bool = False
) -> Plan:
    """Return the levels for a scene: as fine as the budget allows (s), `most` of them at most.

    A normal impact of round bodies is computed as an axisymmetric one, unless `in_3d` forbids it. A level has fewer
    than four cells across a projectile only if `coarse` allows it. Raises PockmarkError where the scene's own level has
    fewer, or not even two levels fit.
    """
    require_cells_across(scene, coarse=coarse)
    why_3d = "--in-3d forbids it" if in_3d else why_not_axisymmetric(scene)
    ladder = _Ladder(scene if why_3d else axisymmetric(scene), threads)
    for number in range(most, FEWEST - 1, -1):
        plans = [
            Plan(levels, own, ratio, why_3d)
            for own in range(number)
            for ratio in RATIOS
            if (levels := ladder.levels(number, own, ratio, coarse=coarse))
        ]
        if within := [plan for plan in plans if plan.seconds <= budget]:
            return min(within, key=lambda plan: (plan.levels[-1].cell, plan.own))
    cheapest = min(plans, key=lambda plan: plan.seconds, default=None)
    if cheapest is None:
        raise PockmarkError(
            f"grid.cell: no second cell than {in_metres(scene.grid.cell)} has four cells across the projectile, divides the grid "
            "and can be numbered; --coarse allows fewer across"
        )
    cells = " and ".join(in_metres(level.cell, 3) for level in cheapest.levels)
    raise PockmarkError(
        f"--budget: found {budget:g} s, but two cells, {cells}, take about {cheapest.seconds:.0f} s together"
    )


def why_not_axisymmetric(scene: Scene) -> str:
    """Return why an impact cannot be computed as an axisymmetric one; empty if it can.

    Beyond what the scene's own rules ask, the sides along y must be as those along x, for only these are taken.
    """
    if scene.grid.is_axisymmetric:
        return ""
    for body in scene.body:
        (_, _, _), (x, y, _) = body.box
        if abs(x - y) > 1e-6 * scene.grid.cell:
            return f"body '{body.name}' reaches to {in_metres(x)} along x and to {in_metres(y)} along y"
    if scene.boundary.x_upper != scene.boundary.y_upper:
        return "the faces x_upper and y_upper are of different kinds"
    try:
        axisymmetric(scene)
    except PockmarkError as error:
        return str(error).removeprefix("scene: ")
    return ""


def axisymmetric(scene: Scene) -> Scene:
    """Return a scene as an axisymmetric one. Raises PockmarkError if it cannot be one."""
    table = scene.to_dict()
    return Scene.from_dict(table | {"grid": table["grid"] | {"geometry": "axisymmetric"}})


def on_cells(scene: Scene, cell: float) -> Scene:
    """Return a scene on other cells (m), with as many points a cell. Raises PockmarkError.

    Its bodies have the size that is written on all cells, so none is `rounded`. Only the last state is kept.
    """
    table, factor = scene.to_dict(), cell / scene.grid.cell
    bodies: list[dict[str, Any]] = [
        body | {"spacing": factor * body["spacing"], "rounded": False} for body in table["body"]
    ]
    return Scene.from_dict(
        table
        | {
            "grid": table["grid"] | {"cell": cell},
            "body": bodies,
            "output": table["output"] | {"snapshots": scene.end_time},
        }
    )


class _Ladder:
    """The levels of a scene, each made once."""

    def __init__(self, scene: Scene, threads: int) -> None:
        """Keep the scene, and how many threads share a run."""
        self._scene, self._threads = scene, threads
        self._made: dict[float, Level | None] = {}

    def levels(self, number: int, own: int, ratio: float, *, coarse: bool) -> tuple[Level, ...]:
        """Return that many levels about a ratio apart, with the scene's own cell in a place.

        They are none if one of them cannot be, or has fewer than four cells across a projectile without `coarse`.
        """
        cells = [self._cell(ratio ** (own - place)) for place in range(number)]
        if any(a / b < ROUNDING * RATIOS[-1] for a, b in itertools.pairwise(cells)):
            return ()
        found = []
        for cell in cells:
            level = self._level(cell)
            if level is None or (is_too_coarse(level.scene) and not coarse):
                return ()
            found.append(level)
        return tuple(found)

    def _cell(self, factor: float) -> float:
        """Return the width (m) nearest to a multiple of the scene's own that divides what the own one divides."""
        own, common = self._scene.grid.cell, self._common
        if not common:
            return own * factor
        return own * common / max(1, round(common / factor))

    @cached_property
    def _common(self) -> int:
        """Return the largest number of cells that divides the grid, as the impact sees it; 0 if none does."""
        return math.gcd(*(round(number) for number in _whole(_lengths(self._scene), self._scene.grid.cell)))

    def _level(self, cell: float) -> Level | None:
        """Return the level with a cell (m); None if there is no such scene, for it would be too large."""
        if cell not in self._made:
            try:
                scene = on_cells(self._scene, cell)
                self._made[cell] = Level(scene, forecast(scene, self._threads))
            except PockmarkError:
                self._made[cell] = None
        return self._made[cell]


def _lengths(scene: Scene) -> Iterator[float]:
    """Give the lengths (m) from the grid's lower corner to its sides, to the surface, and to where the first projectile hits.

    If a whole number of cells fits on one cell and not on another, a face moves, or the impact is elsewhere in a cell.
    """
    low = scene.grid.lower
    round_ = scene.grid.is_axisymmetric
    for axis in (0,) if round_ else (0, 1):
        yield scene.grid.upper[axis] - low[axis]
        for i in scene.projectiles[:1]:
            yield scene.body[i].foot[axis] - low[axis]
    yield -low[2]


def _whole(lengths: Iterator[float], cell: float) -> Sequence[float]:
    """Return the numbers of cells (m) in those lengths (m) that have a whole number of them."""
    numbers = [length / cell for length in lengths]
    return [n for n in numbers if n > 0.5 and abs(n - round(n)) < 1e-6]
