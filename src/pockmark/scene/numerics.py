"""The method of a scene, contact, and how often its run writes."""

from typing import Annotated, Literal

from pydantic import Field

from ..base.units import Number, Time, quantity
from .model import Model


class Contact(Model):
    """The contact of the projectiles with all other bodies. Without it, bodies that share a node stick together."""

    friction: Annotated[Number, Field(ge=0, le=10)]


class Numerics(Model):
    """The numerical method. studies/README.md compares its variants."""

    scheme: Literal["usf", "musl", "usl", "usavg"] = "usavg"
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    volumetric_strain: Literal["points", "cells"] = "points"
    cfl: Annotated[Number, Field(gt=0, le=1)] = 0.5
    strain_limit: Annotated[Number, Field(gt=0, le=1)] = 0.2
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] = 0.0
    filter_interval: Annotated[int, Field(ge=0, le=10_000)] = 0
    filter_order: Annotated[int, Field(ge=0, le=16)] = 3
    pressure_filter: Annotated[Number, Field(ge=0, le=1)] = 0.5
    mass_cutoff: Annotated[Number, Field(ge=0, le=1)] = 0.0
    precision: Literal["double", "single"] = "double"


class Output(Model):
    """How often a run writes.

    Between snapshots and between rows of the history lies simulated time, s. A snapshot's time is hit exactly; a row
    is written with the first step at or beyond its time. Between checkpoints lies wall time, s, so they change
    nothing that is computed; 0 means no checkpoint at all.
    """

    snapshots: Annotated[Time, Field(gt=0)] = 1e-7
    history: Annotated[Time, Field(gt=0)] = 2e-9
    checkpoints: Annotated[float, quantity("s", 0.0, 1e7)] = 300.0
