"""Lengths, areas and volumes for a reader, in the unit in which their figures keep their digits.

Programs get SI.
"""

import math

# (unit, its size in m, the first length in m that is too large for it). Lengths of .1 to 9999 um are in um.
_UNITS = (("nm", 1e-9, 0.1e-6), ("um", 1e-6, 9999.5e-6), ("mm", 1e-3, 9.9995), ("m", 1.0, math.inf))


def unit_for(*values: float | None, power: int = 1) -> tuple[str, float]:
    """Return a unit and its size in SI that suits the largest of some lengths, m.

    With `power` 2 or 3 the values are areas (m^2) or volumes (m^3), and so is the unit; with 0 they are plain numbers,
    and it is "" and 1. What is None or not finite is passed over.
    """
    if power == 0:
        return "", 1.0
    sizes = [abs(value) ** (1 / power) for value in values if value is not None and math.isfinite(value)]
    largest = max(sizes, default=0.0)
    if largest == 0:
        name, size = "um", 1e-6
    else:
        name, size = next((name, size) for name, size, limit in _UNITS if largest < limit)
    return name + (f"^{power}" if power > 1 else ""), size**power


def in_metres(value: float, digits: int = 4) -> str:
    """Return a length (m) with its unit."""
    unit, size = unit_for(value)
    return f"{value / size:z.{digits}g} {unit}"
