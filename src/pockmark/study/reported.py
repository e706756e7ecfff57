"""The way from a campaign's table and runs to what its page shows."""

import csv
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, read_text
from ..base.lengths import unit_for
from ..metrology.measures import UNWARNED
from ..run.reported import slice_of
from ..run.store import RunFolder
from ..view.images import png
from ..view.many import Series, swept_figure
from ..view.page import CampaignReport, Cell
from .frames import FIRST, LISTS, RESULTS, in_si

QUICK = "results-quick.csv"
LARGEST = 2**26  # bytes of a table
MOST_SLICES = 12  # of a page
LENGTHS = {"crater.depth": "C_p", "crater.diameter": "D_c"}
RATIOS = {
    "crater.depth_over_projectile_diameter": "C_p/d_p",
    "crater.depth_over_diameter": "C_p/D_c",
    "energy.residual_internal": "E_i^r",
}
Row = Mapping[str, str]


class Table(NamedTuple):
    """The table of a campaign: where it is, its swept keys, and its rows by column."""

    path: Path
    swept: Sequence[str]
    rows: Sequence[Row]


def table_in(path: AnyPath) -> Path | None:
    """Return where the table of a campaign is: the path itself, or a file in it; None if there is none."""
    where = as_path(path)
    if where.is_file():
        return where if where.suffix == ".csv" else None
    return next((where / name for name in (RESULTS, QUICK) if (where / name).is_file()), None)


@UNWARNED
def campaign_report(path: Path) -> CampaignReport:
    """Return what the page of a campaign shows, whose table is at a path. Raises PockmarkError."""
    table = _read(path)
    unit, size = unit_for(*(_number(row, key) for row in table.rows for key in LENGTHS))
    measures = {f"{name} ({unit})": (key, size) for key, name in LENGTHS.items()}
    measures |= {name: (key, 1.0) for key, name in RATIOS.items()}
    slices, no_slices = _slices(table)
    return CampaignReport(
        title=f"campaign {path.resolve().parent.name}",
        table=path.name,
        columns=[*table.swept, FIRST, *measures, "standing", "pockmark"],
        rows=[[*_cells(table, row, measures)] for row in table.rows],
        notes=[*_notes(table)],
        figures=[png(figure) for figure in _figures(table, measures)],
        slices=slices,
        no_slices=no_slices,
    )


def _read(path: Path) -> Table:
    """Return a campaign's table. Raises PockmarkError for what is none."""
    try:
        reader = csv.DictReader(read_text(path, largest=LARGEST, follow=True).splitlines(), restval="")
        rows, columns = [*reader], [*(reader.fieldnames or ())]
    except csv.Error as error:
        raise PockmarkError(f"{path}: is not a table of pockmark's ({error})") from None
    if FIRST not in columns or "scene" not in columns:
        raise PockmarkError(f"{path}: is no table of a campaign, for it lacks the column {FIRST} or scene")
    if not rows:
        raise PockmarkError(f"{path}: has no run")
    return Table(path, columns[: columns.index(FIRST)], rows)


def _number(row: Row, key: str) -> float | None:
    """Return a finite number of a row; None where it has none."""
    try:
        value = float(row.get(key) or "nan")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _texts(row: Row, key: str) -> list[str]:
    """Return the sentences that a row has under a key, as JSON; none where it has no such list."""
    try:
        found = json.loads(row.get(key) or "[]")
    except ValueError:
        return []
    return [str(text) for text in found] if isinstance(found, list) else []


def _cells(table: Table, row: Row, measures: Mapping[str, tuple[str, float]]) -> Iterator[Cell]:
    """Give the cells of a row: what was swept, the measures, what the run is worth, what made it."""
    for key in table.swept:
        yield Cell(row[key], _swept(key, row))
    yield Cell(row[FIRST])
    for key, size in measures.values():
        value = _number(row, key)
        yield Cell("-") if value is None else Cell(f"{value / size:.4g}", value)
    yield Cell(_standing(row))
    yield Cell(row.get("version", ""))


