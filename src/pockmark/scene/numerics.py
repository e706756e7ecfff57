"""The method of a scene, contact, and how often its run writes."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..base.units import Number, Time, quantity
from .model import Model


class Contact(Model):
    """The contact of the projectiles with all other bodies. Without it, bodies that share a node stick together."""

    friction: Annotated[Number, Field(ge=0, le=10)]


class Filter(Model):
    """The filter of what the points have and the nodes cannot see: motion and pressure (docs/theory.md, Filters).

    `interval` counts the steps from one filtering to the next; 0 means none. `order` is that of the velocity's filter,
    `pressure` the share of the unseen pressure that relaxes each time; 0 leaves the one or the other alone.
    """

    interval: Annotated[int, Field(ge=0, le=10_000)] = 10
    order: Annotated[int, Field(ge=0, le=16)] = 2
    pressure: Annotated[Number, Field(ge=0, le=1)] = 0.5

    @model_validator(mode="after")
    def _acts(self) -> "Filter":
        if self.interval > 0 and self.order == 0 and self.pressure == 0:
            raise ValueError(
                "found order = 0 and pressure = 0, expected one of them above 0: this filter does nothing"
            )
        return self


# What the scheme "paper" stands for: the method with which the paper's tables are reproduced.
PAPER: dict[str, Any] = {
    "scheme": "usavg",
    "shape_functions": "trilinear",
    "volumetric_strain": "points",
    "node_velocity": "mean",
    "filter": {"interval": 0},
}


# The defaults that a choice brings with it, because it does not go with those of all others.
BROUGHT = {
    ("shape_functions", "quadratic"): {"node_velocity": "mean"},
    ("scheme", "usl"): {"volumetric_strain": "points"},
}


class Numerics(Model):
    """The numerical method. studies/README.md compares its variants."""

    scheme: Literal["usf", "musl", "usl", "usavg", "paper"] = "usavg"
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    volumetric_strain: Literal["points", "cells"] = "cells"
    node_velocity: Literal["mean", "linear"] = "linear"
    cfl: Annotated[Number, Field(gt=0, le=1)] = 0.5
    strain_limit: Annotated[Number, Field(gt=0, le=1)] = 0.2
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] = 0.0
    filter: Filter = Filter()
    mass_cutoff: Annotated[Number, Field(ge=0, le=1)] = 0.0
    precision: Literal["double", "single"] = "double"

    @model_validator(mode="before")
    @classmethod
    def _spell_out(cls, table: Any) -> Any:
        """Return the table with what its choices bring, and what the scheme "paper" stands for; what is written counts."""
        if not isinstance(table, Mapping):
            return table
        if table.get("scheme") == "paper":
            written = {key: value for key, value in table.items() if key != "scheme"}
            if isinstance(written.get("filter"), Mapping):
                written["filter"] = {**PAPER["filter"], **written["filter"]}
            return {**PAPER, **written}
        brought: dict[str, str] = {}
        for (key, value), more in BROUGHT.items():
            if table.get(key) == value:
                brought |= more
        return {**brought, **table}


class Output(Model):
    """How often a run writes.

    Between snapshots and between rows of the history lies simulated time, s. A snapshot's time is hit exactly; a row
    is written with the first step at or beyond its time. Between checkpoints lies wall time, s, so they change
    nothing that is computed; 0 means no checkpoint at all.
    """

    snapshots: Annotated[Time, Field(gt=0)] = 1e-7
    history: Annotated[Time, Field(gt=0)] = 2e-9
    checkpoints: Annotated[float, quantity("s", 0.0, 1e7)] = 300.0
