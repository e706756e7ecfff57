"""What identifies a scene: a hash of all that is computed."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeGuard


def hash_of(table: Mapping[str, Any], *, titled: bool = False) -> str:
    """Return the hash of a scene's table, 16 hexadecimal digits.

    The title is a part of it only if `titled`. The interval of the checkpoints never is, nor is a key that says what
    was done before it was there.
    """
    hashed = {key: value for key, value in table.items() if titled or key != "title"}
    if isinstance(output := hashed.get("output"), Mapping):  # checkpoints change nothing that is computed
        hashed["output"] = {key: value for key, value in output.items() if key != "checkpoints"}
    if _has_no_filter(numerics := hashed.get("numerics")):
        hashed["numerics"] = {key: value for key, value in numerics.items() if key != "filter"}
    before = {
        "numerics": (
            ("volumetric_strain", "points"),
            ("node_velocity", "mean"),
        ),
        "grid": (("geometry", "3d"),),
    }
    for name, known in before.items():
        hashed = _without(hashed, (name,), known)
    for name in hashed.get("materials", ()):
        hashed = _without(hashed, ("materials", name, "failure"), (("displacement", 0.0),))
    return hashlib.sha256(json.dumps(hashed, sort_keys=True, default=str).encode()).hexdigest()[:16]


def _has_no_filter(numerics: Any) -> TypeGuard[Mapping[str, Any]]:
    """Return whether a table of numerics asks for no filter: then nothing depends on its other keys."""
    table = numerics.get("filter") if isinstance(numerics, Mapping) else None
    return isinstance(table, Mapping) and table.get("interval") == 0


def _without(
    table: Mapping[str, Any], path: Sequence[str], known: Sequence[tuple[str, Any]]
) -> dict[str, Any]:
    """Return a table in which the table at a path, if there is one, has no key with one of the known values."""
    if not path:
        return {key: value for key, value in table.items() if (key, value) not in known}
    part = table.get(path[0])
    return {**table, path[0]: _without(part, path[1:], known)} if isinstance(part, Mapping) else dict(table)
