"""All measures of one state of a run, as nested tables with stable keys, SI."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.geometry import Setup
from . import cautions, results
from .morphology import group_of
from .surface import Filling, Surface

# From absurd values a measure makes no number, which is null in the table. NumPy need not warn of it.
UNWARNED = np.errstate(all="ignore")
History = Mapping[str, NDArray[np.float64]]


def measures(
    snapshot: Mapping[str, NDArray[Any]],
    setup: Setup,
    ledger: Mapping[str, float],
    run: Mapping[str, Any],
    counters: Mapping[str, int],
    history: History,
) -> dict[str, Any]:
    """Return the tables of a state in a snapshot: crater, energy, run, counters, ejecta, warnings.

    A swarm has a table `group`, too. `ledger`, `run` and `counters` are those of the same state, `history` the
    columns up to it.
    """
    filling = results.filling_of(snapshot, setup)
    surface = surface_of(filling)
    crater = results.crater_of(surface, setup.heading)
    hole = results.hole_of(surface)
    is_open = surface is not None and bool(surface.holes.any())
    table = results.result_table(crater, float(snapshot["time"][0]), setup, ledger, run, counters)
    table["crater"] |= results.morphology_table(snapshot, filling, crater, setup)
    no_wall = [*cautions.missing(snapshot, setup)]
    is_told = not no_wall and (hole is not None or not is_open)
    table["crater"] |= results.hole_table(filling, hole) if is_told else dict.fromkeys(results.HOLE)
    change = table["crater"]["depth_change_last_tenth"] = _late_change(history)
    if group := group_of(surface, setup):
        table["group"] = results.group_table(group, setup)
    table["ejecta"] = results.ejecta_table(snapshot, ledger, setup, has_crater=crater is not None)
    table["warnings"] = [
        *(no_wall or cautions.of_nothing(crater, surface, setup, float(snapshot["time"][0]))),
        *cautions.of_hole(hole, surface, setup),
        *cautions.of_crater(crater, surface, setup),
        *cautions.of_other_walls(setup),
        *cautions.of_resolution(setup, crater, change),
    ]
    worst = worst_error(history)
    table["energy"]["ledger_error_max"] = None if worst is None else worst[0]
    return table


def surface_of(filling: Filling | None) -> Surface | None:
    """Return the surface of a filling; None where there is no filling."""
    return None if filling is None else filling.surface()


def worst_error(history: History) -> tuple[float, float | None] | None:
    """Return the largest ledger error of a history, as a share of the initial energy, and its time, s.

    The time is None if the history has none. All is None if there is no initial energy.
    """
    if not {"error", "initial"} <= history.keys():
        return None
    initial = history["initial"]
    if not len(initial) or not initial[0] > 0:
        return None
    error = np.abs(history["error"]) / initial[0]
    worst = int(np.argmax(error))
    return float(error[worst]), float(history["time"][worst]) if "time" in history else None


def _late_change(history: History) -> float | None:
    """Return how much the depth changed in the last tenth of a history, as a share.

    None if the history lacks the time or the depth.
    """
    if not {"time", "depth"} <= history.keys():
        return None
    return results.depth_change(history["time"], history["depth"])
