"""TOML: read with one sentence for a fault, and written, which tomllib does not do."""

import json
import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .errors import PockmarkError
from .files import AnyPath, as_path, read_text

LARGEST = 2**22  # bytes of a scene or a campaign that a user wrote


def read_toml(path: AnyPath) -> dict[str, Any]:
    """Return the tables of a user's file, which may be a link. Raises PockmarkError naming it."""
    where = as_path(path)
    return parse_toml(read_text(where, largest=LARGEST, follow=True), where)


def parse_toml(text: str, path: str | Path) -> dict[str, Any]:
    """Return the tables of a file's text. Raises PockmarkError naming the file."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # not only TOMLDecodeError: a number of 5000 digits
        raise PockmarkError(f"{path}: is not TOML ({error})") from None


def to_toml(table: Mapping[str, Any], prefix: str = "") -> str:
    """Write the plain tables of a scene as TOML (tomllib only reads)."""
    lines = [f"{written_key(k)} = {_value(v)}" for k, v in table.items() if not _is_table(v)]
    for key, value in table.items():
        path = prefix + written_key(key)
        if isinstance(value, Mapping):
            lines += ["", f"[{path}]", to_toml(value, f"{path}.").rstrip("\n")]
        elif _is_table(value):
            for item in value:
                lines += ["", f"[[{path}]]", to_toml(item, f"{path}.").rstrip("\n")]
    return "\n".join(lines).lstrip("\n") + "\n"


def written_key(key: str) -> str:
    """Return a key as TOML writes it: bare where that is allowed, or else quoted."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _text(key)


def _text(text: str) -> str:
    """Return a basic string of TOML.

    Its escapes are JSON's, but TOML has no surrogates, and DEL must be escaped.
    """
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _is_table(value: Any) -> bool:
    """Return whether a value is written under a header of its own: a table, or a list of tables."""
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _value(value: Any) -> str:
    """Return a plain value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return _text(value) if isinstance(value, str) else str(value)
