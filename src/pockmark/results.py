"""A run's results as numbers with stable keys, SI."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .crater import Crater, measure_crater, target_surface
from .scene import Mirror

SHARES = ("internal", "kinetic", "absorbed", "left_kinetic", "left_internal", "pic", "viscous")


def crater_of(
    snapshot: Mapping[str, NDArray[Any]],
    *,
    target_bodies: Sequence[int],
    spacing: float,
    mirrors: Sequence[Mirror],
) -> Crater | None:
    """The crater in a snapshot of all points; None if there is none, or the points are no longer anywhere."""
    is_target = np.isin(snapshot["body"], target_bodies)
    if not is_target.any() or not np.isfinite(snapshot["position"][is_target]).all():
        return None
    surface = target_surface(
        snapshot["position"][is_target], snapshot["volume"][is_target], spacing, mirrors=mirrors
    )
    return measure_crater(surface, spacing=spacing)


def result_table(
    crater: Crater | None,
    crater_time: float | None,
    projectile_diameter: float,
    ledger: Mapping[str, float],
    run: Mapping[str, Any],
    counters: Mapping[str, int],
) -> dict[str, Any]:
    """Nested results. Energies are shares of the initial kinetic energy, None where that is zero; E_i^r counts the
    points that left as they left. internal + kinetic + absorbed + left + pic = 1 + ledger_error."""
    depth, diameter = (crater.depth, crater.diameter) if crater else (None, None)
    initial = ledger["initial"]
    joules = {key: ledger[key] for key in SHARES} | {
        "residual_internal": ledger["internal"] + ledger["left_internal"],
        "left": ledger["left_kinetic"] + ledger["left_internal"],
        "ledger_error": ledger["error"],
    }
    return {
        "crater": {
            "depth": depth,
            "diameter": diameter,
            "volume": crater.volume if crater else None,
            "depth_over_projectile_diameter": _ratio(depth, projectile_diameter),
            "depth_over_diameter": _ratio(depth, diameter),
            "time": crater_time,
        },
        "energy": {key: _ratio(value, initial) for key, value in joules.items()},
        "run": dict(run),
        "counters": dict(counters),
    }


def _ratio(value: float | None, of: float | None) -> float | None:
    return value / of if value is not None and of else None
