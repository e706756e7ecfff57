"""Axisymmetric scenes: the slice that is computed, masses, what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene
from pockmark.run.points import make_points
from pockmark.run.setup import setup_of
from pockmark.scene.forecast import forecast

EXAMPLES = Path(__file__).parents[2] / "examples"
NORMAL, GROUP = EXAMPLES / "normal-2200.toml", EXAMPLES / "group-4500.toml"
TURNED = "grid.geometry=axisymmetric"
UM = 1e-6


def turned(*sets, path=NORMAL):
    return Scene.load(path, [TURNED, *sets])


def test_the_half_model_of_the_paper_becomes_a_slice_from_its_axis():
    scene = turned()
    h = scene.grid.cell
    assert scene.grid.box == (
        (0.0, -h / 2, pytest.approx(-100 * UM)),
        (pytest.approx(100 * UM), h / 2, pytest.approx(52 * UM)),
    )
    assert scene.grid.cells == (25, 1, 38)
    assert scene.boundary.faces == (
        "symmetry",
        "transmitting",
        "symmetry",
        "symmetry",
        "transmitting",
        "free",
    )
    assert scene.mirrors == ()
    assert forecast(scene, 1).points == 50 * 50 + 158


@pytest.mark.parametrize("lower", ["-100 um", "0 um"])
def test_a_whole_and_a_quarter_model_give_the_same_slice(lower):
    quarter = (
        f"grid.lower=['{lower}', '{lower}', '-100 um']",
        f"body.target.lower=['{lower}', '{lower}', '-100 um']",
    )
    scene = turned(*quarter)
    position, volume = scene.filled(scene.body[0])
    there, known = turned().filled(turned().body[0])
    assert np.array_equal(position, there)
    assert np.array_equal(volume, known)


def test_what_is_saved_is_read_as_the_same_scene():
    scene = turned()
    again = Scene.from_dict(scene.to_dict())
    assert again == scene
    assert again.hash == scene.hash
    assert Scene.from_dict(scene.to_dict(), overrides=["grid.cell='2 um'"]) == turned("grid.cell='2 um'")


def test_a_scene_of_three_dimensions_keeps_the_name_it_had():
    """Its hash says which run is its, and was there before the key."""
    paper = "numerics.scheme=paper"
    scene = Scene.load(NORMAL, [paper])
    assert scene.hash == "ae9f9d6b11a15859"
    assert Scene.load(NORMAL, [paper, "grid.geometry='3d'"]).hash == scene.hash != turned(paper).hash


@pytest.mark.parametrize("spacing", ["1 um", "0.7 um", "0.3 um"])
@pytest.mark.parametrize("rounded", ["true", "false"])
def test_bodies_have_the_mass_that_is_asked(spacing, rounded):
    """A disk's rings always, a ball's share its volume; those of a rounded one come within 3 % at these spacings."""
    sets = [
        f"body.{name}.{key}"
        for name in ("target", "projectile")
        for key in (f"spacing='{spacing}'", f"rounded={rounded}")
    ]
    scene = turned(*sets)
    disk, ball = (scene.volume(body) for body in scene.body)
    print(f"{spacing} rounded {rounded}: ball {ball / (4 / 3 * math.pi * (10 * UM) ** 3):.5f} of its volume")
    if rounded == "false":
        assert disk == pytest.approx(math.pi * (100 * UM) ** 2 * 100 * UM, rel=1e-12)
        assert ball == pytest.approx(4 / 3 * math.pi * (10 * UM) ** 3, rel=1e-12)
    else:
        length = scene.body[0].fits[0].length, scene.body[0].fits[2].length, scene.body[1].fit.length
        assert disk == pytest.approx(math.pi * length[0] ** 2 * length[1], rel=1e-12)
        assert ball == pytest.approx(4 / 3 * math.pi * length[2] ** 3, rel=0.03)
    assert setup_of(scene).projectile_mass == pytest.approx(ball * 2770)


def test_a_cylinder_and_a_tube_are_rings_too():
    tube = [
        "body.projectile.shape='cylinder'",
        "body.projectile.length='6 um'",
        "body.projectile.inner_radius='4 um'",
    ]
    scene = turned(*tube, "body.projectile.rounded=false")
    assert scene.volume(scene.body[1]) == pytest.approx(math.pi * (100 - 16) * 6 * UM**3, rel=1e-12)
    r = scene.filled(scene.body[1])[0][:, 0]
    assert 4 * UM < r.min() < r.max() < 10 * UM


def test_points_lie_in_the_middle_of_the_slice_at_their_density():
    scene = turned()
    for points in make_points(scene):
        assert not points.position[:, 1].any()
        assert (points.position[:, 0] > 0).all()
        assert np.array_equal(points.mass, points.volume * 2770.0)


@pytest.mark.parametrize(
    ("sets", "said"),
    [
        (["impact.angle='15 deg'"], r"impact\.angle: found 15 deg"),
        (["impact.azimuth='90 deg'"], r"impact\.azimuth: found 90 deg"),
        (["numerics.mass_cutoff=0.01"], r"numerics\.mass_cutoff: found 0\.01"),
        (["body.projectile.center=['1 um', '0 um']"], r"body\[1\] 'projectile': is not round about the axis"),
        (["body.target.lower=['-100 um', '0 um', '-50 um']", "body.target.upper=['60 um', '1 um', '0 um']"], r"body\[0\] 'target': reaches from x = -0.0001 m to 6e-05 m"),
        (["body.target.velocity=['1 m/s', '0 m/s', '0 m/s']"], r"body\[0\] 'target': its velocity has a part along x or y"),
        (["grid.lower=['10 um', '0 um', '-100 um']"], r"grid\.lower, grid\.upper: found x from 1e-05 m to 0\.0001 m"),
        (["grid.geometry='spherical'"], r"grid\.geometry: found 'spherical'"),
        (["body.target.upper=['200 um', '100 um', '0 um']", "body.target.lower=['-200 um', '0 um', '-100 um']"], r"outside the grid's face x_upper"),
    ],
)  # fmt: skip
def test_what_cannot_be_axisymmetric_is_refused_in_a_sentence(sets, said):
    with pytest.raises(PockmarkError, match=said):
        turned(*sets)


def test_a_swarm_is_refused():
    with pytest.raises(PockmarkError, match=r"body\[1\] 'swarm': is not round about the axis"):
        turned(path=GROUP)


def test_bodies_that_meet_are_told_as_ever():
    """A rod within the room of a tube is none of those, its box in that of the tube or not."""
    part = {
        "shape": "cylinder",
        "material": "al2024-liu2015",
        "spacing": "1 um",
        "length": "10 um",
        "projectile": True,
    }
    table = Scene.load(NORMAL).to_dict()
    tube = part | {
        "name": "tube",
        "center": [0, 0],
        "gap": "1 um",
        "radius": "20 um",
        "inner_radius": "12 um",
    }
    table["body"].append(tube)
    assert len(Scene.from_dict(table, overrides=[TURNED]).body) == 3
    table["body"][-1] = tube | {"inner_radius": "8 um"}
    with pytest.raises(PockmarkError, match=r"overlaps body\[1\]"):
        Scene.from_dict(table, overrides=[TURNED])


def test_a_body_may_move_along_the_axis():
    assert turned("body.target.velocity=['0 m/s', '0 m/s', '-5 m/s']").body[0].velocity[2] == -5
