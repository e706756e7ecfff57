"""The method of a scene, contact, and how often its run writes."""

from typing import Annotated, Literal

from pydantic import Field

from ..base.units import Number, Time, quantity
from .model import Model


class Contact(Model):
    """Contact of the projectile bodies with all others; without it what shares a node sticks together."""

    friction: Annotated[Number, Field(ge=0, le=10)]


class Numerics(Model):
    """The method. The defaults are the ones compared in studies/README.md."""

    scheme: Literal["usf", "musl", "usl", "usavg"] = "usavg"
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    cfl: Annotated[Number, Field(gt=0, le=1)] = 0.5
    strain_limit: Annotated[Number, Field(gt=0, le=1)] = 0.2
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] = 0.0
    mass_cutoff: Annotated[Number, Field(ge=0, le=1)] = 0.0
    precision: Literal["double", "single"] = "double"


class Output(Model):
    """How often a run writes: time between snapshots, hit exactly, and between rows of the history, written with the first step at or beyond.

    Between checkpoints lies wall time, so they change nothing that is computed; 0 for none at all.
    """

    snapshots: Annotated[Time, Field(gt=0)] = 1e-7
    history: Annotated[Time, Field(gt=0)] = 2e-9
    checkpoints: Annotated[float, quantity("s", 0.0, 1e7)] = 300.0
