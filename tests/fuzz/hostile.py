"""Hostile scenes and campaigns, each made from its seed alone: good ones with a few things wrong."""

import copy
import random
import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

from toml_text import Raw, text_of, to_toml

# Named, for another example would make other cases of all seeds.
EXAMPLES = [
    (Path(__file__).parents[2] / "examples" / f"{name}.toml").read_bytes()
    for name in ("group-4500", "normal-2200", "quick")
]
# Every table that the examples leave out.
OPTIONAL: dict[str, Any] = {
    "contact": {"friction": 0.1},
    "numerics": {"scheme": "usf", "shape_functions": "quadratic", "cfl": 0.4, "precision": "single"},
    "materials": {
        "mine": {
            "based_on": "cu-ofhc",
            "source": "a test",
            "density": "8.93 g/cm^3",
            "eos": {"model": "linear", "bulk_modulus": "130 GPa"},
            "strength": {"model": "elastic", "shear_modulus": "47 GPa"},
            "failure": {"treatment": "inactive", "D1": 0.5, "reference_rate": "1 1/s"},
            "thermal": {"specific_heat": "383 J/(kg*K)", "melt_temperature": "1356 K", "taylor_quinney": 0.9},
            "viscosity": {"quadratic": 1.5, "linear": 0.06},
        }
    },
}
RANDOM_SWARM: dict[str, Any] = {
    "name": "dust",
    "shape": "swarm",
    "lower": ["-40 um", "0 um"],
    "upper": ["40 um", "40 um"],
    "height": "10 um",
    "seed": 3,
    "number": 3,
    "radius": "5 um",
    "spacing": "1.25 um",
    "material": "mine",
    "projectile": True,
}
TUBE: dict[str, Any] = {
    **{"name": "tube", "shape": "cylinder", "axis": "x", "center": ["0 um", "0 um"], "gap": "0 um"},
    **{"radius": "8 um", "inner_radius": "4 um", "length": "20 um", "spacing": "1.25 um"},
    **{"velocity": ["0 m/s", "0 m/s", "-2 km/s"], "material": "mine"},
}
CAMPAIGN: dict[str, Any] = {
    "title": "a campaign",
    "scene": "scene.toml",
    "set": {"output.snapshots": "20 ns"},
    "quick": {"end_time": "10 ns"},
    "group": [
        {"name": "one", "figures": ["a"], "sweep": {"impact.speed": ["2 km/s", "4 km/s"]}},
        {
            "name": "two",
            "set": {"body.target.material": "cu-ofhc"},
            "sweep": {"numerics.precision": ["single", "double"], "impact.angle": ["0 deg", "15 deg"]},
            "quick": {"numerics.precision": ["single"]},
        },
    ],
}

# 2.5 million runs: more than anybody has the time for.
MANY_RUNS = {
    key: [i * part for i in range(1, 51)]
    for key, part in (
        ("end_time", 1e-9),
        ("numerics.cfl", 0.02),
        ("impact.speed", 100.0),
        ("impact.angle", 0.02),
    )
}


DEEP = 3000
HOSTILE: dict[str, list[Any]] = {
    "number": [0, -1, -0.0, 1, 7, 1e-3, 5e-324, 1e-150, 1e-15, 1e-12, 1e-9, 100_000, 1e12, 1e150, 1.7e308, 10**400, 2**63,
        float("nan"), float("inf"), float("-inf")],
    "quantity": ["2,2 km/s", "1,5 um", "1.5.5 um", "(1+-0.1) um", "1//3 um", "1 um 2", "1 % um", "20 degC",
        "1", "um", "-1 um", "1e400 m", "1e-400 m", "nan um", "inf s", "5e-324 m", "1 parsec", "3 kg", "3 um/s",
        "1 um um", "2**3 um", "1 um; 2 um", "0x10 um", "1_0 um", "one um", "1 \u00b5m", "\u0661 um", "1 deg/um"],
    "markup": ["x [/b] y", "[red]x", "[link=file:///]x[/link]", "cost $\\frac{$", "$x_{", "\\", "{}", "%s%n"],
    "control": ["\x1b[31mx", "a\nb", "a\rb", "\t", "\x07", "\x00", "\x7f", "\x9b1m", "\u2028", "\u202ex"],
    "unicode": ["\u00fc", "\u6f22\u5b57", "\U0001f680", "e\u0301", "\ufeff", "\uffff", " ", ""],
    "type": [True, False, [], {}, [[]], [1], ["1 um"], {"a": 1}, [{}], date(1979, 5, 27)],
    "word": ["free", "swarn", "sphere", "Block", "usavg", "jonson-cook", "linear", "fluid", "no_damage", "single"],
    "long": ["x" * 100_000, "9" * 100_000 + " um", "1 " + "um*" * 3000 + "um", "(" * 5000, "-" * 5000 + "1 m",
        "1" + " " * 100_000 + "um", [0] * 20_000, ["1 um"] * 2000],
    "deep": [Raw("[" * depth + "]" * depth) for depth in (5, DEEP)],
}  # fmt: skip
KEYS = ["", "x", "spacing", "radius", "lower", "material", "model", "0", "a.b", "\x1b[1m", "[b]", "\n",
    "k" * 5000]  # fmt: skip
