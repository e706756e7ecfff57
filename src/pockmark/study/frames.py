"""The table of a campaign as a DataFrame of pandas."""

import json
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, reason
from ..base.units import to_si
from ..run.frames import pandas
from ..scene.keys import find

if TYPE_CHECKING:
    from pandas import DataFrame

RESULTS = "results.csv"
FIRST = "groups"  # the first column that is not swept
LISTS = ("warnings", "doubts")


def study_frame(path: AnyPath) -> "DataFrame":
    """Return the table of a campaign, a row for each run, SI: of a results.csv, or of the folder that has one.

    Swept quantities are numbers, other swept values as they are written; `attrs["units"]` has their units. Warnings and doubts are lists. Raises PockmarkError,
    also where pandas is missing.
    """
    where = as_path(path)
    where = where / RESULTS if where.is_dir() else where
    try:
        frame: DataFrame = pandas().read_csv(where)
    except (OSError, ValueError) as error:
        raise PockmarkError(f"{where}: cannot be read as a table ({reason(error)})") from None
    if FIRST not in frame:
        raise PockmarkError(f"{where}: is no table of a campaign, for it lacks the column {FIRST}")
    units = {}
    for name in frame.columns[: frame.columns.get_loc(FIRST)]:
        if numbers := in_si(name, frame[name]):
            units[name], frame[name] = numbers
    for name in (name for name in LISTS if name in frame):
        frame[name] = [json.loads(text) if isinstance(text, str) else [] for text in frame[name]]
    frame.attrs["units"] = units
    return frame


def in_si(key: str, values: Iterable[Any]) -> tuple[str, list[float]] | None:
    """Return the unit of a swept key, and its values in it, nan where a run has none.

    None for a key that is no quantity of a unit, such as the name of a scheme or a corner.
    """
    try:
        unit = find(key)[0].unit
        numbers = [math.nan if value != value else to_si(value, unit) for value in values]
    except (PockmarkError, ValueError):
        return None
    return (unit, numbers) if unit else None
