"""One grammar for quantities: number, unit, nothing else. What it says and what it leaves out, found by hypothesis."""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import faults_of_sentence

from pockmark.base.units import to_si

# A text's unit, the SI unit asked for, and what one of it is.
UNITS = [
    *(("um", "m", 1e-6), ("mm", "m", 1e-3), ("m", "m", 1.0), ("nm", "m", 1e-9)),
    *(("km/s", "m/s", 1e3), ("m/s", "m/s", 1.0), ("ns", "s", 1e-9), ("us", "s", 1e-6)),
    *(("GPa", "Pa", 1e9), ("MPa", "Pa", 1e6), ("K", "K", 1.0), ("deg", "rad", math.pi / 180)),
    *(("g/cm^3", "kg/m^3", 1e3), ("mg/cm^2", "kg/m^2", 1e-2), ("J/(kg*K)", "J/(kg*K)", 1.0)),
]
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
# What is neither a number nor a unit, and what makes a sum, a product or an uncertainty of two.
JUNK = [
    *",;:()[]{}%$#@!?*/^=<>|&~'\"\\",
    "..",
    "--",
    "+-",
    "//",
    "**",
    " 2",
    "1 ",
    "\u00b1",
    "\u0663",
    "\u00b2",
    "+1",
]

numbers = st.floats(min_value=-1e12, max_value=1e12).filter(lambda x: not 0 < abs(x) < 1e-80).map(
    repr
) | st.integers(-(10**6), 10**6).map(str)
units = st.sampled_from(UNITS)
# The same cases in every run: a test's answer must not depend on the day.
settings.register_profile("fuzz", derandomize=True, max_examples=300, deadline=2000, database=None)
settings.load_profile("fuzz")


@given(numbers, units, st.sampled_from(["", " ", "  "]))
def test_a_number_and_a_unit_are_what_they_say(number, unit, space):
    name, si, one = unit
    assert to_si(f"{number}{space}{name}", si) == pytest.approx(float(number) * one, rel=1e-14, abs=1e-300)


@given(numbers, units, st.sampled_from(JUNK), st.integers(0, 30))
def test_a_text_with_anything_else_is_refused(number, unit, junk, at):
    """Junk anywhere in the number, or between it and the unit: no text of which a careful reader would take a part."""
    name, si, _ = unit
    at = min(at, len(number))
    spoilt = number[:at] + junk + number[at:]
    if NUMBER.fullmatch(spoilt.strip()):
        return  # "+1" before a number's digits, and the like
    with pytest.raises(ValueError, match="found"):
        to_si(f"{spoilt} {name}", si)


@given(units, units)
def test_another_quantity_is_refused(unit, asked):
    if unit[1] != asked[1]:
        with pytest.raises(ValueError, match="found"):
            to_si(f"1 {unit[0]}", asked[1])


@given(st.text(max_size=40) | st.text("0123456789.e+-/*()^um k", max_size=40))
def test_any_text_is_a_number_or_one_sentence(text):
    try:
        said = f"{to_si(text, 'm')} m"
    except ValueError as error:
        said = str(error)
    assert not list(faults_of_sentence(said))
