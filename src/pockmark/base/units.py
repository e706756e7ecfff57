"""The only door for units: "20 um", "2.2 km/s", "15 deg" in, SI floats inside.

A quantity is a text of at most 100 characters: a number, then its unit, nothing else. The number has digits, at most one
decimal point and at most one exponent. The unit is made of names of `UNITS` (with SI prefixes), whole powers from -9 to 9
(`cm^2`, `cm**2`, `cm2`), `*`, `/` and parentheses one deep: `J/(kg*K)`. It may begin with `1/`.
"""

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from typing import Annotated, Any

import pint
from pydantic import GetCoreSchemaHandler
from pydantic_core import core_schema

from .errors import found

MAX_LENGTH = 100  # characters of a text
SMALLEST = 1e-100  # no quantity but 0 is nearer to 0: so products and powers of quantities are not 0 either

# The units allowed, by pint's names. Pint has hundreds more, constants and plain numbers among them.
UNITS = re.compile(
    "meter|gram|second|minute|hour|day|kelvin|degree_Celsius|degree_Fahrenheit|radian|degree|arcminute|hertz|newton|pascal|bar|"
    "joule|watt|liter|electron_volt|calorie|erg|dyne|standard_atmosphere|metric_ton|micron|angstrom|inch|foot|mil|mile|pound|"
    "pound_force_per_square_inch|kip_per_square_inch"
)
PREFIXES = re.compile("|atto|femto|pico|nano|micro|milli|centi|deci|hecto|kilo|mega|giga|tera")
# Temperatures that count from a zero of their own, and so are never part of another unit.
TEMPERATURES = ("degree_Celsius", "degree_Fahrenheit")

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[+-]?(?:nan|inf)"
_NAME = r"[A-Za-zµμ°]+"
_FACTOR = rf"{_NAME}(?:(?:\^|\*\*)[+-]?[1-9]|[1-9])?"
_PRODUCT = rf"{_FACTOR}(?: ?[*/] ?{_FACTOR})*"
_PART = rf"(?:{_FACTOR}|\( ?{_PRODUCT} ?\))"
_QUANTITY = re.compile(rf" *({_NUMBER}) *((?:1?/ ?)?{_PART}(?: ?[*/] ?{_PART})*)? *")


def to_si(value: Any, unit: str, low: float = -math.inf, high: float = math.inf) -> float:
    """Convert a number (already SI) or a text with a unit to a float in `unit`, an SI unit such as "m/s".

    Raises ValueError with one sentence: for a wrong unit, for what is no finite number, for what is nearer to 0 than
    SMALLEST, and for what is below `low` or above `high`.
    """
    number = _to_float(value, unit)
    if not math.isfinite(number):
        raise ValueError(f"{found(value)}, expected a finite number")
    if not low <= number <= high:
        raise ValueError(f"{found(value)}, allowed is {low:g} to {high:g} {unit}".rstrip())
    if 0 < abs(number) < SMALLEST:
        raise ValueError(f"{found(value)}, nearer to 0 than any quantity: write 0")
    return number


def _to_float(value: Any, unit: str) -> float:
    """Convert a value as to_si does, without its checks of the number itself."""
    if isinstance(value, bool):
        raise ValueError(f"{found(value)}, expected a quantity in {unit or 'no unit'}")
    if isinstance(value, int | float):
        return float(value) if abs(value) < 1e300 else math.inf  # a whole number may be beyond any float
    if not isinstance(value, str):
        raise ValueError(f"{found(value)}, expected a number or a text like '20 {unit}'")
    text = _QUANTITY.fullmatch(value) if len(value) <= MAX_LENGTH else None
    if text is None:
        example = f"'20 {unit}' (a number, its unit, nothing else)" if unit else "'0.3' (a number alone)"
        raise ValueError(f"{found(value)}, which is not a quantity such as {example}")
    number, written = text[1], text[2] or ""
    if bool(written) != bool(unit):
        missing = f"its unit is missing: expected one in {unit}" if unit else "expected a quantity in no unit"
        raise ValueError(f"{found(value)}, {missing}")
    size = float(number)
    if not (unit and math.isfinite(size)):
        return size
    # Decimal, so that "20 um" is the float 2e-05 itself and not a rounding of 20 times 1e-6; of "1e-999" nothing is left.
    exact = Decimal(number) if size else Decimal(0)
    try:
        return float(_registry().Quantity(exact, _known(written, unit)).to(unit).magnitude)
    except ValueError as error:
        raise ValueError(f"{found(value)}, {error}") from None


@cache
def _registry() -> pint.UnitRegistry[Any]:
    """Return pint's units, in decimal arithmetic; made once."""
    return pint.UnitRegistry(non_int_type=Decimal)


@lru_cache(maxsize=256)
def _known(written: str, unit: str) -> Any:
    """Return the unit that is written, as pint has it.

    Raises ValueError unless it is one of those allowed and measures what `unit` does.
    """
    registry = _registry()
    for name in re.findall(_NAME, written):
        prefix, base, _ = next(iter(registry.parse_unit_name(name)), ("", "", ""))
        if not (PREFIXES.fullmatch(prefix) and UNITS.fullmatch(base)):
            raise ValueError(f"where {name[:20]!r} is no unit that is known")
        if base in TEMPERATURES and (prefix or name != written):
            raise ValueError(f"where {name} is part of another unit: write K")
    # Pint needs "**" in a power, for it reads some names with digits otherwise; and "1/s" for "/s".
    plain = re.sub(rf"({_NAME})(?:\^|\*\*)?([+-]?[1-9])", r"\1**\2", written.replace(" ", ""))
    given = registry.Unit(re.sub("^1?/", "1/", plain))
    # Not only the dimension: to pint an angle is a plain number.
    if registry.get_root_units(given)[1] != registry.get_root_units(registry.Unit(unit))[1]:
        raise ValueError(f"expected a quantity in {unit}")
    return given


@dataclass(frozen=True)
class Quantity:
    """How pydantic reads a key that is a quantity: in `unit`, from `low` to `high`."""

    unit: str
    low: float = -math.inf
    high: float = math.inf

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Return the schema that converts to SI, before what else holds for the key."""
        return core_schema.no_info_before_validator_function(self._read, handler(source))

    def _read(self, value: Any) -> float:
        return to_si(value, self.unit, self.low, self.high)


Length = Annotated[float, Quantity("m", -1e4, 1e4)]
Speed = Annotated[float, Quantity("m/s", 0.0, 1e6)]  # meteoroids have up to 72 km/s
Velocity = Annotated[float, Quantity("m/s", -1e6, 1e6)]  # one component
Angle = Annotated[float, Quantity("rad")]
Time = Annotated[float, Quantity("s", -1e4, 1e4)]
Number = Annotated[float, Quantity("")]
ArealDensity = Annotated[float, Quantity("kg/m^2", 0.0, 1e6)]
