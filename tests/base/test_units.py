"""The grammar of quantities: what is accepted is its number times its unit, whatever else is written is refused."""

import math
import random
import time
from pathlib import Path

import pytest

from pockmark import PockmarkError, Scene
from pockmark.base.units import to_si

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"

GOOD = [
    ("20 um", "m", 20e-6),
    ("20um", "m", 20e-6),
    (" 20 um ", "m", 20e-6),
    ("5 \u00b5m", "m", 5e-6),  # the micro sign
    ("5 \u03bcm", "m", 5e-6),  # the Greek letter
    (".5 um", "m", 0.5e-6),
    ("5. um", "m", 5e-6),
    ("+5E-1 um", "m", 0.5e-6),
    ("-3e2 nm", "m", -3e-7),
    ("1e-400 um", "m", 0.0),
    ("1 in", "m", 0.0254),
    ("2.2 km/s", "m/s", 2200.0),
    ("36 km/h", "m/s", 10.0),
    ("15 deg", "rad", math.pi / 12),
    ("0.5 rad", "rad", 0.5),
    ("2.77 g/cm^3", "kg/m^3", 2770.0),
    ("2.77 g/cm**3", "kg/m^3", 2770.0),
    ("2.77 g/cm3", "kg/m^3", 2770.0),
    ("2.77 g*cm^-3", "kg/m^3", 2770.0),
    ("1 mg/cm2", "kg/m^2", 0.01),
    ("875 J/(kg*K)", "J/(kg*K)", 875.0),
    ("875 J / (kg * K)", "J/(kg*K)", 875.0),
    ("875 J/kg/K", "J/(kg*K)", 875.0),
    ("265 MPa", "Pa", 265e6),
    ("265 N/mm^2", "Pa", 265e6),
    ("1 kbar", "Pa", 1e8),
    ("5 1/s", "1/s", 5.0),
    ("5 /s", "1/s", 5.0),
    ("5/s", "1/s", 5.0),
    ("5 Hz", "1/s", 5.0),
    ("20 degC", "K", 293.15),
    ("20 \u00b0C", "K", 293.15),
    ("293 K", "K", 293.0),
    ("1.34", "", 1.34),
    (3, "m", 3.0),
    (1e-6, "m", 1e-6),
]


@pytest.mark.parametrize(("text", "unit", "expected"), GOOD)
def test_a_quantity_is_its_number_times_its_unit(text, unit, expected):
    assert to_si(text, unit) == pytest.approx(expected, rel=1e-14, abs=0)


# Each with the unit that its key has. pint took 60 of the 111 for quantities, and hung at one.
BAD = [
    *((text, "m/s") for text in ("2,2 km/s", "2.2 km,s", "0.1 c", "2 km/s 3", "2 kn")),
    *((text, "m") for text in ("1,5 um", "1,0 um", "1.5.5 um", "1 000 um", "1_000 um", "1e5.5 um", "1e um")),
    *(
        (text, "m")
        for text in ("(1+-0.1) um", "1 um +- 0.1 um", "1.0(1) um", "1 um + 2 um", "1 - 2 um", "--1 um")
    ),
    *(
        (text, "m")
        for text in ("1//3 um", "1/3 um", "2**3 um", "3 % 2 um", "1 um 2", "2 1 um", "2*3 um", "um 2", "um")
    ),
    *(
        (text, "m")
        for text in ("1 % um", "1 percent um", "1 percent*um", "1 pi*um", "5 um*count", "5 count*um")
    ),
    *(
        (text, "m")
        for text in ("1 um^1.5", "1 um^0", "1 m^999999999", "1 um^2/um^1^1", "1 ((um))", "1 (um", "1 um)")
    ),
    *(
        (text, "m")
        for text in ("nan um", "inf m", "-inf m", "1e400 um", "1e308 km", "1e999999999 um", "infinity m")
    ),
    *(
        (text, "m")
        for text in ("0x10 um", "0b1 um", "1j um", "\u0661 um", "\uff11 um", "1 \uff55m", "\u00bd um")
    ),
    *(
        (text, "m")
        for text in ("1 um\n", "1\tum", "1\u00a0um", "1 u m", "1 kum", "1 kmicrometer", "1 ums", "20 dB")
    ),
    *(
        (text, "m")
        for text in ("", " ", "1", "5 kg", "1 m**2", "1 parsec", "1 planck_length", "5 [length]", "$1 um")
    ),
    *(
        (text, "m")
        for text in ("1" * 1_000_000 + " um", "1 " + "(" * 5000 + "um" + ")" * 5000, "1 um" + " " * 200)
    ),
    *((text, "m") for text in ("1 " + "*".join(["m"] * 5000), True, None, [1], {"v": 1}, 10**400, math.nan)),
    *(
        (text, "rad")
        for text in ("1", "1 dimensionless", "100 percent", "1 m/m", "1 turn", "1 count", "pi rad")
    ),
    *((text, "1/s") for text in ("60 rpm", "5 count/s", "5 rad/s", "5 Bq", "5 2/s", "5")),
    *(
        (text, "")
        for text in ("30 %", "30 percent", "0.3 rad", "0.3 um/um", "0.3 dimensionless", "1/3", "1e400")
    ),
    *(
        (text, "K")
        for text in ("5 delta_degC", "20 degC*m/m", "20 mdegC", "20 degC/1", "20 degC + 3 K", "20")
    ),
    *((text, "J/(kg*K)") for text in ("875 J/(kg*degC)", "875 J/kg K", "875 J/(kg*K", "3 k/kg")),
]


