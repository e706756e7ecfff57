"""Scenes: round trip, the paper's point counts, and one clear sentence for each mistake."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene
from pockmark.base.units import to_si
from pockmark.run.points import make_points
from pockmark.scene.bodies import Block, Sphere
from pockmark.scene.materials import library
from pockmark.scene.overrides import override

EXAMPLES = Path(__file__).parents[2] / "examples"
UM = 1e-6


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.stem)
def test_a_saved_scene_is_the_same_scene(path, tmp_path):
    scene = Scene.load(path)
    scene.save(tmp_path / "again.toml")
    assert Scene.load(tmp_path / "again.toml") == scene


@pytest.mark.parametrize(
    "name",
    ["aluminium 2024", "Stahl-\u00fc", "\U0001d50cl", "a.b", 'say "x"', "tab\there", "\x7f", "", "\u00b2"],
)
def test_a_scene_with_any_name_is_read_back(name, tmp_path):
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    table["title"] = table["body"][0]["name"] = table["body"][0]["material"] = name
    table["materials"][name] = table["materials"]["al2024-liu2015"]
    scene = Scene.from_dict(table)
    scene.save(tmp_path / "again.toml")
    assert Scene.load(tmp_path / "again.toml") == scene


def test_model_1_is_the_papers():
    scene = Scene.load(EXAMPLES / "normal-2200.toml")
    pieces = list(make_points(scene))
    count = sum(len(piece.mass) for piece in pieces)
    print(f"model 1: {count} points, {scene.grid.cell_count} cells")
    assert count == 252_112
    assert scene.grid.cells == (50, 25, 38)
    target = sum(piece.mass[piece.body == 0].sum() for piece in pieces)
    assert np.isclose(target, 2770 * 200e-6 * 100e-6 * 100e-6)


def test_the_group_is_the_papers():
    scene = Scene.load(EXAMPLES / "group-4500.toml")
    assert sum(len(piece.mass) for piece in make_points(scene)) == 267_408
    assert scene.grid.cell_count == 47_500


# Tables 2 and 3 of the paper: target points of models 1-3, and whole spheres of nx points a radius.
@pytest.mark.parametrize(("h", "count"), [(2.0, 250_000), (1.5, 133 * 67 * 67), (1.0, 2_000_000)])
def test_block_lattice(h, count):
    block = Block(
        shape="block",
        name="t",
        material="m",
        spacing=h * UM,
        lower=(-100 * UM, 0, -100 * UM),
        upper=(100 * UM, 100 * UM, 0),
        rounded=True,
    )
    assert len(block.lattice()) == count


@pytest.mark.parametrize(
    ("nx", "count"), [(10, 4224), (13, 9328), (20, 33552), (8, 2176), (11, 5616), (16, 17256)]
)
def test_sphere_lattice(nx, count):
    sphere = Sphere(
        shape="sphere", name="p", material="m", spacing=UM, center=(0, 0, nx * UM), radius=nx * UM
    )
    assert len(sphere.lattice()) == count


@pytest.mark.parametrize("radius", [0.6, 1.0, 3.3, 10.0, 16.4])
@pytest.mark.parametrize("cut", [-100.0, 0.0, 2.7])
def test_a_sphere_is_counted_as_it_is_filled(radius, cut):
    sphere = Sphere(
        shape="sphere", name="p", material="m", spacing=UM, center=(2 * UM, 0, 1 * UM), radius=radius * UM
    )
    box = ((-100 * UM, cut * UM, -100 * UM), (4.5 * UM, 100 * UM, 100 * UM))
    x = sphere.lattice()
    x = x[np.all((x >= box[0]) & (x < box[1]), axis=1)]
    assert np.array_equal(x, sphere.lattice(box))
    assert sphere.count(box) == len(x)


@pytest.mark.parametrize("spacing", [0.7, 1.0, 1.3, 2.9, 7.0, 25.0])
def test_a_block_is_counted_as_it_is_filled(spacing):
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    block = Block(**table["body"][0] | {"spacing": spacing * UM})
    box = Scene.load(EXAMPLES / "quick.toml").grid.box
    assert block.count(box) == len(block.lattice(box)) == len(block.lattice()) > 0


def test_units_are_exact_and_checked():
    assert to_si("20 um", "m") == 20e-6
    assert to_si("2.2 km/s", "m/s") == 2200.0
    assert to_si("15 deg", "rad") == pytest.approx(np.pi / 12, rel=1e-15)
    assert to_si(3, "m") == 3.0
    with pytest.raises(ValueError, match="expected a quantity in m/s"):
        to_si("2 km", "m/s")


def test_every_library_material_is_valid_and_cited():
    for name in library():
        scene = Scene.load(EXAMPLES / "quick.toml", [f"body=[{_block(name)}]"])
        assert len(scene.materials[name].source) > 20
        scene.materials[name].to_core()


@pytest.mark.parametrize("body", ["1", "projectile"])
def test_a_body_is_changed_by_place_or_name(body):
    scene = Scene.load(EXAMPLES / "quick.toml", [f"body.{body}.radius='5 um'", f"body.{body}.spacing=1e-6"])
    assert (scene.body[1].radius, scene.body[1].spacing) == (5e-6, 1e-6)
    assert scene.body[0] == Scene.load(EXAMPLES / "quick.toml").body[0]


DOTTED = [
    ("a.b", """body."a.b".radius='5 um'"""),
    ("a.b", "body . 'a.b' . radius = '5 um'"),
    ("a=b", """body."a=b".radius='5 um'"""),
    ('say "x"', """body.'say "x"'.radius='5 um'"""),
    ('say "x"', """body.say "x".radius='5 um'"""),
    ("my ball", "body.my ball.radius='5 um'"),
    ("Stahl-\u00fc", "body.Stahl-\u00fc.radius='5 um'"),
    ("tab\there", """body."tab\\there".radius='5 um'"""),
    ("", """body."".radius='5 um'"""),
    ("1", "body.1.radius='5 um'"),  # its place, too
    ("a.b", "body={'a.b'={radius='5 um'}}"),
]


@pytest.mark.parametrize(("name", "change"), DOTTED)
def test_a_body_of_any_name_is_changed_by_its_quoted_name(name, change):
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    table["body"][1]["name"] = name
    scene = Scene.from_dict(table, overrides=change)
    assert scene.body[1].radius == 5e-6
    assert scene.body[0] == Scene.from_dict(table).body[0]


@pytest.mark.parametrize(
    ("names", "key", "sentence"),
    [
        (
            ("1", "ball"),
            "1",
            "body.1: found body[0] '1' and body[1] 'ball', expected a name, or a place counted",
        ),
        (("1", "0"), "0", "body.0: found body[0] '1' and body[1] '0', expected"),
        (("1", "ball"), '"1"', "body.1: found body[0] '1' and body[1] 'ball', expected"),
        (("x", "x"), "x", "body.x: found body[0] 'x' and body[1] 'x', expected"),
        (("t", "a.b"), "a.b", 'body.a: found no such body, allowed are 0 to 1 and t, "a.b"'),
        (("t", "a.b"), "'a.c'", 'body."a.c": found no such body, allowed are 0 to 1 and t, "a.b"'),
    ],
)
def test_a_key_that_means_two_bodies_or_none_is_refused(names, key, sentence):
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    for body, name in zip(table["body"], names, strict=True):
        body["name"] = name
    with pytest.raises(PockmarkError) as caught:
        Scene.from_dict(table, overrides=f"body.{key}.spacing='2 um'")
    print(caught.value)
    assert str(caught.value).startswith(f"scene: {sentence}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["", "=", "x", "x.=1", ".x=1", "a..b=1", "a. .b=1", "'a=1", "'a'b=1", ' "a.b=1', '"\\q"=1', '"a\nb"=1',
     '""""=1', ".".join("a" * 21) + "=1"],
)  # fmt: skip
def test_what_is_no_change_is_told(text):
    with pytest.raises(PockmarkError, match=r"^--set .*: expected key=value$"):
        override({}, text)


