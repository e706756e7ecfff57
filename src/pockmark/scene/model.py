"""The base of every table of a scene."""

from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """A strict, immutable table: unknown keys are errors. The docstring of a key says what it means (keys.py)."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


@dataclass(frozen=True)
class Hint:
    """What a reader is told of a key that its type does not say.

    `advice` is the value to begin with, `allowed` what a check in code allows.
    """

    advice: str = ""
    allowed: str = ""