@pytest.mark.parametrize(("text", "unit"), BAD, ids=lambda value: repr(value)[:30])
def test_what_is_no_quantity_is_refused_at_once_in_one_sentence(text, unit):
    to_si("1 m", "m")  # the units are read once
    start = time.process_time()
    with pytest.raises(ValueError, match=r"^found ") as caught:
        to_si(text, unit)
    print(caught.value)
    assert time.process_time() - start < 0.5
    assert len(str(caught.value)) < 200
    assert str(caught.value).isprintable()


def reference(text):
    """An independent reading, character by character, of lengths in the letters u, n, m, k, c and s: metres, or None."""
    prefixes = {"": 0, "u": -6, "mu": -6, "mc": -6, "n": -9, "m": -3, "k": 3, "c": -2}
    rest = text.strip(" ")
    sign = -1.0 if rest[:1] == "-" else 1.0
    rest = rest[1:] if rest[:1] in ("+", "-") else rest

    def digits():
        nonlocal rest
        n = len(rest) - len(rest.lstrip("0123456789"))
        head, rest = rest[:n], rest[n:]
        return head

    whole, fraction = digits(), ""
    if rest[:1] == ".":
        rest = rest[1:]
        fraction = digits()
    if not whole + fraction:
        return None
    power = 0
    if rest[:1] in ("e", "E"):
        after = rest[1:]
        minus, after = after[:1] == "-", after[1:] if after[:1] in ("+", "-") else after
        if after[:1] in tuple("0123456789"):
            rest = after
            power = int(digits()) * (-1 if minus else 1)
    value = sign * float(f"{whole or 0}.{fraction or 0}e{power}")
    rest = rest.lstrip(" ")
    length = seconds = exponent = 0  # powers of the metre, the second and ten
    times = 1
    if rest[:2] == "1/":
        rest, times = rest[2:].removeprefix(" "), -1
    elif rest[:1] == "/":
        rest, times = rest[1:].removeprefix(" "), -1
    while True:
        n = len(rest) - len(rest.lstrip("unmkcs"))
        name, rest = rest[:n], rest[n:]
        if name[-1:] not in ("m", "s") or name[:-1] not in prefixes:
            return None
        caret = rest[:1] == "^" or rest[:2] == "**"
        if caret:
            rest = rest[1:] if rest[0] == "^" else rest[2:]
        p = -1 if caret and rest[:1] == "-" else 1
        rest = rest[1:] if caret and rest[:1] in ("+", "-") else rest
        if rest[:1] in tuple("123456789"):
            p, rest = p * int(rest[0]), rest[1:]
        elif caret:
            return None
        exponent += times * p * prefixes[name[:-1]]
        length += times * p * (name[-1] == "m")
        seconds += times * p * (name[-1] == "s")
        if not rest.strip(" "):
            break
        rest = rest.removeprefix(" ")
        if rest[:1] not in ("*", "/"):
            return None
        times, rest = -1 if rest[0] == "/" else 1, rest[1:].removeprefix(" ")
    value *= 10.0**exponent
    return value if (length, seconds) == (1, 0) and math.isfinite(value) else None


def mutated(random, text):
    """A text with up to three letters left out, put in or changed."""
    for _ in range(random.randint(0, 3)):
        at, letter = random.randint(0, len(text)), random.choice("0123456789.,+-eE*/^ unmkcs%_")
        text = text[:at] + random.choice(["", letter, letter + text[at : at + 1]]) + text[at + 1 :]
    return text


def test_whatever_is_accepted_is_what_an_independent_reader_reads():
    rng = random.Random(14)
    seeds = [
        "20 um",
        "2.5 um",
        "-1e-3 km",
        "7 m*s/s",
        "3 mm^2/cm",
        "5 um2/nm",
        "1 1/m^-1",
        "4 km / s * us",
        ".5e+2 nm",
    ]
    accepted = 0
    for n in range(20_000):
        text = mutated(rng, seeds[n % len(seeds)])
        expected = reference(text)
        try:
            value = to_si(text, "m")
        except ValueError:
            assert expected is None, text
        else:
            assert expected is not None, text
            assert math.isclose(value, expected, rel_tol=1e-13, abs_tol=1e-320), text
            accepted += 1
    print(f"{accepted} of 20000 texts are quantities")
    assert 3_000 < accepted < 17_000


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("impact.speed", "2,2 km/s"),
        ("impact.angle", "1"),
        ("end_time", "60 ns 2"),
        ("grid.cell", "5,0 um"),
        ("body.projectile.radius", "(10+-1) um"),
        ("materials.al2024-liu2015.thermal.melt_temperature", "775"),
        ("materials.al2024-liu2015.density", "2.77 g"),
        ("numerics.cfl", "50 %"),
    ],
)
def test_a_scene_names_the_key_and_the_text(key, text):
    with pytest.raises(PockmarkError) as caught:
        Scene.load(QUICK, f"{key}='{text}'")
    print(caught.value)
    assert f"{key.replace('projectile', '1').replace('body.1', 'body[1]')}: found '{text}'" in str(
        caught.value
    )


def test_a_temperature_may_be_in_degrees_celsius():
    scene = Scene.load(QUICK, "materials.al2024-liu2015.thermal.room_temperature='20 degC'")
    assert scene.materials["al2024-liu2015"].thermal.room_temperature == 293.15
