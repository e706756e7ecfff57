"""A run's results as numbers with stable keys, SI."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .crater import Crater, measure_crater, target_surface
from .scene import Mirror


def crater_of(
    snapshot: Mapping[str, NDArray[Any]],
    *,
    target_bodies: Sequence[int],
    spacing: float,
    mirrors: Sequence[Mirror],
) -> Crater | None:
    """The crater in a snapshot of all points; None if there is none."""
    is_target = np.isin(snapshot["body"], target_bodies)
    surface = target_surface(
        snapshot["position"][is_target], snapshot["volume"][is_target], spacing, mirrors=mirrors
    )
    return measure_crater(surface, spacing=spacing)


def result_table(
    crater: Crater | None,
    projectile_diameter: float,
    ledger: Mapping[str, float],
    run: Mapping[str, Any],
    counters: Mapping[str, int],
) -> dict[str, Any]:
    """Nested results. Energies are shares of the initial kinetic energy; E_i^r counts the points that left as they left."""
    depth, diameter = (crater.depth, crater.diameter) if crater else (None, None)
    initial = ledger["initial"] or 1.0
    return {
        "crater": {
            "depth": depth,
            "diameter": diameter,
            "volume": crater.volume if crater else None,
            "depth_over_projectile_diameter": depth / projectile_diameter
            if depth and projectile_diameter
            else None,
            "depth_over_diameter": depth / diameter if depth and diameter else None,
        },
        "energy": {
            "residual_internal": (ledger["internal"] + ledger["left_internal"]) / initial,
            "internal": ledger["internal"] / initial,
            "kinetic": ledger["kinetic"] / initial,
            "absorbed": ledger["absorbed"] / initial,
            "left": ledger["left_energy"] / initial,
            "viscous": ledger["viscous"] / initial,
            "ledger_error": ledger["error"] / initial,
        },
        "run": dict(run),
        "counters": dict(counters),
    }
