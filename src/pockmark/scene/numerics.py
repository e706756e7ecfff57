"""The method of a scene, contact, and how often its run writes."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..base.units import Number, Quantity, Time
from .model import Hint, Model


class Contact(Model):
    """The contact of the projectiles with all other bodies. Without it, bodies that share a node stick together."""

    friction: Annotated[Number, Field(ge=0, le=10)]
    """Coulomb's coefficient of friction between the projectiles and all other bodies. Without [contact] they stick."""


class Filter(Model):
    """The filter of what the points have and the nodes cannot see: motion and pressure (docs/theory.md, Filters).

    What it takes becomes heat.
    """

    interval: Annotated[int, Field(ge=0, le=10_000), Hint("10")] = 10
    """Steps from one filtering to the next; 0 filters never."""
    order: Annotated[int, Field(ge=0, le=16)] = 2
    """Order of the velocity's filter; 0 leaves the velocity alone."""
    pressure: Annotated[Number, Field(ge=0, le=1)] = 0.5
    """Share of the unseen pressure that relaxes each time; 0 leaves the pressure alone."""

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

    scheme: Annotated[
        Literal["usf", "musl", "usl", "usavg", "paper"], Hint('"usavg", whose energies add up')
    ] = "usavg"
    """When a step updates the stress; "paper" is usavg with what the paper's tables are made with."""
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    """How points and nodes see each other; "quadratic" takes more time a step, and node_velocity "mean" with it."""
    volumetric_strain: Annotated[Literal["points", "cells"], Hint('"cells"')] = "cells"
    """Where the change of volume comes from; by "points", as in the paper, a plane shock depends on the frame."""
    node_velocity: Annotated[Literal["mean", "linear"], Hint('"linear"')] = "linear"
    """What nodes get of the points' velocity; "mean", as in the paper, lets the crater move with the cell and brakes what spins."""
    cfl: Annotated[Number, Field(gt=0, le=1), Hint("0.5")] = 0.5
    """Step over the time in which a wave crosses a cell."""
    strain_limit: Annotated[Number, Field(gt=0, le=1), Hint("0.2")] = 0.2
    """Largest strain increment of a step; shorter steps keep it."""
    pic_fraction: Annotated[Number, Field(ge=0, le=1), Hint("0: any share of it brakes what spins")] = 0.0
    """Share of PIC in the points' velocity; the rest is FLIP."""
    filter: Filter = Filter()
    mass_cutoff: Annotated[Number, Field(ge=0, le=1), Hint("0: then the energies add up")] = 0.0
    """Nodes with less than this share of the mass of a full cell get no velocity."""
    precision: Annotated[Literal["double", "single"], Hint('"double"')] = "double"
    """Numbers in which points and nodes are kept."""

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

    snapshots: Annotated[Time, Field(gt=0), Hint("a fifth of end_time")] = 1e-7
    """Simulated time between two snapshots."""
    history: Annotated[Time, Field(gt=0), Hint("a hundredth of end_time, or less")] = 2e-9
    """Simulated time between two rows of history.csv."""
    checkpoints: Annotated[float, Quantity("s", 0.0, 1e7), Hint("300 s")] = 300.0
    """Wall time between two checkpoints, from which a stopped run goes on; 0 writes none."""
