"""history.csv: a row of numbers for each time at which a run notes its state.

A column is called by its name and its unit: `kinetic [J]`; what has no unit, by its name alone. Readers take the names.
"""

import csv
import io
import os
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from ..base.errors import PockmarkError
from ..base.files import open_regular, told
from ..base.ledger import LEDGER
from ..base.ledger import unit_of as unit_in_ledger

LARGEST = 2**30  # bytes; a scene may ask for a million rows, which have fewer
LONGEST_LINE = 2**16
OWN_UNITS = {"time": "s", "depth": "m"}


@dataclass(frozen=True)
class Rows:
    """The rows of a history: columns (n,) by their names.

    `torn` is how many rows at the end were torn and are left out, 0 or 1.
    """

    columns: dict[str, NDArray[np.float64]]
    torn: int

    @property
    def last(self) -> dict[str, float]:
        """Return the last whole row."""
        return {name: float(values[-1]) for name, values in self.columns.items()}


def unit_of(name: str) -> str:
    """Return the unit of a column, "1" for a number without one."""
    return unit_in_ledger(name) if name in LEDGER else OWN_UNITS.get(name, "1")


def append_row(path: Path, row: Mapping[str, float]) -> None:
    """Add a row, whole or not at all. The first one brings the header. Raises PockmarkError."""
    descriptor = open_regular(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    with told(path), open(descriptor, "wb", buffering=0) as file:
        size = os.fstat(descriptor).st_size
        text = io.StringIO()
        writer = csv.writer(text)
        if size == 0:
            writer.writerow(map(_title, row))
        writer.writerow(row.values())
        try:
            _write_all(file, text.getvalue().encode())
        except OSError:
            os.ftruncate(descriptor, size)
            raise


def _title(name: str) -> str:
    """Return a column's name with its unit, if it has one."""
    unit = unit_of(name)
    return name if unit == "1" else f"{name} [{unit}]"


def read_rows(path: Path, *, torn_end: bool = False) -> Rows:
    """Return the rows of a history. Raises PockmarkError.

    With `torn_end` a last row that its process did not finish is left out.
    """
    descriptor = open_regular(path, os.O_RDONLY)
    with told(path), open(descriptor, encoding="utf-8", errors="replace", newline="\n") as file:
        if os.fstat(descriptor).st_size > LARGEST:
            raise PockmarkError(f"{path}: has more than {LARGEST:,} bytes, which no history needs")
        lines = _lines(file)
        titles = next(lines, "").rstrip("\r\n").split(",")
        names = [title.partition(" [")[0] for title in titles]
        if len(set(names)) < len(names):
            raise PockmarkError(f"{path}: has two columns of one name")
        values = array("d")
        torn = 0
        for line in lines:
            if (numbers := _numbers(line, len(names))) is not None:
                values.extend(numbers)
            elif torn_end and next(lines, None) is None:
                torn = 1
            else:
                values = array("d")
                break
    if not values:
        raise PockmarkError(f"{path}: is empty or torn, expected a number in each column")
    table = np.frombuffer(values).reshape(-1, len(names)).T
    return Rows(dict(zip(names, table, strict=True)), torn)


def last_time(path: Path) -> float:
    """Return the time of the last whole row, s; 0 where there is none yet. Raises PockmarkError.

    However long a history is, its end alone is read: this is asked often.
    """
    if not os.path.lexists(path):
        return 0.0
    with told(path), open(open_regular(path, os.O_RDONLY), "rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - LONGEST_LINE))
        lines = file.read(LONGEST_LINE).decode(errors="replace").splitlines(keepends=True)
    for line in reversed(lines):
        if (numbers := _numbers(line, 1 + line.count(","))) is not None:
            return numbers[0]
    return 0.0


def _write_all(file: io.FileIO, data: bytes) -> None:
    """Write to the last byte.

    A nearly full disk takes a part, and fails with the next.
    """
    while data:
        data = data[file.write(data) :]


def _lines(file: TextIO) -> Iterator[str]:
    """Give the lines of a file. A line that is too long to be pockmark's comes in pieces."""
    while line := file.readline(LONGEST_LINE):
        yield line


def _numbers(line: str, count: int) -> list[float] | None:
    """Return the numbers of a whole row; None for a torn one."""
    cells = line.rstrip("\r\n").split(",")
    if not line.endswith("\n") or len(cells) != count:
        return None
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        return None
