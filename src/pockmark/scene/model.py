"""The base of every table of a scene."""

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """A strict, immutable table: unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)
