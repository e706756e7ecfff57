"""The cells of a convergence study: a constant ratio, within the budget, with all else as it was."""

import itertools
from pathlib import Path

import pytest

from pockmark import PockmarkError, Scene
from pockmark.scene.warnings import cells_across
from pockmark.study.levels import axisymmetric, on_cells, plan_of, why_not_axisymmetric

EXAMPLES = Path(__file__).parents[2] / "examples"
NORMAL, QUICK, GROUP = (EXAMPLES / f"{name}.toml" for name in ("normal-2200", "quick", "group-4500"))
TINY_POINTS = ("body.0.spacing='1.25 um'", "grid.cell='2.5 um'", "body.1.spacing='0.625 um'")


def plan(path, *overrides, most=4, budget=240.0, **kwargs):
    made = plan_of(Scene.load(path, overrides), most=most, budget=budget, threads=2, **kwargs)
    print(
        [f"{level.cell * 1e6:.4g} um, {level.expected.seconds:.3g} s" for level in made.levels],
        made.own,
        made.why_3d,
    )
    return made


@pytest.mark.parametrize("in_3d", [True, False])
@pytest.mark.parametrize("budget", [1.0, 10.0, 100.0])
def test_levels_have_one_ratio_and_fit_the_budget(budget, in_3d):
    made = plan(QUICK, budget=budget, in_3d=in_3d)
    cells = [level.cell for level in made.levels]
    assert made.seconds == sum(level.expected.seconds for level in made.levels) <= budget
    assert cells[made.own] == 5e-6
    ratios = [a / b for a, b in itertools.pairwise(cells)]
    assert min(ratios) >= 0.97 * 1.3
    assert max(ratios) <= 2.06
    assert max(ratios) / min(ratios) < 1.1  # cells must divide the grid, so they are not quite at one ratio
    assert all(cells_across(level.scene) >= 4 for level in made.levels)


def test_a_larger_budget_gives_finer_cells():
    finest = [plan(QUICK, budget=budget, in_3d=True).levels[-1].cell for budget in (1.0, 10.0, 100.0)]
    assert finest == sorted(finest, reverse=True)
    assert finest[0] > finest[2]


def test_the_readme_example_fits_five_minutes_on_two_cores():
    made = plan(NORMAL, budget=180.0)  # the command's
    assert not made.why_3d
    assert len(made.levels) == 4
    assert made.levels[0].cell == 4e-6
    assert made.levels[-1].cell < 1e-6
    assert made.seconds < 180


def test_cells_divide_what_the_scene_s_own_divide():
    """Else a coarser cell would leave a gap between the target and a transmitting face, or shift the impact in its cell."""
    made = plan(NORMAL, in_3d=True, budget=1e4)
    for level in made.levels:
        for length in (100e-6, 200e-6):  # to the surface and the axis, and across
            assert length / level.cell == pytest.approx(round(length / level.cell), abs=1e-6)
        assert not any("short of the" in warning for warning in level.expected.warnings)


def test_coarser_cells_are_taken_where_they_are_fine_enough():
    made = plan(QUICK, *TINY_POINTS, in_3d=True, budget=4.5)
    assert made.own > 0
    assert made.levels[0].expected.cells_across >= 4
    assert made.levels[made.own].cell == 2.5e-6


@pytest.mark.parametrize("path", [QUICK, GROUP])
def test_a_level_changes_cells_and_points_alone(path):
    scene = Scene.load(path)
    level = on_cells(scene, scene.grid.cell / 2)
    before, after = scene.to_dict(), level.to_dict()
    for table in (before, after):
        del table["output"]["snapshots"], table["grid"]["cell"]
        for body in table["body"]:
            del body["rounded"]
    spacings = [[body.pop("spacing") for body in table["body"]] for table in (before, after)]
    assert before == after
    assert spacings[1] == [x / 2 for x in spacings[0]]
    assert level.output.snapshots == level.end_time
    assert not any(body.rounded for body in level.body)


def test_bodies_have_one_mass_on_all_cells():
    made = plan(NORMAL, in_3d=True, budget=1e4)
    for i in range(2):
        masses = [level.scene.volume(level.scene.body[i]) for level in made.levels]
        assert masses == pytest.approx([masses[0]] * len(masses), rel=1e-9)


@pytest.mark.parametrize(
    ("path", "overrides", "why"),
    [
        (NORMAL, [], ""),
        (QUICK, [], ""),
        (NORMAL, ["impact.angle='30 deg'"], "normal impact"),
        (GROUP, [], "'swarm': is not round"),
        (
            NORMAL,
            ["body.target.upper=['100 um', '60 um', '0 um']"],
            "reaches to 100 um along x and to 60 um along y",
        ),
        (NORMAL, ["boundary.y_upper='fixed'"], "of different kinds"),
        (NORMAL, ["body.projectile.center=['8 um', '0 um']"], "projectile"),
    ],
)
def test_what_can_be_axisymmetric_is(path, overrides, why):
    scene = Scene.load(path, overrides)
    found = why_not_axisymmetric(scene)
    print(found)
    assert (why in found) if why else not found
    assert "\n" not in found
    made = plan(path, *overrides, budget=1e4)
    assert made.why_3d == found
    assert all(level.scene.grid.is_axisymmetric == (not found) for level in made.levels)


def test_a_scene_that_is_axisymmetric_stays_so():
    scene = axisymmetric(Scene.load(QUICK))
    assert not why_not_axisymmetric(scene)
    made = plan_of(scene, most=3, budget=60.0, threads=2)
    assert all(level.scene.grid.is_axisymmetric for level in made.levels)


@pytest.mark.parametrize(
    ("overrides", "kwargs", "expected"),
    [
        (
            [],
            {"budget": 0.01, "in_3d": True},
            r"--budget: found 0\.01 s, but two cells, 5 um and 3\.85 um, take about \S+ s",
        ),
        (["body.1.radius='5 um'"], {}, "puts 2 cells across the projectile, at least 4 are needed; --coarse"),
    ],
)
def test_what_cannot_be_planned_is_one_sentence(overrides, kwargs, expected):
    with pytest.raises(PockmarkError, match=expected) as caught:
        plan(QUICK, *overrides, **kwargs)
    print(caught.value)
    assert "\n" not in str(caught.value)
    assert plan(QUICK, *overrides, coarse=True).levels
