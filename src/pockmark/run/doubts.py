"""The doubts of a run: states that no material can be in, and energy that is lost or won."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..base.counters import DOUBTFUL
from ..base.lengths import unit_for
from .simulation import Simulation

LEDGER_LIMIT = 0.01  # share of the initial energy: a larger ledger error is doubtful


class Place(NamedTuple):
    """The points that were in an impossible state at a time (s): how many, and a box around them.

    `lower` and `upper` are the corners of the box, m.
    """

    points: int
    time: float
    lower: list[float]
    upper: list[float]


class Doubts:
    """The doubts of a run, gathered with each row of its history.

    They are where its impossible states are, and how large its ledger error is.
    """

    def __init__(self) -> None:
        """Begin without a doubt."""
        self._places: dict[str, Place] = {}
        self._error, self._when = 0.0, 0.0
        self._counted: dict[str, int] = {}

    def note(self, simulation: Simulation, row: Mapping[str, float]) -> None:
        """Note a row of the history, and the points where one of its counters has grown."""
        counted = {name: int(row[name]) for name in DOUBTFUL}
        if counted != self._counted:
            for name, (points, lower, upper) in simulation.impossible().items():
                if name not in self._places or points > self._places[name].points:
                    self._places[name] = Place(points, simulation.time, lower, upper)
        self._counted = counted
        error = abs(row["error"]) / row["initial"] if row["initial"] != 0 else 0.0
        if not (error <= self._error or math.isnan(self._error)):  # nan counts, and stays
            self._error, self._when = error, simulation.time

    def state(self) -> dict[str, Any]:
        """Return what has been noted, as JSON can hold it."""
        return {
            "places": {name: [*place] for name, place in self._places.items()},
            "error": self._error,
            "when": self._when,
            "counted": self._counted,
        }

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Take up what state() returned before."""
        self._places = {name: Place(*place) for name, place in state["places"].items()}
        self._error, self._when = state["error"], state["when"]
        self._counted = dict(state["counted"])

    def sentences(self) -> list[str]:
        """Return why the run is doubtful, in a sentence each; an empty list if it is not."""
        return doubts(self._counted, self._error, self._when, self._places)


def doubts(
    counters: Mapping[str, int], error: float, when: float, places: Mapping[str, Place] | None = None
) -> list[str]:
    """Return why a run is doubtful, in a sentence each; an empty list if it is not.

    `error` is the run's largest ledger error as a share of the initial energy, `when` its time, s. `places` has for
    each counter where its points were, if that is known.
    """
    out = []
    for name, what in DOUBTFUL.items():
        if not (count := counters.get(name, 0)):
            continue
        if place := (places or {}).get(name):
            unit, size = unit_for(*place.lower, *place.upper)
            box = ", ".join(
                f"{axis} {lower / size:.4g} to {upper / size:.4g}"
                for axis, lower, upper in zip("xyz", place.lower, place.upper, strict=True)
            )
            here = f"{place.points:,} points at {place.time * 1e9:.4g} ns, within {box} {unit}; "
            out.append(f"points {what}: {here}{count:,} times in all ({name})")
        else:
            out.append(f"points {what}: {count:,} times in all ({name})")
    if not error <= LEDGER_LIMIT:
        out.append(
            f"the energies do not add up: off by {error:.3g} of the initial one at {when * 1e9:.4g} ns"
        )
    return out