def _swept(key: str, row: Row) -> float | None:
    """Return the value of a swept key in SI; None for one that is no quantity."""
    found = in_si(key, [row[key]]) if row[key] else None
    return found[1][0] if found else _number(row, key)


def _standing(row: Row) -> str:
    """Return why a run has no result, or what it is worth; empty without doubts and warnings."""
    if row.get("fault"):
        return row["fault"]
    doubts, warnings = len(_texts(row, "doubts")), len(_texts(row, "warnings"))
    said = ["doubtful"] if doubts else []
    if warnings:
        said.append(f"{warnings} warning{'s' if warnings > 1 else ''}")
    return ", ".join(said)


def _label(table: Table, row: Row, but: str = "") -> str:
    """Return what tells a run from the others: its swept keys, without one of them."""
    return ", ".join(f"{key} {row[key]}" for key in table.swept if key != but and row[key])


def _notes(table: Table) -> Iterator[str]:
    """Give what is to be known of the runs before their numbers, a sentence each."""
    for row in table.rows:
        name = _label(table, row) or row["scene"]
        if row.get("fault"):
            yield f"{name}: failed: {row['fault']}"
        for text in _texts(row, "doubts"):
            yield f"{name}: doubtful: {text}"
    said: dict[str, int] = {}
    if missing := [name for name in LISTS if name not in table.rows[0]]:
        yield f"the table does not say which runs have {' or '.join(missing)}: an older pockmark wrote it"
    for row in table.rows:
        for text in dict.fromkeys(_texts(row, "warnings")):
            said[text] = said.get(text, 0) + 1
    for text, count in said.items():
        yield f"{count} of {len(table.rows)} runs: {text}"


def _figures(table: Table, measures: Mapping[str, tuple[str, float]]) -> Iterator[Figure]:
    """Give a figure for each swept key that is a number and has more than one value."""
    for key in table.swept:
        places = [_swept(key, row) for row in table.rows]
        if len({place for place in places if place is not None}) < 2:
            continue
        groups: dict[str, list[tuple[float, Row]]] = {}
        for place, row in zip(places, table.rows, strict=True):
            if place is not None:
                groups.setdefault(_label(table, row, key), []).append((place, row))
        series = [
            Series(
                name,
                np.array([place for place, _ in group]),
                {
                    measure: np.array([_or_nan(_number(row, column), size) for _, row in group])
                    for measure, (column, size) in measures.items()
                },
            )
            for name, group in groups.items()
        ]
        unit = in_si(key, [next(row[key] for row in table.rows if row[key])])
        yield swept_figure(f"{key} ({unit[0]})" if unit else key, series, [*measures])


def _or_nan(value: float | None, size: float) -> float:
    """Return a value in multiples of a size; nan for None."""
    return math.nan if value is None else value / size


def _slices(table: Table) -> tuple[list[tuple[str, str]], str]:
    """Return the slices of the first runs that are there, by name, and what is to be said of them."""
    beside = (table.path.parent, table.path.resolve().parent.parent)
    found: list[tuple[str, str]] = []
    there, faults = 0, []
    for row in table.rows:
        named = re.fullmatch(r"\w+", row["scene"])  # a hash: nothing leads elsewhere
        runs = (folder / row["scene"] for folder in beside if named)
        if (place := next((path for path in runs if RunFolder(path).is_run()), None)) is None:
            continue
        there += 1
        if len(found) < MOST_SLICES:
            try:
                found.append((_label(table, row) or row["scene"], slice_of(place)))
            except PockmarkError as error:
                faults.append(str(error))
    if not there:
        return [], "No run lies beside the table."
    return found, "; ".join(
        [f"{len(found)} of the {there} runs that lie beside the table", *faults[:3]]
    ) + "."
