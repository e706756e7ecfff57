"""What `pockmark check` warns of before a run, and that a scene is refused whose projectile has too few cells."""

import math
from pathlib import Path

import pytest

from pockmark import PockmarkError, Scene
from pockmark.cli import app
from pockmark.run.pipeline import run_scene
from pockmark.scene.forecast import _memory_warning, available_memory, forecast
from pockmark.scene.prospect import predicted_depth, settling_time
from pockmark.scene.warnings import _particle_speed, cells_across, warnings

EXAMPLES = Path(__file__).parents[2] / "examples"
NORMAL, QUICK = EXAMPLES / "normal-2200.toml", EXAMPLES / "quick.toml"
ENOUGH = ("body.projectile.radius='25 um'", "body.projectile.center=['0 um', '0 um', '25 um']")


def said(path, *overrides):
    found = forecast(Scene.load(path, overrides), 1).warnings
    print(*found, sep="\n")
    assert all(len(text) < 500 for text in found)
    return found


def test_cells_across_a_projectile():
    assert cells_across(Scene.load(NORMAL)) == pytest.approx(5)
    assert cells_across(Scene.load(QUICK, ["body.1.projectile=false"])) is None
    # A flyer: its least side; half of a cube at a symmetry plane is a whole one.
    table = Scene.load(QUICK).to_dict()
    table["body"][1] = {"name": "p", "shape": "block", "lower": ["-10 um", "0 um", "0 um"], "upper": ["10 um", "10 um", "20 um"],
                        "spacing": "1 um", "material": "al2024-liu2015", "projectile": True}  # fmt: skip
    assert cells_across(Scene.from_dict(table)) == pytest.approx(4)


@pytest.mark.parametrize(("radius", "across"), [("9.9 um", "3.96"), ("2.5 um", "1"), ("5 um", "2")])
def test_a_coarse_scene_is_refused_unless_allowed(radius, across, tmp_path):
    keys = (f"body.1.radius='{radius}'", "body.1.rounded=false", "end_time='0.1 ns'")
    scene = Scene.load(QUICK, keys)
    assert any(
        f"{across} cells across the projectile, fewer than 10" in w and "--coarse" in w
        for w in said(QUICK, *keys)
    )
    with pytest.raises(
        PockmarkError,
        match=rf"grid\.cell: 5 um puts {across} cells across .* at least 4 are needed; --coarse",
    ):
        run_scene(scene, tmp_path / "run", threads=1, progress=False)
    assert not (tmp_path / "run").exists()
    assert run_scene(scene, tmp_path / "run", threads=1, progress=False, coarse=True)[1]


def test_resolution_is_warned_of_below_ten_cells():
    assert any(w.startswith("5 cells across the projectile, fewer than 10") for w in said(NORMAL))
    assert not any("cells across" in w for w in said(NORMAL, "grid.cell='2 um'"))


def test_the_frame_is_warned_of_where_it_matters():
    def told(*keys):
        return any("depend on the frame" in w for w in said(NORMAL, *keys))

    paper = "numerics.scheme=paper"
    assert told(paper)
    assert told(paper, "impact.speed='1 km/s'")
    assert told(paper, "impact.speed='4.5 km/s'")
    assert not told(paper, "impact.speed='5 km/s'")
    assert not told(paper, "numerics.shape_functions=quadratic")
    assert not told()


def test_the_shock_is_matched():
    """Like on like half of the speed; the plates of numerics.md: copper on aluminium at 1.7 km/s, 22.44 GPa."""
    used = Scene.load(QUICK, ["body.1.material=cu-ofhc", "impact.speed='1.7 km/s'"])
    al, cu = used.materials["al2024-liu2015"], used.materials["cu-ofhc"]
    assert _particle_speed(al, al, 2200.0) == pytest.approx(1100)
    up = _particle_speed(al, cu, 1700.0)
    assert 2770 * up * (5330 + 1.34 * up) == pytest.approx(22.44e9, rel=0.01)


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        (("impact.speed='6.9 km/s'",), set()),
        (("impact.speed='7.1 km/s'",), {"al2024-liu2015"}),
        (("impact.speed='8 km/s'", "impact.angle='40 deg'"), set()),
        (
            ("impact.speed='5.6 km/s'", "body.1.material=cu-ofhc"),
            {"al2024-liu2015"},
        ),  # copper drives it harder than itself
        (("impact.speed='7.5 km/s'", "body.1.material=cu-ofhc"), {"al2024-liu2015", "cu-ofhc"}),
    ],
)
def test_speed_beyond_the_laws_is_warned_of(keys, names):
    found = [w for w in said(QUICK, *keys) if "its laws are meant for up to" in w]
    assert {w.split("'")[1] for w in found} == names


