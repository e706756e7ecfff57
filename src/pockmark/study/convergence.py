"""A convergence study: what each measure tends to as the cells shrink, and the sentence that says so."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..base.lengths import in_metres, unit_for
from ..metrology.limit import LARGEST_ORDER, LEAST_ORDER, Limit, limit_of
from ..view.convergence import Panel
from .campaign import Case
from .levels import Plan
from .runner import Outcome


class Quantity(NamedTuple):
    """A measure that is followed: its table and key in a result, its name, and the power of length that it is of."""

    table: str
    key: str
    name: str
    power: int

    def of(self, result: Mapping[str, Any] | None) -> float | None:
        """Return its value in a result, SI; None where there is none."""
        value: float | None = (result or {}).get(self.table, {}).get(self.key)
        return value

    def reading(self, result: Mapping[str, Any]) -> float:
        """Return the standard uncertainty with which it was read, SI; 0 where none is told, as of an energy."""
        return float((result[self.table].get("uncertainty") or {}).get(self.key) or 0.0)


QUANTITIES = (
    Quantity("crater", "depth", "C_p", 1),
    Quantity("crater", "diameter", "D_c", 1),
    Quantity("crater", "volume", "volume", 3),
    Quantity("crater", "hole_width", "hole width", 1),
    Quantity("energy", "residual_internal", "E_i^r", 0),
)


@dataclass(frozen=True)
class Finding:
    """What a study found of a quantity: its values on the cells (m), and their limit.

    `missing` says on which cells there is no value, and why. `limit` is None with fewer than two values. `own_cell` is
    the one that was asked for.
    """

    quantity: Quantity
    cells: tuple[float, ...]
    values: tuple[float, ...]
    readings: tuple[float, ...]
    limit: Limit | None
    own_cell: float
    missing: tuple[str, ...]

    def on(self, cell: float) -> float | None:
        """Return the value on a cell (m), SI; None where there is none."""
        return dict(zip(self.cells, self.values, strict=True)).get(cell)

    def error(self, value: float | None) -> tuple[float, float] | None:
        """Return the error of a value as a share of the limit, and the uncertainty of that; None if it is not known."""
        if value is None or self.limit is None or not self.limit.is_known or not self.limit.value:
            return None
        size = abs(self.limit.value)
        return (value - self.limit.value) / size, self.limit.uncertainty / size


def cases_of(plan: Plan) -> list[Case]:
    """Return the runs of a plan, the coarsest first."""
    return [Case(level.scene, {"cell": in_metres(level.cell)}, ["converge"]) for level in plan.levels]


def findings(plan: Plan, outcomes: Sequence[Outcome]) -> list[Finding]:
    """Return what the runs of a plan say of each quantity that any of them has."""
    return [
        _finding(quantity, plan, outcomes)
        for quantity in QUANTITIES
        if any(quantity.of(outcome.result) is not None for outcome in outcomes)
    ]


def _finding(quantity: Quantity, plan: Plan, outcomes: Sequence[Outcome]) -> Finding:
    """Return what the runs say of one quantity. Doubtful runs say nothing."""
    kept: list[tuple[float, float, float]] = []
    missing = []
    for level, outcome in zip(plan.levels, outcomes, strict=True):
        value = quantity.of(outcome.result)
        if outcome.result is not None and value is not None and not outcome.is_doubtful:
            kept.append((level.cell, value, quantity.reading(outcome.result)))
        else:
            why = outcome.fault or ("the run is doubtful" if outcome.is_doubtful else "there is none")
            missing.append(f"{in_metres(level.cell)}: {why}")
    cells, values, readings = (tuple(row[i] for row in kept) for i in range(3))
    limit = limit_of(cells, values, readings) if len(kept) > 1 else None
    return Finding(quantity, cells, values, readings, limit, plan.levels[plan.own].cell, tuple(missing))


def sentence(finding: Finding) -> str:
    """Return what was found of a quantity, as a sentence: its limit, and the error of the cells that were asked for."""
    name, limit = finding.quantity.name, finding.limit
    if limit is None:
        return f"{name}: its limit is not known, for fewer than two cells have a value"
    around = _interval(limit.value, limit.uncertainty, finding.quantity.power)
    if not limit.is_known:
        low, high = min(finding.values), max(finding.values)
        unit, size = unit_of(finding)
        return (
            f"{name} does not converge on these cells, where it is {low / size:.4g} to {high / size:.4g} {unit}".rstrip()
            + f"; its limit is not known ({around} by three times that range)"
        )
    own = in_metres(finding.own_cell)
    if (error := finding.error(finding.on(finding.own_cell))) is None:
        return f"{name} = {around} at the limit; your cell of {own} has no value"
    share, spread = (100 * part for part in error)
    digits = _digits(spread)
    return f"{name} = {around} at the limit; your cell of {own} has {share:+z.{digits}f} +- {spread:.{digits}f} % error"


def order_told(limit: Limit) -> str:
    """Return in words by what order a limit is known."""
    seen = f"{limit.observed:.3g}" if limit.observed is not None else ""
    turning = ", and the values rise and fall" if limit.turns else ""
    if limit.kind == "limited":
        allowed = f"{LEAST_ORDER:g} to {LARGEST_ORDER:g}"
        return f"{limit.order:g}, for {seen} is not within {allowed}{turning}"
    return {
        "same": "none: the values are the same",
        "converges": f"{limit.order or 0:.2f}{turning}",
        "assumed": f"{limit.order or 0:g}, assumed: there are two cells",
        "unknown": f"none, the fitted one is {seen}{turning}",
    }[limit.kind]


def figure(value: float) -> str:
    """Return a value with four digits, or with all that stand before the point."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def _interval(value: float, uncertainty: float, power: int) -> str:
    """Return "17.9 +- 0.4 um": a value with its interval, in the unit that suits them."""
    unit, size = unit_for(value, power=power)
    digits = _digits(uncertainty / size)
    return f"{value / size:.{digits}f} +- {uncertainty / size:.{digits}f} {unit}".rstrip()


def _digits(uncertainty: float) -> int:
    """Return with how many digits behind the point a number is written, for two of its uncertainty to show."""
    if uncertainty <= 0:
        return 4
    return min(6, max(0, 1 - int(f"{uncertainty:e}".partition("e")[2])))


def unit_of(finding: Finding) -> tuple[str, float]:
    """Return the unit that suits a quantity's values, and its size in SI; "" and 1 for a share."""
    return unit_for(*finding.values, power=finding.quantity.power)


def panels(found: Sequence[Finding]) -> Iterator[Panel]:
    """Give what the figure draws of each quantity."""
    for finding in found:
        unit, size = unit_of(finding)
        name = finding.quantity.name
        symbol = f"${name}$" if "_" in name else name
        yield Panel(
            f"{symbol} ({unit})" if unit else symbol,
            size,
            finding.cells,
            finding.values,
            finding.readings,
            finding.limit,
            finding.own_cell,
        )
