"""Groups of craters on synthetic surfaces: what is measured and which mode it is must be what was carved."""

from dataclasses import replace

import numpy as np
import pytest

from pockmark.base.geometry import Setup
from pockmark.metrology.modes import THRESHOLDS, measures_of, mode_of
from pockmark.metrology.morphology import measure_group
from pockmark.metrology.results import group_table
from pockmark.metrology.surface import Surface

UM = 1e-6
H, PITCH = 1.0, 25.0  # point spacing and the distance of neighbours, um
GRID = [(x, y) for y in (-37.5, -12.5, 12.5, 37.5) for x in (-37.5, -12.5, 12.5, 37.5)]
INSIDE = [i for i, (x, y) in enumerate(GRID) if abs(x) < 20 and abs(y) < 20]


def carved(floor):
    """Surface at height floor(x, y), um, in nodes H/2 apart."""
    x, y, z = (np.arange(a, b + H / 4, H / 2) for a, b in ((-60, 60), (-60, 60), (-25, 5)))
    height = floor(*np.meshgrid(x, y, indexing="ij"))
    fraction = np.clip(0.5 + (height[:, :, None] - z) / H, 0, 1)
    return Surface(x * UM, y * UM, z * UM, fraction, H * UM)


def bowls(a, b=None, depth=8.0, rim=0.0, centers=GRID, shapes=None, power=2.0):
    """Bowls with semi-axes a, b (um) at z = 0; `shapes` gives some others, {number: (a, b, power)}."""

    def floor(x, y):
        height = np.full(x.shape, rim)
        for n, (cx, cy) in enumerate(centers):
            ax, ay, p = (shapes or {}).get(n, (a, b or a, power))
            radius = (abs((x - cx) / ax) ** p + abs((y - cy) / ay) ** p) ** (1 / p)
            height = np.minimum(height, depth * (radius**2 - 1))
        return height

    return carved(floor)


def grouped(surface, centers=GRID):
    return measure_group(surface, np.array(centers) * UM, PITCH * UM)


def check(surface, number, *, oblique):
    group = grouped(surface)
    measures = measures_of(group)
    mode = mode_of(measures, oblique=oblique)
    print(measures, mode)
    assert mode.number == number
    return group, mode


def counted(group):
    table = group_table(group, Setup(group.spacing, is_oblique=True))
    assert len(table["each_crater"]) == table["craters"]
    assert len(table["each_ridge"]) == table["ridges"]
    return table["craters"], table["pitheads"], table["bottoms"]


def test_separate_bowls_are_measured_one_by_one():
    group, mode = check(bowls(9.0), 1, oblique=False)
    assert len(group.pits) == 16
    assert len(group.ridges) == 24
    for pit, center in zip(group.pits, GRID, strict=True):
        assert np.array(pit.place) / UM == pytest.approx(center, abs=H)
        assert pit.depth / UM == pytest.approx(8.0, abs=H / 2)
        assert pit.ellipse.major / UM == pytest.approx(18.0, abs=H / 2)
        assert pit.ellipse.minor / UM == pytest.approx(18.0, abs=H / 2)
        assert pit.residual < 0.1 * UM
        assert pit.roughness < 0.1 * UM
    assert counted(group) == (16, 16, 16)
    assert all(abs(ridge.height) < 0.3 * UM for ridge in group.ridges)
    assert mode.nearest == 2
    assert mode_of(measures_of(group), oblique=True).number == 1


@pytest.mark.parametrize("oblique", [False, True])
def test_inside_bowls_of_another_shape_are_mode_two(oblique):
    check(bowls(9.0, shapes=dict.fromkeys(INSIDE, (11.0, 9.0, 2.0))), 2, oblique=oblique)


def test_oblique_bowls_that_are_no_ellipses_are_modes_three_and_four():
    check(bowls(10.0, shapes=dict.fromkeys(INSIDE, (10.0, 10.0, 10.0))), 3, oblique=True)
    check(bowls(10.0, power=10.0), 4, oblique=True)


def test_bowls_that_just_touch_are_apart():
    group, _ = check(bowls(12.5), 1, oblique=False)
    assert all(-0.5 < ridge.height / UM <= 0 for ridge in group.ridges)


def rimmed(radius):
    """Bowls with a rim 2 um high just outside."""

    def floor(x, y):
        distances = [np.hypot(x - cx, y - cy) for cx, cy in GRID]
        land = sum(2 * np.exp(-(((r - radius - 1) / 1.5) ** 2)) for r in distances)
        return np.minimum(land, 8 * ((np.min(distances, axis=0) / radius) ** 2 - 1))

    return carved(floor)