def test_every_material_of_the_library_has_a_range():
    from pockmark.scene.materials import library

    assert all("max_speed" in table for table in library().values())


def test_a_crater_that_is_not_settled_is_warned_of():
    """Depth over sqrt(Y/rho): 65 ns for the main job, where C_p and D_c are within 2.5 % of those at 500 ns."""
    scene = Scene.load(NORMAL)
    target = scene.materials["al2024-liu2015"]
    depth = predicted_depth(scene, target)
    assert depth == pytest.approx(0.999 * 20e-6, rel=1e-3)
    assert settling_time(depth, target) == pytest.approx(depth / math.sqrt(265e6 / 2770))
    assert any(
        w.startswith("end_time: 60 ns; the crater is settled after about 64.6 ns")
        for w in said(NORMAL, "end_time='60 ns'")
    )
    assert not any("settled" in w for w in said(NORMAL, "end_time='66 ns'"))
    # From 22 um above it arrives 10 ns later.
    assert any("about 74.6 ns" in w for w in said(NORMAL, "end_time='66 ns'", "body.projectile.gap='22 um'"))


def test_a_crater_that_does_not_fit_is_warned_of():
    plate = ("body.target.lower=['-100 um', '0 um', '-38 um']",)
    assert any("body[0] 'target': Eq. 22 predicts a crater 20 um deep, more than half of its thickness, 38 um" in w
               for w in said(NORMAL, *plate))  # fmt: skip
    assert not any("Eq. 22" in w for w in said(NORMAL, "body.target.lower=['-100 um', '0 um', '-42 um']"))
    narrow = ("grid.lower=['-30 um', '0 um', '-100 um']", "body.target.lower=['-30 um', '0 um', '-100 um']")
    assert not any("Eq. 22" in w for w in said(NORMAL, *narrow))
    short = ("grid.upper=['40 um', '100 um', '50 um']", "body.target.upper=['40 um', '100 um', '0 um']")
    assert any(
        "39.9 um wide along x, more than half of the grid, 72 um" in w for w in said(NORMAL, *narrow, *short)
    )
    # Half of the grid hidden by y = 0 counts.
    deep = ("grid.upper=['100 um', '36 um', '50 um']", "body.target.upper=['100 um', '36 um', '0 um']")
    assert any("39.9 um wide along y, more than half of the grid, 72 um" in w for w in said(NORMAL, *deep))


def test_too_little_memory_is_warned_of():
    assert _memory_warning(3 * 2**30, 2 * 2**30) == ["it needs 3,072 MiB of memory, 2,048 MiB are free"]
    assert not _memory_warning(2**30, 2 * 2**30)
    assert not _memory_warning(2**30, None)
    assert available_memory() is None or available_memory() > 2**20
    huge = Scene.load(NORMAL, ["body.target.spacing='0.08 um'", "body.target.rounded=false"])
    assert any("MiB are free" in w for w in forecast(huge, 1).warnings) or available_memory() > 7e11


def test_a_side_short_of_its_face_is_told():
    """The grid's upper corner is rounded up to whole cells: a target that ends where it was written ends short of the face."""
    keys = ("grid.cell='3 um'",)
    assert any("its points end 2 um short of the transmitting face x_upper, at 101 um" in w or
               "its points end 1 um short of the transmitting face x_upper, at 101 um" in w for w in said(NORMAL, *keys))  # fmt: skip


FLYER = {"name": "flyer", "shape": "block", "lower": ["-10 um", "0 um", "0 um"], "upper": ["10 um", "10 um", "20 um"],
         "spacing": "1 um", "material": "al2024-liu2015", "projectile": True}  # fmt: skip


