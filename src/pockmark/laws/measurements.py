"""Measured craters to compare with, and what kind and how hard the library's materials are.

measurements.csv and hardness.csv have them, each row with its source.
"""

import csv
import math
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import NamedTuple


class Measurement(NamedTuple):
    """A measured crater, SI.

    `quantity` is a key of a run's crater: its measured value lies from `low` to `high`. `projectile` and `target` are
    kinds of material. A projectile that is not known is an empty text, its diameter (m) and speed (m/s) None.
    """

    quantity: str
    projectile: str
    target: str
    diameter: float | None
    speed: float | None
    low: float
    high: float
    note: str
    source: str

    def distance(self, diameter: float, speed: float) -> float:
        """Return how far an impact is, in the logarithms of diameter and speed; inf where these are not known."""
        if not self.diameter or not self.speed:
            return math.inf
        return math.hypot(math.log(diameter / self.diameter), math.log(speed / self.speed))


class Hardness(NamedTuple):
    """The kind of a material of the library, and its Brinell hardness (kgf/mm^2), None if it is not known."""

    kind: str
    brinell: float | None
    source: str


@cache
def measurements() -> tuple[Measurement, ...]:
    """Return all measured craters."""
    return tuple(
        Measurement(
            row["quantity"],
            row["projectile"],
            row["target"],
            _number(row["diameter"]),
            _number(row["speed"]),
            float(row["low"]),
            float(row["high"]),
            row["note"],
            row["source"],
        )
        for row in _rows("measurements.csv")
    )


@cache
def hardness() -> dict[str, Hardness]:
    """Return kind and hardness of the library's materials, by name."""
    return {
        row["material"]: Hardness(row["kind"], _number(row["brinell"]), row["source"])
        for row in _rows("hardness.csv")
    }


def near(
    quantity: str, projectile: str, target: str, *, diameter: float, speed: float
) -> tuple[Measurement, ...]:
    """Return what is measured of a quantity for a pair of kinds: the nearest impact, then those of unknown projectiles.

    `diameter` is in m, `speed` in m/s, both more than 0.
    """
    same = [m for m in measurements() if (m.quantity, m.target) == (quantity, target)]
    known = [m for m in same if m.projectile == projectile]
    nearest = sorted(known, key=lambda m: m.distance(diameter, speed))[:1]
    return (*nearest, *(m for m in same if not m.projectile))


def _rows(name: str) -> Iterator[dict[str, str]]:
    """Give the rows of a table of this room."""
    yield from csv.DictReader(files(__package__).joinpath(name).read_text(encoding="utf-8").splitlines())


def _number(text: str) -> float | None:
    """Return a number; None for an empty text."""
    return float(text) if text else None