SIZES = ("spacing", "radius", "length", "inner_radius", "pitch", "number", "flux")
UNITS = ["um", "mm", "m", "km/s", "m/s", "ns", "s", "deg", "rad", "GPa", "K", "g/cm^3", "mg/cm^2",
    "1/s", "%", ""]  # fmt: skip
SAMPLES = ["=", "[", "]", "'", '"', '"""', "\n[[body]]\n", "\n[grid]\n", "\x00", "\ufeff", "#", ".",
    "\\u", "9" * 5000]  # fmt: skip

Table = dict[str, Any]
Place = tuple[Any, Any]  # a table or list, and a key or index of it


@dataclass(frozen=True)
class HostileScene:
    """A scene file and what is given with --set."""

    text: bytes
    overrides: tuple[str, ...] = ()


def hostile_scene(seed: int) -> HostileScene:
    """Return the scene of this seed: wrong values, bytes, overrides, or names that only look wrong."""
    rng = random.Random(f"scene {seed}")
    return rng.choices((_wrong_values, _wrong_bytes, _wrong_overrides, _wrong_names), (6, 2, 2, 1))[0](rng)


def hostile_campaign(seed: int) -> dict[str, bytes]:
    """Return the files of the campaign of this seed, by name."""
    rng = random.Random(f"campaign {seed}")
    table = copy.deepcopy(CAMPAIGN)
    scene = _wrong_values(rng).text if rng.random() < 0.15 else EXAMPLES[-1]
    if rng.random() < 0.1:
        table["group"][0]["sweep"] |= MANY_RUNS
    text = to_toml(_mutated(rng, table)).encode()
    if rng.random() < 0.15:
        text = _damaged(rng, text)
    return {"scene.toml": scene, "campaign.toml": text}


def _base(rng: random.Random) -> Table:
    """Return an example, with some of what the examples leave out, at times with strange names or a wrong size."""
    table = tomllib.loads(rng.choice(EXAMPLES).decode())
    table |= {key: copy.deepcopy(OPTIONAL[key]) for key in OPTIONAL if rng.random() < 0.4}
    if "materials" in table and rng.random() < 0.7:
        ball = table["body"][1] | {"material": "mine"}
        table["body"][1] = rng.choices((RANDOM_SWARM | {}, copy.deepcopy(TUBE), ball), (4, 2, 4))[0]
    for holder, key in ((table, "title"), (table["body"][0], "name"), (table["body"][1], "name")):
        if rng.random() < 0.08:
            holder[key] = rng.choice((_name(rng), "x" * 100_000))
    if rng.random() < 0.1:
        body = rng.choice(table["body"])
        _rescale(rng, body, rng.choice([key for key in SIZES if key in body]))
    return table


def _wrong_values(rng: random.Random) -> HostileScene:
    return HostileScene(to_toml(_mutated(rng, _base(rng))).encode())


def _wrong_bytes(rng: random.Random) -> HostileScene:
    return HostileScene(_damaged(rng, rng.choice(EXAMPLES)))


def _wrong_overrides(rng: random.Random) -> HostileScene:
    table = _base(rng)
    texts = []
    for _ in range(rng.randint(1, 3)):
        path = _path(rng, table)
        if rng.random() < 0.2:
            path = path.replace(".", rng.choice(["..", " . ", "", "=", ".\x1b."]), 1)
        value = _hostile(rng)
        shown = value if isinstance(value, str) and rng.random() < 0.5 else text_of(value)
        texts.append(rng.choice(["{}={}", "{}={}", "{} = {}", "{}{}", "={}{}", "{}='{}"]).format(path, shown))
    return HostileScene(to_toml(table).encode(), tuple(texts))


def _wrong_names(rng: random.Random) -> HostileScene:
    table = _base(rng)
    for holder in (table, *table["body"]):
        holder["title" if holder is table else "name"] = _name(rng)
    return HostileScene(to_toml(table).encode())