def test_the_keys_of_a_change_are_as_many_as_its_dots():
    assert override({}, ".".join("a" * 20) + "=1")
    assert override({}, " a . 'b.c' . d e = x=y") == {"a": {"b.c": {"d e": "x=y"}}}


def test_one_override_may_be_a_plain_text():
    assert Scene.load(EXAMPLES / "quick.toml", "impact.speed=1000").impact.speed == 1000


def _block(material: str) -> str:
    return (
        f'{{name="b", shape="block", material="{material}", spacing=5e-6, '
        "lower=[-5e-5,0.0,-5e-5], upper=[5e-5,5e-5,0.0]}"
    )


def test_a_library_material_can_be_overridden():
    scene = Scene.load(EXAMPLES / "quick.toml", ["materials.al2024-liu2015.failure.treatment=signed"])
    assert scene.materials["al2024-liu2015"].failure.treatment == "signed"
    assert scene.materials["al2024-liu2015"].failure.D1 == -0.77


MISTAKES = [
    ("grid.cel='4 um'", "grid.cel: unknown key, did you mean 'cell'?"),
    ("impact.speed='2 km'", "impact.speed: found '2 km', expected a quantity in m/s"),
    ("impact.speed='fast'", "impact.speed: found 'fast', which is not a quantity"),
    ("grid.cell='-4 um'", "grid.cell: found '-4 um', input should be greater than 0"),
    ("grid.upper=['50 um', '50 um', '10 um']", "outside the grid's face z_upper"),
    ("body=[]", "body: found [], expected one [[body]] or more"),
    ("body=3", "body: found 3, expected one [[body]] or more"),
    ("body.1=3", "body[1]: found 3, expected a table"),
    ("body.1.shape=cube", "body[1].shape: found 'cube', allowed are 'block', 'sphere'"),
    (
        "body=[{name='x', material='al2024-liu2015'}]",
        "body[0].shape: is missing, allowed are 'block', 'sphere'",
    ),
    (
        "body.1.material=cheese",
        "body[1].material: found 'cheese', which is neither in the scene nor in the library",
    ),
    (
        "materials.al2024-liu2015.eos.model=gas",
        "eos.model: found 'gas', allowed are 'mie-gruneisen', 'linear'",
    ),
    ("materials.al2024-liu2015.strength={model='fluid', A=1}", "strength.A: unknown key"),
    ("materials.linear={based_on='al2024-liu2015', density=-1}", "materials.linear.density: found -1"),
    (
        "impact.angle='95 deg'",
        "impact.angle: found 95 deg, expected more than -90 deg and less than 90 deg",
    ),
    ("impact.angle='-90 deg'", "impact.angle: found -90 deg, expected more than -90 deg and less"),
    ("impact.azimuth='361 deg'", "impact.azimuth: found 361 deg, expected -360 deg to 360 deg"),
    (
        "impact={speed='1 km/s', angle='30 deg', azimuth='90 deg'}",
        "impact.angle: 30 deg at an azimuth of 90 deg moves the projectiles across the symmetry plane y_lower",
    ),
    ("body.1.center=['0 um', '0 um']", "body[1]: needs either a center of x, y and z, or one of x and y"),
    ("body.1.gap='0 um'", "body[1]: needs either a center of x, y and z, or one of x and y with gap"),
    ("body.1.gap='-1 um'", "body[1].gap: found '-1 um', input should be greater than or equal to 0"),
    ("body.1.center=['0 um']", "body[1]: needs either a center of x, y and z, or one of x"),
    (
        "numerics.scheme=mpm",
        "numerics.scheme: found 'mpm', input should be 'usf', 'musl', 'usl', 'usavg' or 'paper'",
    ),
    ("end_time='0 s'", "end_time: found '0 s'"),
    ("materials.x.based_on=unobtainium", "materials.x.based_on: found 'unobtainium'"),
    ("body.2.radius=1", "body.2: found no such body, allowed are 0 to 1 and target, projectile"),
    ("nonsense", "--set nonsense: expected key=value"),
    ("grid=3", "grid: found 3, expected a table"),
    ("materials.al2024-liu2015.eos.c0='5 kg'", "eos.c0: found '5 kg', expected a quantity in m/s"),
]


