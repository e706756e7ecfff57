"""Materials: a range for every constant, every mistake in one round, and no law that does nothing."""

import math
from pathlib import Path

import pytest

from pockmark import PockmarkError, Scene
from pockmark.scene.materials import Material, library

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
NAME = "al2024-liu2015"
TABLE = Scene.load(QUICK).to_dict()["materials"][NAME]
KEY = "materials.mine"  # not in the library, which would be put under it
OTHER_LAWS = {
    "eos": {"model": "linear", "bulk_modulus": 75e9},
    "strength": {"model": "elastic", "shear_modulus": 27e9},
}


def numbers(table, prefix=""):
    """The keys of a table that hold numbers, as "eos.c0"."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from numbers(value, f"{prefix}{key}.")
        elif isinstance(value, float):
            yield prefix + key


def with_value(table, key, value):
    first, _, rest = key.partition(".")
    return table | {first: with_value(table[first], rest, value) if rest else value}


def told(table):
    with pytest.raises(PockmarkError) as caught:
        Scene.from_dict(Scene.load(QUICK).to_dict() | {"materials": {"mine": table}})
    print(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500
    return str(caught.value)


def test_there_are_as_many_constants_as_are_tried():
    keys = list(numbers(TABLE))
    print(keys)
    assert len(keys) == 28


@pytest.mark.parametrize("table", [TABLE, TABLE | OTHER_LAWS], ids=["johnson-cook", "linear"])
@pytest.mark.parametrize("value", [1e120, 1e30, -1e30, -1e120, math.inf, math.nan, True])
def test_every_constant_has_a_range(value, table):
    if table is not TABLE:
        table = table | {"failure": {"model": "none"}}
    for key in numbers(table):
        message = told(with_value(table, key, value))
        assert f"{KEY}.{key}: found " in message
        if math.isfinite(value) and value is not True:
            assert f"{KEY}.{key}: found {value!r}, allowed is " in message


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("density", "2770 g/cm^3", "10 to 30000 kg/m^3"),
        ("eos.c0", "5330 km/s", "50 to 100000 m/s"),
        ("eos.c0", 1e-120, "50 to 100000 m/s"),
        ("strength.A", "265 TPa", "1 to 1e+12 Pa"),
        ("strength.n", 0.0, "0.001 to 20"),
        ("thermal.melt_temperature", "1e6 K", "1 to 100000 K"),
        ("thermal.specific_heat", 1e-120, "1 to 100000 J/(kg*K)"),
        ("thermal.taylor_quinney", 1.5, "0 to 1"),
        ("failure.floor", 0.0, "1e-09 to 100"),
    ],
)
def test_a_constant_out_of_its_range_is_told_with_it(key, value, allowed):
    assert f"{KEY}.{key}: found {value!r}, allowed is {allowed}" in told(with_value(TABLE, key, value))


@pytest.mark.parametrize("name", library())
def test_the_library_is_within_the_ranges(name):
    assert Material.model_validate(library()[name]).density > 2000


def test_all_mistakes_of_a_material_are_told_in_one_round():
    table = TABLE | {"density": -1, "strength": {"model": "fluid", "A": 1}}
    table["eos"] = table["eos"] | {"c0": "5 kg"}
    table["thermal"] = table["thermal"] | {"melt_temperature": 200.0}
    table["failure"] = table["failure"] | {"triaxiality_min": 5.0}
    message = told(table)
    for said in ("strength.A: unknown key", "density: found -1", "eos.c0: found '5 kg'"):
        assert f"{KEY}.{said}" in message
    for said in ("failure.triaxiality_max: found 0.333333", "thermal.melt_temperature: found 200 K"):
        assert f"{KEY}.{said}" in message or "and 1 more" in message or "and 2 more" in message


def test_all_mistakes_of_a_scene_are_told_in_one_round():
    changes = [
        "impact.sped=1",
        "end_time='0 s'",
        "body.0.material=cheese",
        "numerics.scheme=mpm",
        "grid.cell=-1",
        "x",
    ]
    with pytest.raises(PockmarkError) as caught:
        Scene.load(QUICK, changes)
    message = str(caught.value)
    print(message)
    for said in (
        "--set x: expected key=value",
        "body[0].material: found 'cheese'",
        "impact.sped: unknown key, did you mean 'speed'?",
        "end_time: found '0 s'",
        "grid.cell: found -1",
    ):
        assert said in message
    assert message.endswith("; and 1 more")


def test_all_faults_between_the_tables_are_told_in_one_round():
    changes = ["grid.upper=['40 um', '50 um', '15 um']", "contact.friction=0", "body.1.projectile=false"]
    with pytest.raises(PockmarkError) as caught:
        Scene.load(QUICK, [*changes, "output.history=1e-30"])
    message = str(caught.value)
    print(message)
    for said in ("face x_upper", "face z_upper", "contact: needs a body", "output.history: found 1e-30 s"):
        assert said in message


def test_many_mistakes_make_a_short_sentence():
    table = Scene.load(QUICK).to_dict()
    table["body"] = [{"shape": "swarm", "name": "x" * 5000, "material": [], "k\n" * 500: 1}] * 200
    with pytest.raises(PockmarkError) as caught:
        Scene.from_dict(table, source="y" * 4000)
    message = str(caught.value)
    print(message)
    assert len(message) < 500
    assert message.isprintable()
    assert message.endswith("more")


@pytest.mark.parametrize(
    ("body", "key"),
    [
        ({"shape": "swarn"}, "body[0].shape: found 'swarn', allowed are 'block', 'sphere', 'swarm'"),
        ({}, "body[0].shape: is missing, allowed are 'block', 'sphere', 'swarm'"),
        ({"shape": "swarm", "pitch": "2 kg"}, "body[0].pitch: found '2 kg'"),
        ({"shape": "swarm", "pich": 1}, "body[0].pich: unknown key, did you mean 'pitch'?"),
        ({"shape": "block", "lower": [0, 0, "1 kg"]}, "body[0].lower[2]: found '1 kg'"),
        ({"shape": "sphere", "projectile": "yes"}, "body[0].projectile: found 'yes'"),
    ],
)
def test_keys_of_every_shape_are_called_by_their_place(body, key):
    table = Scene.load(QUICK).to_dict()
    table["body"] = [{"name": "b", "material": NAME, "spacing": 1e-6} | body]
    with pytest.raises(PockmarkError) as caught:
        Scene.from_dict(table)
    print(caught.value)
    assert key in str(caught.value)


FLUID = {"model": "fluid"}
ELASTIC = {"model": "elastic", "shear_modulus": 27e9}


@pytest.mark.parametrize("treatment", ["no_damage", "signed", "floor", "clamp_triaxiality"])
@pytest.mark.parametrize("strength", [FLUID, ELASTIC], ids=["fluid", "elastic"])
def test_failure_that_cannot_act_is_refused(strength, treatment):
    table = TABLE | {"strength": strength, "failure": TABLE["failure"] | {"treatment": treatment}}
    message = told(table)
    assert f"{KEY}.failure: model 'johnson-cook' cannot act on strength '{strength['model']}'" in message
    assert 'write failure.model = "none"' in message
    assert Material.model_validate(table | {"failure": {"model": "none"}})


def test_failure_from_before_it_had_a_model_is_understood():
    """Scenes and run folders of earlier versions: no model is Johnson and Cook's, treatment "inactive" is none."""
    old = {key: value for key, value in TABLE["failure"].items() if key != "model"}
    assert Material.model_validate(TABLE | {"failure": old}) == Material.model_validate(TABLE)
    inactive = Material.model_validate(TABLE | {"failure": old | {"treatment": "inactive"}})
    assert inactive == Material.model_validate(TABLE | {"failure": {"model": "none"}})


def test_failure_of_the_library_under_another_strength_is_refused():
    change = 'materials.m={based_on="al2024-liu2015", strength={model="fluid"}}'
    with pytest.raises(PockmarkError, match=r"materials\.m\.failure: model 'johnson-cook' cannot act"):
        Scene.load(QUICK, change)


@pytest.mark.parametrize(
    ("constants", "acts"),
    [
        ({}, False),
        ({"D1": -0.77}, False),
        ({"D1": -0.77, "D2": 0.5}, False),
        ({"D1": -0.77, "D2": 0.5, "D3": -1.0}, True),
        ({"D1": 0.05}, True),
        ({"treatment": "floor"}, True),
        ({"D1": -0.1, "D5": -2.0}, True),
    ],
    ids=str,
)
def test_a_failure_strain_that_is_never_positive_is_refused(constants, acts):
    table = TABLE | {"failure": {"treatment": "no_damage"} | constants}
    if acts:
        assert Material.model_validate(table)
    else:
        assert "no failure strain is above 0" in told(table)