def test_bowls_with_one_rim_between_them_touch():
    group, _ = check(rimmed(9.0), 1, oblique=False)
    assert all(ridge.saddle / UM == pytest.approx(2 - 4 * np.exp(-25 / 9), abs=0.3) for ridge in group.ridges)
    group, _ = check(rimmed(11.5), 2, oblique=False)
    assert all(ridge.saddle / UM < 0.3 for ridge in group.ridges)
    crest = 8 * ((12.5 / 11.5) ** 2 - 1)  # where the two bowls would meet
    assert all(ridge.rim / UM == pytest.approx(crest, abs=0.3) for ridge in group.ridges)


def test_bowls_with_a_narrow_neck_touch():
    narrow, wider, widest = (25 / np.sqrt(1 - neck**2) / 2 for neck in (0.4, 0.65, 0.75))
    group, _ = check(bowls(narrow), 2, oblique=False)
    assert {pit.hollow for pit in group.pits} == {group.pits[0].hollow}
    # The necks, on two to four sides of each, take little of it.
    assert [pit.ellipse.major / UM for pit in group.pits] == pytest.approx([2 * narrow] * 16, abs=H)
    check(bowls(wider), 2, oblique=False)
    check(bowls(widest), 3, oblique=False)


def test_bowls_linked_in_one_direction_share_a_hollow():
    group, _ = check(bowls(20.0, 9.0), 5, oblique=True)
    deep = 8.0 * ((12.5 / 20) ** 2 - 1)
    for ridge in group.ridges:
        expected = deep if ridge.along == "x" else 0.0
        assert ridge.height / UM == pytest.approx(expected, abs=H / 2)
    # Each has its own part: the end ones to the edge, the others between their neighbours.
    lengths = np.reshape([np.ptp(pit.contour[:, 0]) / UM for pit in group.pits], (4, 4))
    assert lengths[:, 1:3] == pytest.approx(np.full((4, 2), 25.0), abs=H)
    assert lengths[:, [0, 3]] == pytest.approx(np.full((4, 2), 12.5 + 20.0), abs=H)
    assert counted(group) == (16, 4, 16)
    check(bowls(20.0, 9.0), 3, oblique=False)


def test_bowls_linked_in_both_directions():
    check(bowls(20.0), 6, oblique=True)
    check(bowls(20.0), 3, oblique=False)


@pytest.mark.parametrize(("oblique", "number"), [(False, 4), (True, 7)])
def test_a_common_bottom(oblique, number):
    def plate(x, y):
        inside = np.maximum(abs(x), abs(y)) < 50
        return np.where(inside, -12 - 0.3 * np.cos(2 * np.pi * (x - 12.5) / PITCH), 0.0)

    group, _ = check(carved(plate), number, oblique=oblique)
    assert counted(group) == (16, 1, 1)


def test_a_missing_crater_and_a_flat_target_are_left_out():
    group = grouped(bowls(9.0, centers=GRID[1:]))
    assert len(group.pits) == 15
    assert len(group.ridges) == 22
    assert counted(grouped(carved(lambda x, y: np.zeros(x.shape)))) == (0, 0, 0)


def test_the_roughness_of_a_bottom_is_that_of_its_grooves():
    # Of waves as wide as two nodes, with their crests and troughs on nodes.
    def floor(x, y):
        bowl = 10 * ((np.hypot(x, y) / 22) ** 2 - 1)
        return np.where(bowl < 0, bowl + 0.5 * np.cos(2 * np.pi * x / H), 0)

    group = grouped(carved(floor), [(0.0, 0.0)])
    assert group.pits[0].roughness / UM == pytest.approx(0.5, abs=0.05)


def test_two_balls_in_one_crater_make_one_pit():
    centers = [(0.0, 0.0), (3.0, 1.0), (30.0, 0.0)]
    group = grouped(bowls(9.0, centers=[(1.0, 0.0), (30.0, 0.0)]), centers)
    assert len(group.pits) == 2
    assert len(group.ridges) == 1


def test_the_nearest_mode_is_the_one_across_the_nearest_threshold():
    measures = measures_of(grouped(bowls(9.0)))
    near = replace(measures, unlike=0.09, linked_along=0.1)
    mode = mode_of(near, oblique=True)
    assert (mode.number, mode.nearest) == (1, 2)
    assert mode.distance == pytest.approx(0.1)
    assert mode.roman == "I"
    for name, threshold in THRESHOLDS.items():
        just_over = mode_of(replace(measures, **{name: threshold * 1.01}), oblique=True)
        assert (just_over.number == 1) == (name in ("linked_across", "irregular_outside"))
