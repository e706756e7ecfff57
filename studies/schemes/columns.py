"""What is measured of each scheme: a column is a function of a scheme and the conditions that it is asked for."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import bar
import cost
import disk
import impacts
import shock

Condition = Mapping[str, str | float]  # the arguments of the column's function


@dataclass(frozen=True)
class Column:
    """A measure, and its conditions: those of the table, those of its quick form, those that take hours."""

    title: str
    measure: Callable[..., dict[str, float]]
    conditions: Sequence[Condition]
    quick: Sequence[Condition] = field(default=())
    fine: Sequence[Condition] = field(default=())
    keeps_runs: bool = False  # whether the function wants to know the folder of the runs


def _each(**values: Sequence[str | float]) -> list[Condition]:
    """Return every combination of the values, the last one fastest."""
    return [dict(zip(values, of, strict=True)) for of in itertools.product(*values.values())]


COLUMNS = {
    "shock": Column(
        "A plane shock in three frames (`shock.py`): pressure over Rankine-Hugoniot's, and its scatter",
        shock.measure,
        _each(
            points=[1, 2, 4],
            speed_m_s=[400.0, 600.0, 800.0, 1000.0, 1400.0, 2200.0, 4500.0],
            at_rest=list(shock.FRAMES),
        ),
        quick=_each(points=[2], speed_m_s=[1000.0], at_rest=["none", "target"], way=[60]),
    ),
    "disk": Column(
        "A spinning elastic disk (`disk.py`): changes of angular momentum, kinetic energy, radius",
        disk.measure,
        _each(radius_cells=[4, 8, 16], turns=[10]),
        quick=_each(radius_cells=[4], turns=[1]),
    ),
    "bar": Column(
        "A vibrating elastic bar (`bar.py`): change of its mechanical energy, and how far its period is off",
        bar.measure,
        _each(cells=[8, 16, 32], periods=[100]),
        quick=_each(cells=[8], periods=[5]),
    ),
    "crater": Column(
        "The impact of Table 2 in a small target, a quarter of the model (`impacts.py`)",
        impacts.single_ball,
        _each(cell_um=[4, 3], half_um=[60], end_ns=[150]),
        quick=_each(cell_um=[5], half_um=[40], end_ns=[20]),
        fine=[
            {"cell_um": 2, "half_um": 60, "end_ns": 150},
            {"cell_um": 1, "half_um": 60, "end_ns": 150, "precision": "single"},
        ],
        keeps_runs=True,
    ),
    "settled": Column(
        "The same in the whole target, when it has settled",
        impacts.single_ball,
        _each(cell_um=[4], half_um=[100], end_ns=[500]),
        keeps_runs=True,
    ),
    "group": Column(
        "The group of Table 3 at 4.5 km/s, a quarter of the model, 500 ns",
        impacts.group,
        _each(cell_um=[4]),
        fine=[{"cell_um": 3}],
        keeps_runs=True,
    ),
    "cost": Column(
        "The time of a step, on one thread (`cost.py`)", cost.measure, _each(points=[60_000], turns=[7])
    ),
}


def label(condition: Condition) -> str:
    """Return a condition in words: "points 2, speed_m_s 1000"."""
    return ", ".join(
        f"{key} {value:g}" if isinstance(value, float | int) else f"{key} {value}"
        for key, value in condition.items()
    )