@pytest.mark.parametrize(("override", "sentence"), MISTAKES)
def test_a_mistake_is_one_sentence_with_file_and_key(override, sentence):
    path = EXAMPLES / "quick.toml"
    with pytest.raises(PockmarkError) as caught:
        Scene.load(path, [override])
    message = str(caught.value)
    print(message)
    assert message.startswith(f"{path}: ")
    assert sentence in message
    assert "\n" not in message


def test_missing_material_and_overlap_are_told():
    text = (EXAMPLES / "quick.toml").read_text()
    for old, new, sentence in [
        (
            'material = "al2024-liu2015"\n\n',
            'material = "cheese"\n\n',
            "body[0].material: found 'cheese', which is neither",
        ),
        (
            '"0 um", "0 um", "10 um"',
            '"0 um", "0 um", "5 um"',
            "body[1] 'projectile': overlaps body[0] 'target'",
        ),
        ('radius = "10 um"\n', "", "body[1].radius: is missing"),
    ]:
        changed = text.replace(old, new)
        assert changed != text
        with pytest.raises(PockmarkError, match="scene: ") as caught:
            Scene.from_dict(tomllib.loads(changed))
        assert sentence in str(caught.value)


def test_an_unknown_key_is_told_before_the_one_that_it_leaves_out():
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    table["impact"]["sped"] = table["impact"].pop("speed")
    with pytest.raises(PockmarkError, match=r"scene: impact\.sped: unknown key, did you mean 'speed'\?"):
        Scene.from_dict(table)


