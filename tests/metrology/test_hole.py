"""Holes through walls: a hole is told from a crater, and is as wide as it was carved."""

import numpy as np
import pytest

from pockmark import Scene, measure
from pockmark.base.geometry import Mirror, Setup, Wall
from pockmark.metrology.cautions import of_crater, of_hole
from pockmark.metrology.crater import measure_crater
from pockmark.metrology.hole import measure_hole
from pockmark.metrology.morphology import measure_group
from pockmark.metrology.results import group_table, hole_table
from pockmark.metrology.surface import target_filling
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.wall import first_wall, walls

UM = 1e-6
H = 2.0  # point spacing, um
HALF = (Mirror(1, 0.0, above=False),)


def plate(solid, thickness, face=None, mirrors=HALF, sag=None, debris=()):
    """Return the filling of a plate of points at the sub-points of each place where solid(x, y, z) holds (um); `sag`: how far down the
    plate is bent, as a function of x, y."""
    axes = [
        np.arange(a, b, H / 2) + H / 4 for a, b in ((-60, 60), (0 if mirrors else -60, 60), (-thickness, 0))
    ]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    x = x[solid(*x.T)]
    if sag:
        x[:, 2] -= sag(x[:, 0], x[:, 1])
    x = np.concatenate([x, np.reshape(debris, (-1, 3))])
    wall = Wall(
        (0,), (-60 * UM, 0.0 if mirrors else -60 * UM, -thickness * UM), (60 * UM, 60 * UM, 0.0), H * UM, face
    )
    volume = np.full(len(x), (H * UM / 2) ** 3)
    return target_filling(x * UM, volume, Setup(H * UM, mirrors, wall=wall)), wall


def round_hole(radius, tilt=0.0, waist=0.0):
    return lambda x, y, z: np.hypot(x - tilt * z, y) > radius + waist * abs(z + 6)


@pytest.mark.parametrize("thickness", [8, 12, 40])
@pytest.mark.parametrize("face", [None, "free"])
@pytest.mark.parametrize("mirrors", [(), HALF])
def test_a_hole_has_a_width_and_no_depth(thickness, face, mirrors):
    filling, wall = plate(round_hole(9), thickness, face, mirrors)
    surface = filling.surface()
    hole = measure_hole(surface)
    assert measure_crater(surface) is None
    assert hole.count == 1
    assert (hole.width / UM, hole.diameter / UM) == pytest.approx((18, 18), abs=H / 2)
    assert hole.place[:2] == pytest.approx((0, 0), abs=H / 2 * UM)
    u = hole_table(filling, hole)["uncertainty"]["hole_width"] / UM
    print(f"width {hole.width / UM:.2f} +- {u:.2f} of 18 um")
    assert abs(hole.width / UM - 18) < 2 * u < 2 * H
    (sentence,) = of_hole(hole, surface, Setup(H * UM, wall=wall))
    assert "perforated" in sentence


def test_the_least_width_is_at_the_waist():
    hole = measure_hole(plate(round_hole(7, waist=0.5), 12)[0].surface())
    assert hole.width / UM == pytest.approx(14, abs=H / 2)
    assert hole.place[2] / UM == pytest.approx(-6, abs=H)


def test_an_oblique_hole_is_as_wide_as_its_sections():
    hole = measure_hole(plate(round_hole(9, tilt=1.0), 20)[0].surface())
    assert hole.width / UM == pytest.approx(18, abs=H / 2)


def test_holes_are_counted_and_the_widest_is_measured():
    def solid(x, y, z):
        return (
            round_hole(5)(x - 25, y, z) & round_hole(9)(x + 20, y, z) & ((np.hypot(x, y - 30) > 8) | (z < -5))
        )

    surface = plate(solid, 12)[0].surface()
    hole = measure_hole(surface)
    assert hole.count == 2
    assert hole.width / UM == pytest.approx(18, abs=H / 2)
    assert hole.place[0] / UM == pytest.approx(-20, abs=H / 2)
    places = [(-20.0, 0.0), (25.0, 0.0), (0.0, 30.0), (0.0, -30.0)]
    group = measure_group(surface, np.array(places) * UM, 25 * UM)
    table = group_table(group, Setup(H * UM))
    assert (table["holes"], table["craters"]) == (2, 2)
    assert [pit.depth / UM for pit in group.pits] == pytest.approx([5, 5], abs=H / 2)
    assert "mode" not in table


def test_what_is_narrower_than_a_point_spacing_is_no_hole():
    surface = plate(lambda x, y, z: round_hole(0.4)(x, y, z) & ((np.hypot(x, y) > 12) | (z < -4)), 12)[
        0
    ].surface()
    assert measure_hole(surface) is None
    assert measure_crater(surface).depth / UM == pytest.approx(4, abs=H / 2)


def test_a_narrow_channel_below_a_crater_is_found():
    """Coarse cells do not see it: the filling is carried on to the back."""
    surface = plate(lambda x, y, z: round_hole(1.9)(x, y, z) & ((np.hypot(x, y) > 12) | (z < -6)), 40)[
        0
    ].surface()
    assert measure_crater(surface) is None
    assert measure_hole(surface).width / UM == pytest.approx(3.8, abs=H / 2)


