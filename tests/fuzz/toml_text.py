"""TOML of any table, right or wrong."""

import json
from typing import Any

Table = dict[str, Any]


class Raw(str):
    """A value as it stands in a TOML file, too deep to be built and copied as lists."""


def to_toml(table: Table) -> str:
    """Return the table as TOML, a line a key: what is wrong in it stays as it is."""
    return "".join(f"{_quoted(key)} = {text_of(value)}\n" for key, value in table.items())


def text_of(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_quoted(k)} = {text_of(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return str(value).lower()
    return _quoted(value) if isinstance(value, str) else str(value)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
