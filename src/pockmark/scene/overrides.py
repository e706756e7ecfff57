"""Changes of a scene's table in a text: "impact.speed='4 km/s'", "body.projectile.radius='5 um'"."""

import tomllib
from collections.abc import Mapping
from typing import Any

from ..base.errors import PockmarkError
from .materials import merge

MAX_DEPTH = 20  # keys in a row; a scene has 5


def override(table: Mapping[str, Any], text: str) -> dict[str, Any]:
    """Return the table with the change of the text; a body is named by its name or counted from 0. Raises PockmarkError."""
    change = _parse(text)
    bodies, changes = table.get("body"), change.get("body")
    if isinstance(bodies, list) and isinstance(changes, Mapping):
        change["body"] = _changed(bodies, changes)
    return merge(table, change)


def _parse(text: str) -> dict[str, Any]:
    """Return "a.b=value" as nested tables; the value is TOML, or else a plain text."""
    key, equals, value = text.partition("=")
    keys = [part.strip() for part in key.split(".")]
    if not equals or not all(keys) or len(keys) > MAX_DEPTH:
        raise PockmarkError(f"--set {text}: expected key=value")
    out = _value(value)
    for part in reversed(keys):
        out = {part: out}
    return dict(out)


def _value(text: str) -> Any:
    """Return the value as TOML has it, or else the plain text, which may have lines of its own."""
    try:
        table = tomllib.loads(f"v = {text}")
    except (ValueError, RecursionError):
        return text.strip()
    return table["v"] if len(table) == 1 else text.strip()


def _changed(bodies: list[Any], changes: Mapping[str, Any]) -> list[Any]:
    """Return the bodies with the changes of those that are named."""
    out = list(bodies)
    names = [body.get("name") if isinstance(body, Mapping) else None for body in bodies]
    for key, value in changes.items():
        places = [i for i, name in enumerate(names) if key in (name, str(i))]
        if not places:
            allowed = ", ".join(str(name) for name in names if name)
            raise PockmarkError(
                f"body.{key}: found no such body, allowed are 0 to {len(names) - 1} and {allowed}"
            )
        old = out[places[0]]
        out[places[0]] = (
            merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
        )
    return out