def table_of(path, *overrides, projectile=FLYER):
    """A scene with another projectile."""
    table = Scene.load(path, overrides).to_dict()
    table["body"][1] = projectile
    return Scene.from_dict(table)


def test_a_block_counts_as_the_ball_of_its_volume():
    scene = table_of(NORMAL, "end_time='60 ns'")
    ball = math.cbrt(6 / math.pi) * 20e-6  # of the whole cube: half of it is behind the symmetry plane
    depth = predicted_depth(scene, scene.materials["al2024-liu2015"])
    assert depth == pytest.approx(0.999 * ball, rel=1e-3)
    found = warnings(scene)
    print(found)
    assert any(
        w.startswith("end_time: 60 ns; the crater is settled after about 80.1 ns (by a ball of")
        for w in found
    )
    thin = table_of(NORMAL, "body.target.lower=['-100 um', '0 um', '-40 um']")
    assert any(
        "Eq. 22 predicts a crater 24.8 um deep (by a ball of the projectile's volume), more than half" in w
        for w in warnings(thin)
    )
    # Its middle lies on the plane: as wide as a ball's crater, and no wider.
    keys = (
        "grid.upper=['100 um', '49 um', '50 um']",
        "body.target.upper=['100 um', '49 um', '0 um']",
        "grid.cell='1 um'",
    )
    wide = [w for w in warnings(table_of(NORMAL, *keys)) if "wide along" in w]
    assert len(wide) == 1
    assert "49.6 um wide along y, more than half of the grid, 98 um" in wide[0]


def test_a_target_without_a_yield_strength_has_no_forecast():
    plain = Scene.load(NORMAL).to_dict()
    plain["materials"]["al2024-liu2015"] |= {
        "strength": {"model": "fluid"},
        "failure": {"treatment": "inactive"},
    }
    scene = Scene.from_dict(plain)
    found = [w for w in warnings(scene) if "Eq. 22" in w]
    assert found == [
        "material 'al2024-liu2015' has no yield strength, which Eq. 22 needs: neither the size of a crater in it nor when it has "
        "settled can be forecast"
    ]
    assert not any("settled after" in w for w in warnings(scene))


def test_what_arrives_after_the_end_is_told_without_a_forecast_too():
    plain = Scene.load(NORMAL, ["end_time='5 ns'", "body.projectile.gap='22 um'"]).to_dict()
    plain["materials"]["al2024-liu2015"] |= {
        "strength": {"model": "fluid"},
        "failure": {"treatment": "inactive"},
    }
    assert "end_time: 5 ns; the last projectile is at z = 0 after about 10 ns" in warnings(
        Scene.from_dict(plain)
    )


def test_nothing_is_said_of_a_target_that_is_not_there():
    table = Scene.load(NORMAL).to_dict()
    del table["body"][0]
    found = warnings(Scene.from_dict(table))
    print(found)
    assert not any("under the target's surface" in w for w in found)
    assert any("found no target" in w for w in found)


def rows(scene):
    return dict(forecast(scene, 1).impact)


def test_what_hits_and_how_hard_is_said():
    mass = 2112 * 2 * 1e-18 * 2770  # of the example's half ball
    found = rows(Scene.load(NORMAL, ["impact.angle='30 deg'"]))
    assert found == {
        "speed": "2.2 km/s",
        "angle from the normal": "30 deg",
        "projectile's diameter": "20 um",
        "mass": f"{mass:.4g} kg, mirror images included",
        "energy": f"{0.5 * mass * 2200**2:.4g} J",
    }
    assert rows(table_of(NORMAL))["projectile's diameter"] == "24.81 um, of a ball of its volume"
    swarm = rows(Scene.load(EXAMPLES / "group-4500.toml"))
    assert swarm["largest of 8 projectiles"] == "16 um"
    assert "their energy" in swarm
    assert rows(Scene.load(QUICK, ["body.1.projectile=false"])) == {}


def test_check_prints_what_hits(capsys):
    app(["check", str(NORMAL)], standalone_mode=False)
    text = capsys.readouterr().out
    for name, value in rows(Scene.load(NORMAL)).items():
        assert name in text
        assert value.partition(",")[0] in text
