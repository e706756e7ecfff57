"""The limit of a measure as the cells shrink: its order, its value and an interval, from the values on a few cells.

A power law is fitted by least squares, and its error made an interval by a factor of safety: Eca & Hoekstra, J. Comput.
Phys. 262 (2014) 104-130. On clean values that is the Grid Convergence Index (Roache 1994; Celik et al., J. Fluids Eng.
130 (2008) 078001). docs/converge.md says what the interval is worth.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]
Kind = Literal["same", "converges", "limited", "assumed", "unknown"]
LEAST_ORDER, LARGEST_ORDER = (
    0.5,
    2.0,
)  # beyond them a fitted order is not believed (Oberkampf & Roy 2010, 8.6)
FIRST_ORDER = 1.0
SAFETY, DOUBTFUL_SAFETY = 1.25, 3.0  # factors on the error of a fit (Roache 1994)
SPREAD_SAFETY = 3.0  # factor on the range of values that do not converge (Eca & Hoekstra 2006)
COVERAGE = 2.0  # standard uncertainties of a reading in an interval of 95 %
ORDERS = np.linspace(-4.0, 8.0, 121)  # among which the fitted one is looked for


@dataclass(frozen=True)
class Limit:
    """What a measure tends to, in its unit.

    `kind` says how it is known: "converges" by the fitted order; "limited" by the nearest one that is believed, for
    the fitted one is not; "assumed" by first order, for there are two cells; "same" by values that do not differ.
    "unknown" says that the values grow apart, or scatter more than they change: `value` is then that on the finest
    cell. `observed` is the fitted order, `order` the one that is taken, None where there is none. `uncertainty` is half
    of an interval of 95 %, `slope` the error on a cell of 1 m. `turns` says whether the values both rise and fall.
    """

    kind: Kind
    value: float
    uncertainty: float
    observed: float | None = None
    order: float | None = None
    slope: float = 0.0
    turns: bool = False

    @property
    def is_known(self) -> bool:
        """Return whether the values tend to something."""
        return self.kind != "unknown"

    def at(self, cells: Array) -> Array:
        """Return the fitted values on cells (n,), m."""
        return self.value + self.slope * cells ** (self.order or 0.0)


def limit_of(cells: Sequence[float], values: Sequence[float], readings: Sequence[float]) -> Limit:
    """Return what a measure tends to, from its values on two cells (m) or more.

    `readings` are the standard uncertainties with which the values were read. Raises ValueError for fewer than two
    cells that differ.
    """
    if len(set(cells)) < 2:
        raise ValueError("two different cells are needed at least")
    from_finest = np.argsort(cells)
    h, f, u = (np.asarray(column, dtype=float)[from_finest] for column in (cells, values, readings))
    if float(np.ptp(f)) <= 1e-12 * float(np.abs(f).max()):
        return Limit("same", float(f[0]), COVERAGE * float(u[0]))
    if len(f) == 2:
        limit, observed = _fitted("assumed", None, FIRST_ORDER, h, f, u), FIRST_ORDER
    else:
        observed = _observed_order(h, f)
        order = min(max(observed, LEAST_ORDER), LARGEST_ORDER)
        kind: Kind = "converges" if order == observed else "limited"
        limit = _fitted(kind, observed, order, h, f, u) if observed > 0 else None
    return limit or _by_spread(observed, f, u)


def _fitted(kind: Kind, observed: float | None, order: float, h: Array, f: Array, u: Array) -> Limit | None:
    """Return the limit by an order, from cells (m, finest first), values and uncertainties of reading (n,).

    None if the values scatter about the fit no less than they change from cell to cell.
    """
    columns = np.stack([np.ones_like(h), h**order], axis=1)
    value, slope = np.linalg.pinv(columns) @ f
    off = f - columns @ (value, slope)
    if kind == "converges":  # a reading moves the order, too
        columns = np.column_stack([columns, slope * h**order * np.log(h / h[0])])
    scatter = math.sqrt(float(off @ off) / max(1, len(f) - columns.shape[1]))
    if scatter >= float(np.ptp(f)) / (len(f) - 1):
        return None
    safety = SAFETY if kind == "converges" else DOUBTFUL_SAFETY
    width = safety * abs(slope) * h[0] ** order + scatter + abs(off[0])
    # Row 0 of the inverse is how much the limit moves with each value.
    reading = COVERAGE * float(np.linalg.norm(np.linalg.pinv(columns)[0] * u))
    around = math.hypot(float(width), reading)
    return Limit(kind, float(value), around, observed, order, float(slope), _turns(f))


def _by_spread(observed: float, f: Array, u: Array) -> Limit:
    """Return that the limit is not known, with an interval by the range of the values (n,), finest cell first."""
    around = math.hypot(SPREAD_SAFETY * float(np.ptp(f)), COVERAGE * float(u[0]))
    return Limit("unknown", float(f[0]), around, observed, turns=_turns(f))


def _turns(f: Array) -> bool:
    """Return whether values (n,) both rise and fall."""
    change = np.diff(f)
    return bool((change > 0).any() and (change < 0).any())


def _observed_order(h: Array, f: Array) -> float:
    """Return the order p with which f0 + a h^p fits best. It is negative where values grow apart."""
    size, centred = np.log(h / h[0]), f - f.mean()

    def residual(order: float) -> float:
        # (h^p - 1)/p, for it goes over into the logarithm at order 0.
        power = size if abs(order) < 1e-9 else np.expm1(order * size) / order
        power = power - power.mean()
        off = centred - power * (power @ centred) / (power @ power)
        return float(off @ off)

    best = int(np.argmin([residual(order) for order in ORDERS]))
    around = ORDERS[max(0, best - 1)], ORDERS[min(len(ORDERS) - 1, best + 1)]
    return float(minimize_scalar(residual, bounds=around, method="bounded", options={"xatol": 1e-10}).x)
