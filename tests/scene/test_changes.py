"""A scene that is made or changed in Python is the one that its file would give, and is checked like it."""

import math
from pathlib import Path

import pytest
from pydantic import ValidationError

from pockmark import (
    Boundary,
    Contact,
    Grid,
    Impact,
    Material,
    PockmarkError,
    Scene,
    bodies,
    example,
    material,
)

UM = 1e-6
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_change_is_what_set_makes_of_the_file(path):
    """And no change, or one that is taken back, gives the same scene."""
    scene = Scene.load(path)
    changed = scene.with_("impact.speed", "3.5 km/s")
    assert changed == Scene.load(path, "impact.speed='3.5 km/s'")
    assert changed.hash != scene.hash
    assert changed.with_("impact.speed", scene.impact.speed) == scene == scene.with_({})


def test_what_must_change_together_is_given_together():
    scene = Scene.load(example("quick"))
    corner = ["-60 um", "0 um", "-60 um"]
    with pytest.raises(PockmarkError, match=r"body\[0\] 'target': reaches 10 um outside"):
        scene.with_("body.target.lower", corner)
    wider = scene.with_({"grid.lower": corner, "body.target.lower": corner})
    assert wider.grid.lower == pytest.approx((-60 * UM, 0, -60 * UM))


def test_what_follows_from_a_flux_follows_anew():
    scene = Scene.load(example("group-4500"))
    fewer = scene.with_("body.swarm.flux", "0.5 mg/cm^2")
    assert fewer.body[1].radius == pytest.approx(scene.body[1].radius / 2 ** (1 / 3))
    assert Scene.from_dict(fewer.to_dict()) == fewer


def test_another_material_comes_from_the_library_and_the_old_one_goes():
    scene = Scene.load(example("rings"))
    changed = scene.with_({"body.wall.material": "cu-ofhc", "body.ball.material": "cu-ofhc"})
    assert list(changed.materials) == ["cu-ofhc"]
    softer = changed.with_("materials.cu-ofhc.strength.A", "50 MPa")
    assert softer.materials["cu-ofhc"].yield_strength == pytest.approx(50e6)
    assert softer.with_({}) == softer


def test_a_table_comes_and_goes():
    scene = Scene.load(example("quick")).with_("contact", {"friction": 0.2})
    assert scene.contact == Contact(friction=0.2)
    assert scene.with_("contact", None) == Scene.load(example("quick"))


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("impact.sped", 3, "impact.sped: unknown key, did you mean 'speed'"),
        ("impact.speed", "3 s", "impact.speed: found '3 s', expected a quantity in m/s"),
        ("impact.speed", None, "impact.speed: found None"),
        ("body.wal.spacing", "1 um", "body.wal: found no such body, allowed are 0 to 1 and wall, ball"),
        ("impact.speed=3", 1, "impact.speed=3: expected a key"),
        ("", 1, "expected key=value"),
        ("body", [], r"body: found \[\], expected one"),
    ],
)
def test_a_slip_is_one_sentence(key, value, sentence):
    with pytest.raises(PockmarkError, match=sentence):
        Scene.load(example("rings")).with_(key, value)


def built(**changes):
    """A scene of the classes alone."""
    wall = bodies.Block(
        name="wall",
        material="cu-ofhc",
        spacing=UM,
        lower=(-30 * UM, 0, -30 * UM),
        upper=(30 * UM, 30 * UM, 0),
    )
    ball = bodies.Sphere(
        name="ball",
        material="al2024-t351",
        spacing=UM / 2,
        center=(0, 0),
        gap=0,
        radius=10 * UM,
        projectile=True,
    )
    grid = Grid(lower=(-30 * UM, 0, -30 * UM), upper=(30 * UM, 30 * UM, 20 * UM), cell=2 * UM)
    parts = {"end_time": 20e-9, "impact": Impact(speed=3e3), "grid": grid, "body": (wall, ball)}
    return Scene(**(parts | changes))


def test_a_scene_of_classes_is_that_of_the_file(tmp_path):
    scene = built(boundary=Boundary(z_lower="free"), impact=Impact(speed="3 km/s", angle="15 deg"))
    assert scene.impact.angle == pytest.approx(math.radians(15))
    scene.save(tmp_path / "scene.toml")
    assert Scene.load(tmp_path / "scene.toml") == scene
    assert set(scene.materials) == {"cu-ofhc", "al2024-t351"}
    assert scene.with_("impact.angle", 0).with_("boundary.z_lower", "transmitting") == built()


def test_a_scene_of_classes_is_checked():
    with pytest.raises(ValidationError, match="a cell of 1e-30 m makes"):
        Grid(lower=(0, 0, 0), upper=(1, 1, 1), cell=1e-30)
    with pytest.raises(ValidationError, match="reaches 10 um outside the grid's face x_lower"):
        built(grid=Grid(lower=(-20 * UM, 0, -30 * UM), upper=(30 * UM, 30 * UM, 20 * UM), cell=2 * UM))
    ball = bodies.Sphere(name="b", material="unknown", spacing=UM, center=(0, 0, 10 * UM), radius=10 * UM)
    with pytest.raises(ValidationError, match="found 'unknown', which is not among the materials"):
        built(body=(ball,))


def test_a_scene_takes_a_material_of_ones_own():
    mine = material("cu-ofhc").with_("strength.A", "120 MPa")
    assert isinstance(mine, Material)
    assert mine.yield_strength == pytest.approx(120e6)
    assert built(materials={"cu-ofhc": mine}).materials["cu-ofhc"] == mine


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("density", "3 m", "material: density: found '3 m', expected a quantity in kg/m\\^3"),
        ("strength.AA", 3, "material: strength.AA: unknown key, did you mean 'A'"),
        ("strength.model", "fluid", "cannot act on strength 'fluid'"),
    ],
)
def test_a_slip_in_a_material_is_one_sentence(key, value, sentence):
    with pytest.raises(PockmarkError, match=sentence):
        material("cu-ofhc").with_(key, value)
