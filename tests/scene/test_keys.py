"""What is said of each key of a scene is what its declaration allows; docs/input.md says it again. Run as a script it writes it there."""

import re
from pathlib import Path

import pytest

from pockmark import PockmarkError, Scene
from pockmark.base.units import to_si
from pockmark.scene.keys import find, keys
from pockmark.scene.materials import LAWS, library, material
from pockmark.scene.sheet import at_rest, constants

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "input.md"
SECTION = re.compile("(?<=<!-- keys -->\n).*(?=<!-- end of keys -->)", re.DOTALL)
HEADINGS = {"": "The scene itself", "body": "`[[body]]`, of any shape"}
LAW_NAMES = {law["name"] for laws in LAWS.values() for law in laws}


def described():
    """Yield the lines of the page: a table for each table of a scene, without the constants of the laws."""
    shown = [key for key in keys() if key.of not in LAW_NAMES]
    for table in dict.fromkeys(key.table for key in shown):
        yield f"### {HEADINGS.get(table, f'`[{table}]`' if '(' not in table else f'`[[body]]` of shape {table[6:-1]}')}"
        yield ""
        yield "| key | unit | default | allowed | recommended | meaning |"
        yield "|---|---|---|---|---|---|"
        for key in (key for key in shown if key.table == table):
            told = (f"`{key.name}`", key.unit, key.default, key.allowed, key.advice, key.meaning)
            yield f"| {' | '.join(told)} |"
        yield ""


def section():
    return "\n".join(described()) + "\n"


def test_the_page_says_what_is_declared():
    assert SECTION.search(PAGE.read_text(encoding="utf-8"))[0] == section(), f"run {Path(__file__).name}"


def test_every_key_of_a_complete_scene_is_known():
    """A scene with every table, written out: each of its keys is one of the list, and the other way round."""
    known = {key.path for key in keys()} | {"materials.NAME.based_on"}
    found = set()

    def walk(table, path):
        for name, value in table.items():
            if name == "materials":
                for own in value.values():
                    walk(own, "materials.NAME.")
            elif name == "body":
                for own in value:
                    found.update(f"body.{key}" for key in own)
            elif isinstance(value, dict):
                walk(value, f"{path}{name}.")
            else:
                found.add(path + name)

    for path in (ROOT / "examples").glob("*.toml"):
        walk(Scene.load(path, ["contact.friction=0.1"]).to_dict(), "")
    print(f"{len(found)} keys written, {len(known)} known")
    assert len(found) > 60
    assert found <= known


def test_every_key_has_a_meaning():
    assert not [key.path for key in keys() if not key.meaning.endswith(".")]


NUMBERS = [key for key in keys() if re.match(r"-?[\d.e+-]+ to -?[\d.e+-]+( \S+)?$", key.allowed)]


@pytest.mark.parametrize("key", NUMBERS, ids=lambda key: f"{key.path} {key.of}".strip())
def test_what_is_beyond_the_range_is_refused_with_the_keys_name(key):
    """The range that is told is the one that is checked."""
    low, high = (float(number) for number in re.findall(r"-?[\d.]+(?:e[+-]\d+)?", key.allowed)[:2])
    spell = (lambda x: int(x)) if key.name in ("interval", "order", "seed") else float
    for beyond in (low - max(1.0, abs(low)), high * 2 + 1):
        with pytest.raises(PockmarkError, match=rf"\b{key.name}: found .*, (allowed is|input should be)"):
            Scene.from_dict(with_value(key, spell(beyond)))


def with_value(key, value):
    """Return a scene's table in which a key has a value."""
    table = Scene.load(ROOT / "examples" / "quick.toml").to_dict()
    parts = key.path.split(".")
    if parts[0] == "materials":
        kind, law = parts[2], key.of
        mine = table["materials"]["al2024-liu2015"]
        if law and mine[kind]["model"] != law:
            constants = next(one["constants"] for one in LAWS[kind] if one["name"] == law)
            mine[kind] = {c["name"]: c["choices"][0] if c["choices"] else c["most"] for c in constants}
            mine[kind]["model"] = law
        (mine[kind] if len(parts) == 4 else mine)[parts[-1]] = value
    elif parts[0] == "body":
        body = {"shape": key.of or "block", "name": "target", "material": "al2024-liu2015", "spacing": 1e-6}
        table["body"][0] = body | {parts[1]: value}
    else:
        inner = table
        for part in parts[:-1]:
            inner = inner.setdefault(part, {})
        inner[parts[-1]] = value
    return table


def test_ranges_are_tried():
    print(f"{len(NUMBERS)} of {len(keys())} keys")
    assert len(NUMBERS) > 60


@pytest.mark.parametrize(
    ("asked", "paths"),
    [
        ("grid.cell", {"grid.cell"}),
        ("cell", {"grid.cell"}),
        ("[grid]", {"grid.geometry", "grid.lower", "grid.upper", "grid.cell"}),
        ("body.projectile.radius", {"body.radius"}),
        ("body[1].gap", {"body.gap"}),
        ("materials.my-own.eos.c0", {"materials.NAME.eos.c0"}),
        ("spall", {"materials.NAME.failure.pressure"}),
        ("numerics.filter", {f"numerics.filter.{name}" for name in ("interval", "order", "pressure")}),
        ("based_on", {"materials.NAME.based_on"}),
    ],
)
def test_a_key_is_found_as_a_user_calls_it(asked, paths):
    assert {key.path for key in find(asked)} == paths


def test_a_key_of_several_shapes_is_told_for_each():
    assert {key.of for key in find("body.radius")} == {"sphere", "swarm", "cylinder"}


@pytest.mark.parametrize(
    ("asked", "near"),
    [("impact.sped", "impact.speed"), ("grid.cel", "grid.cell"), ("fricton", "contact.friction")],
)
def test_an_unknown_key_is_one_sentence_with_the_nearest(asked, near):
    with pytest.raises(PockmarkError, match=f"{asked}: is no key of a scene, nearest are .*'{near}'"):
        find(asked)


def test_an_empty_or_endless_name_is_one_sentence():
    for asked in ("", ".", "a" * 10_000, "body.target.", "\x1b[31m"):
        with pytest.raises(PockmarkError, match="is no key of a scene"):
            find(asked)


@pytest.mark.parametrize("name", list(library()))
def test_a_sheet_has_each_constant_of_the_material(name):
    """What is shown of a material is what its row in the library says, in SI."""
    shown = {row.key: row for row in constants(material(name))}
    for table, written in library()[name].items():
        for key, value in written.items() if isinstance(written, dict) else ():
            row = shown[f"{table}.{key}"]
            assert row.value == (to_si(value, row.unit) if row.unit else value), row.key
            assert row.meaning
    derived = {row.key: row.value for row in at_rest(material(name))}
    assert derived["impedance"] == pytest.approx(
        material(name).density
        * ((derived["bulk_modulus"] + 4 / 3 * derived["shear_modulus"]) / material(name).density) ** 0.5
    )


def test_an_unknown_material_is_one_sentence_with_the_nearest():
    with pytest.raises(
        PockmarkError, match="al2024: is no material of the library, nearest are al2024-t351, "
    ):
        material("al2024")


if __name__ == "__main__":
    PAGE.write_text(SECTION.sub(lambda _: section(), PAGE.read_text(encoding="utf-8")), encoding="utf-8")
