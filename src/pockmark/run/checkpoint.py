"""Checkpoints: all that a run needs to go on, in a file with check sums and a version."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .. import PHYSICS
from ..base.errors import PockmarkError
from .hdf5 import checked, opened, put, written

DAMAGED = "is no whole checkpoint"
FORMAT = 1  # version of what is written here


class ForeignError(PockmarkError):
    """An error for a checkpoint that is whole, but not for this run or this pockmark."""


@dataclass(frozen=True)
class Checkpoint:
    """The state of a run, and how far its folder was.

    `time` is in s. `course` is the hash of the scene without its end. `acted` has how often each task had acted,
    `tasks` their states, `files` what `extent_of` gave, `parts` what `Simulation.save` gave.
    """

    step: int
    time: float
    course: str
    acted: list[int]
    tasks: list[dict[str, Any]]
    files: dict[str, Any]
    core: str
    parts: Mapping[str, Any] = field(repr=False)


_TOLD = tuple(part.name for part in fields(Checkpoint) if part.name != "parts")


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint in one go. Raises PockmarkError, and then there is no file of this name."""
    arrays = {name: part for name, part in checkpoint.parts.items() if isinstance(part, np.ndarray)}
    about = {name: getattr(checkpoint, name) for name in _TOLD} | {
        "physics": PHYSICS,
        "arrays": [*arrays],
        "numbers": {name: part for name, part in checkpoint.parts.items() if name not in arrays},
    }
    with written(path) as file:
        file.attrs["format"] = FORMAT
        put(file, "about", np.frombuffer(json.dumps(about).encode(), dtype=np.uint8))
        group = file.create_group("parts")
        for n, part in enumerate(arrays.values()):
            put(group, str(n), part)


def read_checkpoint(path: Path) -> Checkpoint:
    """Return a checkpoint whose bytes are all as they were written.

    Its arrays are read again, one by one, when they are asked for. Raises ForeignError for one of another format or
    physics, PockmarkError for one that is torn or altered.
    """
    with opened(path, DAMAGED) as (file, size):
        about = _about(file, size)
        for n, _ in enumerate(about["arrays"]):
            checked(file, f"parts/{n}", size)
        parts = _Parts(path, about["arrays"], about["numbers"])
        return Checkpoint(**{name: about[name] for name in _TOLD}, parts=parts)


class _Parts(Mapping[str, Any]):
    """The saved parts of a simulation, in a file.

    An array is read when it is asked for: all at once would double a run's memory.
    """

    def __init__(self, path: Path, arrays: list[str], numbers: dict[str, Any]) -> None:
        self._path, self._numbers = path, numbers
        self._places = {name: f"parts/{n}" for n, name in enumerate(arrays)}

    def __getitem__(self, name: str) -> Any:
        if name in self._numbers:
            return self._numbers[name]
        place = self._places[name]
        with opened(self._path, DAMAGED) as (file, size):
            return checked(file, place, size)

    def __iter__(self) -> Iterator[str]:
        yield from self._numbers
        yield from self._places

    def __len__(self) -> int:
        return len(self._numbers) + len(self._places)


def _about(file: h5py.File, size: int) -> dict[str, Any]:
    """Return all of an open file of `size` bytes that is not an array. Raises PockmarkError."""
    if (known := file.attrs["format"]) != FORMAT:
        raise ForeignError(f"is a checkpoint of format {known}, this pockmark reads format {FORMAT}")
    about: dict[str, Any] = json.loads(checked(file, "about", size).tobytes())
    if about["physics"] != PHYSICS:
        raise ForeignError(
            f"is of physics {about['physics']}, this pockmark has {PHYSICS}: run the scene anew"
        )
    return about
