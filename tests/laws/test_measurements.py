"""What is measured elsewhere: each row whole and with its source, the nearest found."""

import math

import pytest

from pockmark.laws.measurements import hardness, measurements, near
from pockmark.scene.materials import library

DEPTH, SHAPE = "depth_over_projectile_diameter", "depth_over_diameter"


def test_each_row_is_whole_and_has_its_source():
    for row in measurements():
        assert row.quantity in (DEPTH, SHAPE)
        assert row.source
        assert row.note
        assert 0 < row.low <= row.high
        assert bool(row.projectile) == bool(row.diameter) == bool(row.speed)
    for name, known in hardness().items():
        assert name in library(), "a material that the library does not have"
        assert (known.brinell is None) == (not known.source)
    assert hardness().keys() == library().keys()


def test_the_nearest_in_size_and_speed_comes_first_then_those_of_unknown_projectiles():
    found = near(SHAPE, "aluminium", "aluminium", diameter=20e-6, speed=2200)
    assert [row.projectile for row in found] == ["aluminium", ""]
    assert found[0].distance(5e-3, 7350) == 0
    assert found[0].distance(20e-6, 2200) == pytest.approx(math.hypot(math.log(250), math.log(7350 / 2200)))
    assert math.isinf(found[1].distance(20e-6, 2200))


def test_nothing_is_found_of_a_pair_that_nobody_measured():
    assert near(DEPTH, "copper", "copper", diameter=1e-3, speed=5e3) == ()