def test_a_dome_below_the_back_is_no_hole():
    """A plate of 8 um that is bent down by 20 um is whole, and the deepest point of its front is 20 um down."""
    filling, wall = plate(lambda x, y, z: z < 0, 8, sag=lambda x, y: 20 * np.exp(-(x**2 + y**2) / 15**2))
    surface = filling.surface()
    crater = measure_crater(surface)
    assert measure_hole(surface) is None
    assert crater.depth / UM == pytest.approx(20, abs=H / 2)
    assert any("deeper than half" in s for s in of_crater(crater, surface, Setup(H * UM, HALF, wall=wall)))


def test_debris_below_a_plate_does_not_widen_what_is_looked_at():
    chips = [[x, 3, z] for x in (-50, 0, 50) for z in (-90, -70)]
    plain, scattered = (plate(round_hole(9), 8, debris=d)[0] for d in ((), chips))
    assert scattered.fraction.shape == plain.fraction.shape
    assert measure_hole(scattered.surface()) == measure_hole(plain.surface())


@pytest.mark.parametrize("face", ["transmitting", "fixed", "symmetry"])
@pytest.mark.parametrize("depth", [39.5, 60])
def test_a_crater_at_the_bottom_of_what_is_computed_has_no_depth(face, depth):
    filling, wall = plate(lambda x, y, z: (np.hypot(x, y) > 9) | (z < -depth), 40, face)
    surface = filling.surface()
    assert measure_crater(surface) is None
    assert measure_hole(surface) is None
    (sentence,) = of_hole(None, surface, Setup(H * UM, wall=wall))
    assert "cannot be told" in sentence
    assert face in sentence


def test_a_crater_too_large_says_so():
    filling, wall = plate(lambda x, y, z: (np.hypot(x, y) > 35) | (z < -25), 40, "transmitting")
    surface = filling.surface()
    crater = measure_crater(surface)
    deep, wide = of_crater(crater, surface, Setup(H * UM, HALF, wall=wall))
    assert crater.depth / UM == pytest.approx(25, abs=H / 2)
    assert "deeper than half of the target of 40 um" in deep
    assert "wider than half of the target's 120 um" in wide
    filling, wall = plate(lambda x, y, z: (np.hypot(x, y) > 20) | (z < -15), 40, "transmitting")
    surface = filling.surface()
    assert not [*of_crater(measure_crater(surface), surface, Setup(H * UM, HALF, wall=wall))]
    filling, wall = plate(lambda x, y, z: (abs(y) > 20) | (z < -15 - x / 10), 40, "transmitting")
    surface = filling.surface()
    sentences = [*of_crater(measure_crater(surface), surface, Setup(H * UM, HALF, wall=wall))]
    assert any("floor touches a side face" in s for s in sentences)
    assert any("opening reaches the edge" in s for s in sentences)


TABLE = """
end_time = "16 ns"
impact = {speed = "4 km/s"}
grid = {lower = ["-40 um", "0 um", "-80 um"], upper = ["40 um", "40 um", "24 um"], cell = "4 um"}
boundary = {z_lower = "free"}
body = [
  {name = "rear", shape = "block", lower = ["-40 um", "0 um", "-80 um"], upper = ["40 um", "40 um", "-40 um"], spacing = "4 um", material = "al2024-liu2015"},
  {name = "back", shape = "block", lower = ["-40 um", "0 um", "-8 um"], upper = ["40 um", "40 um", "-4 um"], spacing = "2 um", material = "al2024-liu2015"},
  {name = "front", shape = "block", lower = ["-40 um", "0 um", "-4 um"], upper = ["40 um", "40 um", "0 um"], spacing = "2 um", material = "al2024-liu2015"},
  {name = "ball", shape = "sphere", center = ["0 um", "0 um", "8 um"], radius = "8 um", spacing = "2 um", material = "al2024-liu2015", projectile = true},
]
output = {snapshots = "8 ns", history = "2 ns"}
"""


@pytest.fixture(scope="module")
def whipple(tmp_path_factory):
    """Two layers without a gap in front of a wall of coarser points."""
    folder = tmp_path_factory.mktemp("whipple")
    (folder / "scene.toml").write_text(TABLE)
    return Scene.load(folder / "scene.toml"), folder / "run"


def test_the_first_wall_is_what_touches_at_the_top(whipple):
    wall = first_wall(whipple[0])
    assert wall.bodies == (1, 2)
    assert wall.thickness == pytest.approx(8 * UM)
    assert wall.spacing == pytest.approx(2 * UM)
    assert wall.face is None
    assert walls(whipple[0]) == [(0,), (1, 2)]


def test_a_perforated_wall_in_front_of_another_is_run_measured_and_drawn(whipple):
    scene, path = whipple
    folder, _ = run_scene(scene, path, threads=1, progress=False)
    result = measure(path)
    crater = result["crater"]
    print(crater["hole_width"], crater["uncertainty"], result["warnings"])
    assert crater["perforated"] is True
    assert crater["holes"] == 1
    assert 16 * UM < crater["hole_width"] < 40 * UM
    assert 0 < crater["uncertainty"]["hole_width"] < 4 * UM
    measured = ("depth", "diameter", "volume", "rim_height", "rim_diameter", "e1", "depth_over_diameter")
    assert all(crater[key] is None for key in (*measured, "depth_change_last_tenth"))
    assert result["ejecta"]["beta"] is None
    assert "perforated" in result["warnings"][0]
    assert np.isnan(folder.history("depth")["depth"][-1])
    plot_run(path)
