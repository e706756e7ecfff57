"""What a reader asks of a material: its constants with their meanings, and what follows from them."""

from collections.abc import Iterator
from functools import reduce
from typing import NamedTuple

from .keys import NAMED, keys
from .materials import Material

TEXTS = ("source", "based_on", "max_speed")  # what a list of constants leaves out


class Row(NamedTuple):
    """A value of a material, with its unit and its meaning. A value that there is none of is None."""

    key: str
    value: float | str | None
    unit: str
    meaning: str


def constants(material: Material) -> Iterator[Row]:
    """Give each constant of a material, by its key."""
    own = dict(zip(("eos", "strength", "failure"), material.laws, strict=True))
    for key in keys():
        parts = key.path.split(".")
        if parts[:2] != ["materials", NAMED] or parts[2] in TEXTS or (key.of and key.of != own[parts[2]]):
            continue
        value = reduce(getattr, parts[2:], material)
        yield Row(".".join(parts[2:]), value, key.unit, key.meaning)  # type: ignore[arg-type]


def at_rest(material: Material) -> Iterator[Row]:
    """Give what follows from the constants of a material at rest."""
    yield Row("bulk_modulus", material.bulk_modulus, "Pa", "Bulk modulus of its equation of state.")
    yield Row("shear_modulus", material.shear_modulus, "Pa", "Shear modulus.")
    yield Row("yield_strength", material.yield_strength, "Pa", "Flow stress without plastic strain.")
    speed = material.dilatational_speed
    yield Row("dilatational_speed", speed, "m/s", "Speed of P waves.")
    yield Row("impedance", material.density * speed, "kg/(m^2*s)", "Density times that speed.")