def _name(rng: random.Random) -> str:
    return str(rng.choice(HOSTILE[rng.choice(("markup", "markup", "control", "unicode"))]))


def _path(rng: random.Random, table: Table) -> str:
    """Return the dotted path of some place."""
    path, here = [], table
    while isinstance(here, dict | list) and here:
        key = rng.choice(list(here) if isinstance(here, dict) else range(len(here)))
        path.append(str(key))
        here = here[key]  # type: ignore[call-overload]
        if rng.random() < 0.1:
            break
    return ".".join(path)


def _mutated(rng: random.Random, table: Table) -> Table:
    """Return the table with one to three mutations."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        if places := list(_places(table)):
            mutation = rng.choice(MUTATIONS)
            mutation(rng, *rng.choice(places))
    return table


def _places(value: Any, depth: int = 0) -> Iterator[Place]:
    """Yield the places in a table, but for those that a mutation has made beyond counting."""
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in list(keys)[:50] if depth < 10 else ():
        yield value, key
        yield from _places(value[key], depth + 1)


def _hostile(rng: random.Random) -> Any:
    return copy.deepcopy(rng.choice(HOSTILE[rng.choice(list(HOSTILE))]))


def _replace(rng: random.Random, holder: Any, key: Any) -> None:
    holder[key] = _hostile(rng)


def _remove(rng: random.Random, holder: Any, key: Any) -> None:
    del holder[key]


def _misspell(rng: random.Random, holder: Any, key: Any) -> None:
    if isinstance(key, str):
        at = rng.randrange(len(key) + 1)
        holder[rng.choice((key[:at] + key[at + 1 :], key.upper(), key[:at] + "e" + key[at:], *KEYS))] = (
            holder.pop(key)
        )


def _add(rng: random.Random, holder: Any, key: Any) -> None:
    if isinstance(holder, dict):
        holder[rng.choice(KEYS)] = _hostile(rng)
    else:
        holder.insert(key, _hostile(rng))


def _repeat(rng: random.Random, holder: Any, key: Any) -> None:
    value = holder[key]
    if isinstance(holder, list):
        holder.extend(copy.deepcopy(value) for _ in range(rng.choice((1, 3, 300))))
    elif isinstance(value, str):
        holder[key] = value * rng.choice((2, 200))


def _wrap(rng: random.Random, holder: Any, key: Any) -> None:
    holder[key] = rng.choice(([holder[key]], {"value": holder[key]}, str(holder[key])[:1000]))


def _rescale(rng: random.Random, holder: Any, key: Any) -> None:
    """Change the size of a number or quantity: what was meant in another unit, and what nobody can mean."""
    value, factor = (
        holder[key],
        10.0 ** rng.choice((-300, -100, -30, -9, -3, -1, -0.1, 0.1, 0.3, 1, 3, 9, 30, 100, 300)),
    )
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300:
        holder[key] = type(value)(rng.choice((1, 1, -1)) * value * factor)
    elif isinstance(value, str) and (match := re.match(r"[-+\d.e]+", value)):
        holder[key] = (
            f"{match[0]}e{rng.choice((-300, -30, -9, -6, -3, 3, 6, 9, 30, 300))}{value[match.end() :]}"
        )


def _reunit(rng: random.Random, holder: Any, key: Any) -> None:
    value = holder[key]
    if isinstance(value, str) and value[:1].isdigit():
        holder[key] = f"{value.split()[0]} {rng.choice(UNITS)}"


MUTATIONS: list[Callable[[random.Random, Any, Any], None]] = [
    *(_replace, _replace, _replace, _remove, _misspell, _add, _repeat, _wrap, _rescale, _rescale, _reunit)
]


def _damaged(rng: random.Random, text: bytes) -> bytes:
    """Return a TOML file with one or two mistakes of an editor, a disk or a copy."""
    for _ in range(rng.randint(1, 2)):
        i, j = sorted(rng.randrange(len(text) + 1) for _ in range(2))
        lines = text.splitlines(keepends=True) or [b""]
        line = rng.randrange(len(lines))
        text = rng.choice(
            (
                text[:i],
                text[:i] + text[min(j, i + 40) :],
                text[:i] + bytes([rng.randrange(256)]) + text[i + 1 :],
                text[:i] + rng.choice(SAMPLES).encode() + text[i:],
                b"".join([*lines[:line], lines[line], *lines[line:]]),
                b"".join([*lines[:line], *lines[line + 1 :]]),
                text.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n"))),
                text[:i] + b"[" * DEEP + text[i:],
                "\ufeff".encode() + text,
                text.decode(errors="replace").encode("utf-16"),
            )
        )
    return text
