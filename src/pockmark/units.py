"""The only door for units: "20 um", "2.2 km/s", "15 deg" in, SI floats inside."""

import math
from decimal import Decimal
from functools import cache
from typing import Annotated, Any

import pint
from pydantic import BeforeValidator

from .errors import found


@cache
def _registry() -> pint.UnitRegistry[Any]:
    # Decimal, so that "20 um" is the float 2e-05 itself and not a rounding of 20 times 1e-6.
    return pint.UnitRegistry(non_int_type=Decimal)


def to_si(value: Any, unit: str) -> float:
    """Convert a number (already SI) or a text with a unit to a float in `unit`, an SI unit such as "m/s".

    Raises ValueError with one sentence on a wrong unit or something that is no finite number.
    """
    number = _to_float(value, unit)
    if not math.isfinite(number):
        raise ValueError(f"{found(value)}, expected a finite number")
    return number


def _to_float(value: Any, unit: str) -> float:
    """to_si without the check that the number is finite."""
    if isinstance(value, bool):
        raise ValueError(f"{found(value)}, expected a quantity in {unit or 'no unit'}")
    if isinstance(value, int | float):
        return float(value) if abs(value) < 1e300 else math.inf  # a whole number may be beyond any float
    if not isinstance(value, str):
        raise ValueError(f"{found(value)}, expected a number or a text like '20 {unit}'")
    try:
        quantity: Any = _registry().Quantity(value)
        return float(quantity.to(unit or "dimensionless").magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"{found(value)}, expected a quantity in {unit or 'no unit'}") from None
    except Exception:
        raise ValueError(f"{found(value)}, which is not a quantity such as '20 {unit}'") from None


def _quantity(unit: str) -> BeforeValidator:
    return BeforeValidator(lambda value: to_si(value, unit))


Length = Annotated[float, _quantity("m")]
Speed = Annotated[float, _quantity("m/s")]
Angle = Annotated[float, _quantity("rad")]
Time = Annotated[float, _quantity("s")]
Pressure = Annotated[float, _quantity("Pa")]
Density = Annotated[float, _quantity("kg/m^3")]
ArealDensity = Annotated[float, _quantity("kg/m^2")]
Temperature = Annotated[float, _quantity("K")]
SpecificHeat = Annotated[float, _quantity("J/(kg*K)")]
Rate = Annotated[float, _quantity("1/s")]
Number = Annotated[float, _quantity("")]
