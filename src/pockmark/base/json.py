"""JSON that every reader reads: what is no number is null."""

import json
import math
from collections.abc import Mapping
from typing import Any


def finite(value: Any) -> Any:
    """Return the value with None for each float that is no number (nan, inf) in its tables and lists.

    JSON has no word for such a float.
    """
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def to_json(value: Any) -> str:
    """Return a value as JSON that every reader reads."""
    return json.dumps(finite(value), indent=2, allow_nan=False)
