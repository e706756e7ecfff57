"""`pockmark explain`: what each key of a scene means, and what it may be."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import typer
from rich.table import Table

from ..base.json import to_json
from ..base.terminal import literal
from ..scene.keys import Key, find, keys
from .common import CONSOLE

IN_FULL = 3  # keys that are shown in full; more are a list


def explain(
    key: Annotated[
        str, typer.Argument(metavar="[KEY]", help="A key, a table, a shape or a law; left out: every key.")
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Explain the keys of a scene: meaning, unit, default, what is allowed and what is a good value."""
    found = find(key) if key else [*keys()]
    if as_json:
        print(to_json([asdict(one) for one in found]))
    elif len(found) <= IN_FULL:
        for one in found:
            CONSOLE.print(_in_full(one))
    else:
        for table in dict.fromkeys(one.table for one in found):
            CONSOLE.print(_list(table, [one for one in found if one.table == table]))


def _in_full(key: Key) -> Table:
    """Return all that is known of a key."""
    table = Table(show_header=False, title=literal(f"{key.path} ({key.of})" if key.of else key.path))
    rows = {
        "meaning": key.meaning,
        "unit": key.unit or "none",
        "default": key.default or "none: the key is needed",
        "allowed": key.allowed or "any",
        "recommended": key.advice,
    }
    for name, text in rows.items():
        if text:
            table.add_row(name, literal(text))
    return table


def _list(title: str, found: Sequence[Key]) -> Table:
    """Return a row for each key of a table of the scene."""
    table = Table("key", "default", "allowed", "meaning", title=literal(title or "the scene"))
    for key in found:
        table.add_row(*map(literal, (key.name, key.default or "needed", key.allowed, key.meaning)))
    return table
