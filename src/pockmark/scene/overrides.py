"""Changes of a scene's table, given as texts.

Such are "impact.speed='4 km/s'", "body.projectile.radius='5 um'", "body.'a.b'.radius=5e-6".
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from ..base.errors import PockmarkError, shown
from ..base.toml import written_key

MAX_DEPTH = 20  # keys joined by dots; a scene has 5 at most
# A key and what ends it: quoted as in TOML, or as it is, blanks within included.
_KEY = re.compile(r"""\s*+("(?:[^"\\]|\\.)*"|'[^']*'|[^.="'][^.=]*+)\s*([.=])""")


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with `changes` put over it, table by table.

    A table that names another `model` replaces the old one as a whole.
    """
    if changes.get("model", base.get("model")) != base.get("model"):
        return dict(changes)
    out = dict(base)
    for key, value in changes.items():
        old = out.get(key)
        out[key] = merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
    return out


def override(table: Mapping[str, Any], text: str) -> dict[str, Any]:
    """Return the table with the change of the text. Raises PockmarkError.

    A body is named by its name, or by its place counted from 0.
    """
    keys, rest = _keys(text)
    return _with(table, keys, _value(rest))


def changed(table: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Return the table with another value of a key, which is named as in override(). Raises PockmarkError."""
    keys, rest = _keys(f"{key}=")
    if rest:
        raise PockmarkError(f"{shown(key)}: expected a key")
    return _with(table, keys, value)


def _with(table: Mapping[str, Any], keys: Sequence[str], value: Any) -> dict[str, Any]:
    """Return the table with a value at the place that the keys lead to."""
    for key in reversed(keys):
        value = {key: value}
    bodies, changes = table.get("body"), value.get("body")
    if isinstance(bodies, list) and isinstance(changes, Mapping):
        value["body"] = _changed(bodies, changes)
    return merge(table, value)


def _keys(text: str) -> tuple[list[str], str]:
    """Return the keys at the start of "a.b=value", and what follows. Raises PockmarkError."""
    keys: list[str] = []
    end, at = ".", 0
    while end == "." and (match := _KEY.match(text, at)) and len(keys) < MAX_DEPTH:
        keys.append(_unquoted(match[1], text))
        end, at = match[2], match.end()
    if end != "=":
        raise _is_no_change(text)
    return keys, text[at:]


def _unquoted(key: str, text: str) -> str:
    """Return a key as it is meant. What is quoted may have dots, and escapes within double quotes."""
    if key[0] not in "\"'":
        return key.strip()
    try:
        return str(tomllib.loads(f"v = {key}")["v"])
    except ValueError:
        raise _is_no_change(text) from None


def _is_no_change(text: str) -> PockmarkError:
    """Return the error of a text that is no change."""
    return PockmarkError(f"--set {text}: expected key=value")


def _value(text: str) -> Any:
    """Return the value as TOML has it, or else the plain text, which may have several lines."""
    try:
        table = tomllib.loads(f"v = {text}")
    except (ValueError, RecursionError):
        return text.strip()
    return table["v"] if len(table) == 1 else text.strip()


def _changed(bodies: list[Any], changes: Mapping[str, Any]) -> list[Any]:
    """Return the bodies with the changes of those that are named. Raises PockmarkError."""
    out = list(bodies)
    names = [body.get("name") if isinstance(body, Mapping) else None for body in bodies]
    for key, value in changes.items():
        places = [i for i, name in enumerate(names) if key in (name, str(i))]
        if not places:
            allowed = ", ".join(written_key(str(name)) for name in names if name)
            raise PockmarkError(
                f"body.{written_key(key)}: found no such body, allowed are 0 to {len(names) - 1} and {allowed}"
            )
        if len(places) > 1:
            meant = " and ".join(f"body[{i}] '{names[i]}'" for i in places)
            raise PockmarkError(
                f"body.{written_key(key)}: found {meant}, expected a name, or a place counted from 0, of one body alone"
            )
        old = out[places[0]]
        out[places[0]] = (
            merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
        )
    return out
