"""The table as it is kept: a CSV with a row for each scheme, column and condition."""

import csv
import json
import math
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from columns import COLUMNS, Condition, label
from schemes import SCHEMES, overrides

sys.path.insert(0, str(Path(__file__).parents[1]))
from reporting import write_rows

from pockmark import PHYSICS, __version__
from pockmark.run.provenance import commit

OUT_OF_TIME = "not finished in"
Key = tuple[str, str, str]  # scheme, column, condition


@dataclass(frozen=True)
class Row:
    """What was measured, or why it was not, and what measured it. All are texts, as in the file."""

    scheme: str
    column: str
    condition: str
    values: str  # JSON: a number for each measure, null where there is none
    fault: str
    seconds: str
    settings: str
    version: str
    physics: str
    commit: str

    @property
    def key(self) -> Key:
        """Return what the row is about."""
        return self.scheme, self.column, self.condition

    @property
    def numbers(self) -> dict[str, float]:
        """Return the measures; NaN where there is none."""
        return {name: math.nan if x is None else x for name, x in json.loads(self.values).items()}

    @property
    def is_fresh(self) -> bool:
        """Return whether this version would measure the same. What ran out of time may have more next time."""
        made = self.version, self.physics, self.settings
        is_ours = made == (__version__, str(PHYSICS), settings_of(self.scheme))
        return is_ours and not self.fault.startswith(OUT_OF_TIME)


def row_of(key: tuple[str, str, Condition], values: Mapping[str, float], fault: str, seconds: float) -> Row:
    """Return the row of a measure that was just made; its numbers have five digits."""
    scheme, column, condition = key
    rounded = {name: float(f"{x:.5g}") if math.isfinite(x) else None for name, x in values.items()}
    made_by = settings_of(scheme), __version__, str(PHYSICS), commit() or ""
    return Row(scheme, column, label(condition), json.dumps(rounded), fault, f"{seconds:.1f}", *made_by)


def settings_of(scheme: str) -> str:
    """Return what a scheme sets, in a text."""
    return " ".join(overrides(SCHEMES[scheme]))


def read(path: Path) -> dict[Key, Row]:
    """Return the rows of a file, none if there is no file. Rows of schemes and columns that are no more are left out."""
    if not path.exists():
        return {}
    with path.open(newline="", encoding="utf-8") as file:
        rows = [Row(**cells) for cells in csv.DictReader(file)]
    return {row.key: row for row in rows if row.scheme in SCHEMES and row.column in COLUMNS}


def write(path: Path, rows: Mapping[Key, Row]) -> None:
    """Write the rows, by column and scheme. A file that is half written never takes the place of the old one."""
    columns, schemes = list(COLUMNS), list(SCHEMES)
    ordered = sorted(rows.values(), key=lambda row: (columns.index(row.column), schemes.index(row.scheme)))
    part = path.with_suffix(".part")
    write_rows(part, [asdict(row) for row in ordered])
    part.replace(path)
