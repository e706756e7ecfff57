"""The direction of an impact: azimuth, negative angles, and symmetry planes that it may not break."""

import math
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene
from pockmark.run.measured import measure_run
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.setup import setup_of
from pockmark.scene.impact import Impact
from pockmark.view.plots import slice_axis

EXAMPLES = Path(__file__).parents[2] / "examples"


def degrees(angle, azimuth=0.0):
    return Impact(speed=2000.0, angle=f"{angle} deg", azimuth=f"{azimuth} deg")


@pytest.mark.parametrize("angle", [0, 15, 30, 60, -45])
@pytest.mark.parametrize("azimuth", [-360, -270, -180, -90, 0, 90, 180, 270, 360, 37, -123])
def test_the_velocity_is_the_turned_one(angle, azimuth):
    a, b = math.radians(angle), math.radians(azimuth)
    expected = 2000 * np.array([math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), -math.cos(a)])
    assert degrees(angle, azimuth).velocity == pytest.approx(expected, abs=1e-9)


def test_quarter_turns_and_mirror_images_are_exact():
    x, y, z = degrees(30).velocity
    assert y == 0.0
    assert x > 0
    assert degrees(30, 90).velocity == (0.0, x, z)
    assert degrees(30, 180).velocity == (-x, 0.0, z)
    assert degrees(30, 270).velocity == degrees(30, -90).velocity == (0.0, -x, z)
    assert degrees(-30).velocity == (-x, 0.0, z)
    one, other = degrees(30, 40).velocity, degrees(30, -40).velocity
    assert one == (other[0], -other[1], other[2])
    assert degrees(-30).heading == (-1.0, 0.0)
    assert degrees(-30, 90).heading == (0.0, -1.0)


@pytest.mark.parametrize(
    ("face", "angle", "azimuth", "breaks"),
    [
        ("x_lower", 30, 0, True),
        ("x_upper", -30, 0, True),
        ("x_lower", 0, 0, False),
        ("x_lower", 30, 90, True),  # y_lower is a symmetry plane by default
        ("y_lower", 30, 0, False),
        ("y_lower", -30, 180, False),
        ("y_lower", 1e-6, 1, True),
        ("z_lower", 30, 0, False),  # a rigid wall under a normal impact, or a slip plane
    ],
)
def test_an_impact_that_breaks_a_symmetry_plane_is_refused(face, angle, azimuth, breaks):
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    table["boundary"][face] = "symmetry"
    table["impact"] |= {"angle": f"{angle} deg", "azimuth": f"{azimuth} deg"}
    if not breaks:
        Scene.from_dict(table)
        return
    with pytest.raises(PockmarkError, match=r"impact\.angle: .* across the symmetry plane [xy]_") as caught:
        Scene.from_dict(table)
    print(caught.value)
    assert len(str(caught.value)) < 500


def whole(azimuth, angle=30):
    """The whole model of a small oblique impact, turned about z."""
    table = Scene.load(EXAMPLES / "quick.toml").to_dict()
    table["boundary"]["y_lower"] = "transmitting"
    table["grid"] |= {"lower": ["-40 um", "-40 um", "-40 um"], "upper": ["40 um", "40 um", "30 um"]}
    table["body"][0] |= {"lower": ["-40 um", "-40 um", "-40 um"], "upper": ["40 um", "40 um", "0 um"]}
    table["impact"] |= {"angle": f"{angle} deg", "azimuth": f"{azimuth} deg"}
    return Scene.from_dict(table | {"end_time": "12 ns"})


def test_a_turned_impact_leaves_the_turned_crater(tmp_path):
    """e1, e2, depth and all are the same along the heading, wherever that leads; the crater's centre is turned."""
    found = {}
    for azimuth, angle in ((0, 30), (90, 30), (0, -30)):
        folder, _ = run_scene(
            whole(azimuth, angle), tmp_path / f"{azimuth}{angle}", threads=1, progress=False
        )
        found[azimuth, angle] = measure_run(folder.path)["crater"]
    straight, turned, mirrored = found.values()
    for key in ("depth", "diameter", "volume", "e1", "e2", "bottom_x"):
        print(key, *(crater[key] for crater in found.values()))
    for other in (turned, mirrored):
        for key in ("depth", "diameter", "volume"):
            assert other[key] == pytest.approx(straight[key], rel=2e-2)
        assert other["e1"] == pytest.approx(straight["e1"], abs=0.02)
        assert other["uncertainty"]["e1"] == pytest.approx(straight["uncertainty"]["e1"], rel=0.1)
    assert turned["bottom_y"] == pytest.approx(straight["bottom_x"], abs=2e-7)
    assert mirrored["bottom_x"] == pytest.approx(-straight["bottom_x"], abs=2e-7)
    assert plot_run(tmp_path / "9030")[0].exists()
    assert [slice_axis(setup_of(whole(azimuth))) for azimuth in (0, 90, 180, -90)] == [1, 0, 1, 0]


def test_a_group_is_looked_for_where_it_hits():
    """The balls are carried along their own path, whatever the azimuth."""
    ahead, back, turned = (
        np.array(setup_of(Scene.load(EXAMPLES / "group-4500.toml", overrides)).hits)
        for angle, azimuth in ((30, 0), (-30, 0), (30, 180))
        for overrides in [[f"impact.angle='{angle} deg'", f"impact.azimuth='{azimuth} deg'"]]
    )
    reach = 12.5e-6 * math.tan(math.radians(30))
    assert ahead[:, 0].min() == pytest.approx(-37.5e-6 + reach)
    assert back[:, 0].min() == pytest.approx(-37.5e-6 - reach)
    assert np.allclose(back, turned, atol=1e-15)
