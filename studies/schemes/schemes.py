"""The numerical schemes that are compared: each is what it changes in the table [numerics] of a scene."""

from collections.abc import Mapping

from pockmark import Scene

Changes = Mapping[str, str | float]  # "volumetric_strain": "cells"

# Every key is written out, so that a line stays the same scheme when a default changes.
TRILINEAR: Changes = {
    "scheme": "usavg",
    "shape_functions": "trilinear",
    "volumetric_strain": "points",
    "node_velocity": "mean",
    "pic_fraction": 0.0,
    "filter.interval": 0,
}
CELLS = {**TRILINEAR, "volumetric_strain": "cells"}
PIC = {**TRILINEAR, "pic_fraction": 0.02}
QUADRATIC = {**TRILINEAR, "shape_functions": "quadratic"}
VELOCITY_FILTER: Changes = {"filter.interval": 20, "filter.order": 3, "filter.pressure": 0.0}
PRESSURE_FILTER: Changes = {"filter.interval": 20, "filter.order": 0, "filter.pressure": 0.5}
BOTH_FILTERS: Changes = {"filter.interval": 20, "filter.order": 3, "filter.pressure": 0.5}

SCHEMES: dict[str, Changes] = {
    "paper": {**TRILINEAR, "scheme": "usf"},
    "trilinear": TRILINEAR,
    "pic": PIC,
    "cells": CELLS,
    "quadratic": QUADRATIC,
    "quadratic-cells": {**QUADRATIC, "volumetric_strain": "cells"},
    "cells-velocity-filter": {**CELLS, **VELOCITY_FILTER},
    "cells-pressure-filter": {**CELLS, **PRESSURE_FILTER},
    "cells-both-filters": {**CELLS, **BOTH_FILTERS},
    "trilinear-both-filters": {**TRILINEAR, **BOTH_FILTERS},
    "cells-linear": {**CELLS, "node_velocity": "linear"},
    "cells-linear-both-filters": {**CELLS, **BOTH_FILTERS, "node_velocity": "linear"},
    "quadratic-cells-both-filters": {**QUADRATIC, "volumetric_strain": "cells", **BOTH_FILTERS},
}


def overrides(changes: Changes) -> list[str]:
    """Return the changes as texts that `--set` takes."""
    return [f"numerics.{key}={value}" for key, value in changes.items()]


def scene_of(table: Mapping[str, object], changes: Changes) -> Scene:
    """Return a scene with a scheme. Raises PockmarkError, also for a key that this version does not know."""
    return Scene.from_dict(table, overrides=overrides(changes))
