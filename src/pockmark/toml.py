"""Writing TOML, which tomllib only reads."""

import json
import math
from collections.abc import Mapping
from typing import Any


def to_toml(table: Mapping[str, Any], prefix: str = "") -> str:
    """Minimal TOML writer for the plain tables of a scene (tomllib only reads)."""
    lines = [f"{k} = {_toml_value(v)}" for k, v in table.items() if not _is_table(v)]
    for key, value in table.items():
        path = f"{prefix}{json.dumps(key) if not key.replace('-', '').replace('_', '').isalnum() else key}"
        if isinstance(value, Mapping):
            lines += ["", f"[{path}]", to_toml(value, f"{path}.").rstrip("\n")]
        elif _is_table(value):
            for item in value:
                lines += ["", f"[[{path}]]", to_toml(item, f"{path}.").rstrip("\n")]
    return "\n".join(lines).lstrip("\n") + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, list):
        return "[" + ", ".join(_toml_value(v) for v in value) + "]"
    return json.dumps(value)
