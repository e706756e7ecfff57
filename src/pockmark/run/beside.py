"""The way from several run folders to one page: what they have in common, and what differs."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..base.files import AnyPath
from ..metrology.measures import UNWARNED
from ..scene.scene import Scene
from ..view.images import png
from ..view.many import Told, compared_figure
from ..view.page import Comparison, Line
from ..view.report import parts
from .measured import measure_run, standing_of
from .reported import cautions, slice_of, was_run
from .store import RunFolder

MISSING = "-"
TITLES = {
    "crater": "Measured",
    "group": "The group of craters",
    "ejecta": "Ejecta",
    "energy": "Energies",
    "run": "Run",
    "counters": "Counted",
}


@UNWARNED
def comparison(paths: Sequence[AnyPath]) -> Comparison:
    """Return what the page of several run folders shows, a column for each. Raises PockmarkError."""
    folders = [RunFolder.open(path) for path in paths]
    scenes, results = [folder.scene() for folder in folders], [measure_run(path) for path in paths]
    names = _names(folders)
    tables = [parts(result) for result in results]
    lines = {"What was run": [*_lines([dict(was_run(scene)) for scene in scenes])]}
    if differing := [*_differing(scenes)]:
        lines["Keys of the scenes that differ (SI)"] = differing
    for part, title in TITLES.items():
        if any(table[part] for table in tables):
            lines[title] = [*_lines([dict(_numbered(table[part])) for table in tables])]
    return Comparison(
        names=names,
        notes=[*_notes(names, folders, results)],
        parts=lines,
        figure=png(compared_figure([_told(*pair) for pair in zip(names, folders, strict=True)])),
        slices=[slice_of(folder) for folder in folders],
    )


def _names(folders: Sequence[RunFolder]) -> list[str]:
    """Return a name for each run folder: its own, or its path where two have the same."""
    own = [folder.path.resolve().name for folder in folders]
    return own if len(set(own)) == len(own) else [str(folder.path) for folder in folders]


def _notes(
    names: Sequence[str], folders: Sequence[RunFolder], results: Sequence[Mapping[str, Any]]
) -> Iterator[tuple[str, str]]:
    """Give what is to be known of the runs before their numbers: its kind, and a sentence."""
    for name, folder, result in zip(names, folders, results, strict=True):
        for text in [*cautions(folder.manifest()), *result["doubts"]]:
            yield "doubt", f"{name}: {text}"
        if said := standing_of(folder):
            yield "warning", f"{name}: the run is {said}"
        for text in result["warnings"]:
            yield "warning", f"{name}: {text}"


def _numbered(rows: Sequence[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """Give rows with a number behind each name that was there before."""
    seen: dict[str, int] = {}
    for name, text in rows:
        seen[name] = seen.get(name, 0) + 1
        yield (name if seen[name] == 1 else f"{name} ({seen[name]})"), text


def _lines(tables: Sequence[Mapping[str, str]]) -> Iterator[Line]:
    """Give a line for each name in the tables of the runs."""
    for name in dict.fromkeys(name for table in tables for name in table):
        texts = [table.get(name, MISSING) for table in tables]
        yield Line(name, texts, len(set(texts)) > 1)


def _differing(scenes: Sequence[Scene]) -> Iterator[Line]:
    """Give a line for each key of the scenes that differs; a title may."""
    tables = [dict(_flat(scene.to_dict())) for scene in scenes]
    yield from (line for line in _lines(tables) if line.differs and line.name != "title")


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Give each value of nested tables and lists by its key: ("impact.speed", "2200.0"), ..."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _flat(inner, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list | tuple) and any(isinstance(inner, Mapping) for inner in value):
        for n, inner in enumerate(value):
            yield from _flat(inner, f"{path}.{n}")
    else:
        yield path, str(value)


def _told(name: str, folder: RunFolder) -> Told:
    """Return the history of a run."""
    rows = folder.history("time", "depth", "internal", "initial")
    initial = np.where(rows["initial"] == 0, np.nan, rows["initial"])
    return Told(name, rows["time"], rows["depth"], rows["internal"] / initial)
