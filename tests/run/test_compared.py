"""What a run's crater is compared with: the equations' own numbers, or why there are none."""

import pytest
from rings import small_rings

from pockmark.laws.equations import cour_palais, volume_energy
from pockmark.run.compared import compared, known_as

RESULT = {"crater": {"depth_over_projectile_diameter": 0.8, "depth_over_diameter": 0.58}}


def test_the_equations_are_those_of_the_scene():
    scene = small_rings("4 ns")
    depth, shape = compared(scene, RESULT)
    liu, cour, measured = depth.claims
    ours = next(iter(scene.materials.values()))
    assert liu.low == pytest.approx(
        volume_energy(2200, projectile_density=2785, target_strength=ours.yield_strength), rel=1e-6
    )
    assert cour.low == pytest.approx(
        cour_palais(2200, diameter=20e-6, brinell=120, sound_speed=5328), rel=1e-3
    )
    assert (measured.low, measured.high) == (1.875, 1.875)
    assert "80 times the diameter and 3.18 times the normal speed" in measured.note
    assert depth.over(liu) == pytest.approx(0.8 / liu.low)
    assert [shape.over(claim) for claim in shape.claims] == [pytest.approx(1.16), pytest.approx(1.0)]


def test_a_material_is_known_by_its_equation_of_state_and_its_hardness_by_its_strength():
    changed = {"materials.al2024-t351.strength.A": "300 MPa"}
    depth, _ = compared(small_rings("4 ns").with_(changed), RESULT)
    assert depth.claims[1].low is None
    assert "hardness is not known" in depth.claims[1].note
    assert depth.claims[2].low == 1.875
    other = small_rings("4 ns").with_({"materials.al2024-t351.density": "2 g/cm3"})
    assert known_as(other.materials["al2024-t351"]).kind == ""
    depth, _ = compared(other, RESULT)
    assert "material of unknown kind" in depth.claims[2].note


def test_without_a_crater_nothing_is_compared_but_what_is_claimed_stays():
    depth, _ = compared(small_rings("4 ns"), {"crater": dict.fromkeys(RESULT["crater"])})
    assert depth.value is None
    assert [depth.over(claim) for claim in depth.claims] == [None, None, None]


def test_what_does_not_move_is_compared_with_nothing():
    assert compared(small_rings("4 ns").with_("impact.speed", 0), RESULT) == []
