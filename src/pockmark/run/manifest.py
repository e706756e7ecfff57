"""The names, types and ranges in manifest.json.

They are checked before anything is measured.
"""

import json
import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ..base.counters import COUNTERS, GONE
from ..base.errors import PockmarkError
from ..base.ledger import LEDGER
from ..scene.sentences import sentence

Status = Literal["running", "finished", "interrupted", "failed"]
Count = Annotated[int, Field(ge=0, lt=2**63)]
Positive = Annotated[float, Field(ge=0)]
Text = Annotated[str, Field(max_length=200)]
Table = TypeVar("Table", bound="_Part")


class _Part(BaseModel):
    """A table of a manifest. Keys from which nothing is measured may be anything."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False, extra="allow", frozen=True)


class Run(_Part):
    """How far a run is: points at the start, cells, steps, time (s).

    Particle-steps a second and the largest rho/rho0 are None if they are not known.
    """

    points: Count
    cells: Count
    steps: Count
    time: Annotated[float, Field(ge=0, le=1e4)]  # no scene may ask for more
    particle_steps_per_second: Positive | None
    max_compression: float | None


class Measured(_Part):
    """The parts of a manifest that are measured; None in the ledger stands for what is no number."""

    run: Run
    ledger: dict[Text, float | None]
    counters: dict[Text, Count]
    doubts: list[Annotated[str, Field(max_length=1000)]] | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if missing := sorted(LEDGER.keys() - self.ledger.keys()):
            raise ValueError(f"ledger.{missing[0]}: is missing")
        return self

    @property
    def joules(self) -> dict[str, float]:
        """Return the ledger, with nan for what is no number."""
        return {key: math.nan if value is None else value for key, value in self.ledger.items()}


class Manifest(_Part):
    """The parts that every manifest has.

    `physics` is missing from the manifests of before it was counted.
    """

    status: Status
    scene_hash: Text
    pockmark: Text | None = None
    commit: Text | None = None
    physics: Count | None = None
    next_scene_hash: Text | None = None
    earlier_scene_hashes: list[Text] = []


def parse_manifest(text: str) -> dict[str, Any]:
    """Return the table of a manifest's text. Raises PockmarkError for what is no manifest of pockmark's."""
    try:
        table = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise PockmarkError(f"is not JSON ({str(error)[:100]})") from None
    if not isinstance(table, dict):
        raise PockmarkError("found no table, expected a manifest of pockmark's")
    if "scene_hash" not in table:
        raise PockmarkError("is not a manifest of pockmark's (it has no scene_hash)")
    validated(Manifest, table)
    return table


def row_as_record(row: Mapping[str, float], cells: int) -> dict[str, Any]:
    """Return a row of the history as the end of a manifest would have it, for `Measured` to check.

    `cells` is the number of cells of the grid.
    """
    counters = {name: _count(row[name]) for name in COUNTERS if name in row}
    gone = (row.get(name, 0.0) for name in GONE)
    return {
        "run": {
            "points": _count(row.get("points", math.nan) + sum(gone)),
            "cells": cells,
            "steps": _count(row.get("step", math.nan)),
            "time": row.get("time"),
            "particle_steps_per_second": None,
            "max_compression": _number(row.get("max_compression", math.nan)),
        },
        "ledger": {name: _number(row[name]) for name in LEDGER if name in row},
        "counters": counters,
    }


def _count(value: float) -> int | float:
    """Return a whole number as an int: the history has all numbers as floats."""
    return int(value) if value.is_integer() else value


def _number(value: float) -> float | None:
    """Return a finite number; None for another."""
    return value if math.isfinite(value) else None


def validated(model: type[Table], table: Any) -> Table:
    """Return a table as a model. Raises PockmarkError with one sentence."""
    try:
        return model.model_validate(table)
    except ValidationError as error:
        raise PockmarkError(sentence(error, model)) from None