def test_unreadable_files_are_told(tmp_path):
    with pytest.raises(PockmarkError, match="cannot be read"):
        Scene.load(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("a = = 1")
    with pytest.raises(PockmarkError, match="is not TOML"):
        Scene.load(tmp_path / "bad.toml")


def test_the_default_is_changed_by_what_does_not_go_with_it():
    """Quadratic functions take the mean at nodes, USL each point's own gradient; what is written counts, and is refused."""
    quick = EXAMPLES / "quick.toml"
    told = [
        (of.node_velocity, of.volumetric_strain, of.filter.interval)
        for changes in ([], ["numerics.shape_functions=quadratic"], ["numerics.scheme=usl"])
        for of in [Scene.load(quick, changes).numerics]
    ]
    assert told == [("linear", "cells", 10), ("mean", "cells", 10), ("linear", "points", 10)]
    with pytest.raises(PockmarkError, match="found 'cells' with scheme 'usl'"):
        Scene.load(quick, ["numerics.scheme=usl", "numerics.volumetric_strain=cells"])


def test_the_paper_s_scheme_is_a_name_for_what_it_does():
    """What is written beside it counts; the scene has the hash of one that spells it out."""
    plain = [
        "numerics.scheme=usavg",
        "numerics.volumetric_strain=points",
        "numerics.node_velocity=mean",
        "numerics.filter.interval=0",
    ]
    named, spelled = (
        Scene.load(EXAMPLES / "quick.toml", changes) for changes in (["numerics.scheme=paper"], plain)
    )
    assert named.numerics == spelled.numerics
    assert named.hash == spelled.hash
    changed = Scene.load(
        EXAMPLES / "quick.toml", ["numerics.scheme=paper", "numerics.volumetric_strain=cells"]
    )
    assert (changed.numerics.scheme, changed.numerics.volumetric_strain) == ("usavg", "cells")
    filtered = Scene.load(EXAMPLES / "quick.toml", ["numerics.scheme=paper", "numerics.filter.order=4"])
    assert (filtered.numerics.filter.interval, filtered.numerics.filter.order) == (0, 4)
