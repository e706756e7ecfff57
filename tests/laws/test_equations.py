"""Published crater equations against values computed by hand for aluminium on aluminium."""

import pytest

from pockmark.laws.equations import cour_palais, herrmann_jones, summers_charters, volume_energy

# P/d for equal densities, Y = 265 MPa, Brinell 120, C = 5.33 km/s, d = 20 um.
SPEEDS = (700, 1300, 1500, 2000, 2200, 4500, 5000)
TABLE = {
    "volume_energy": (0.465, 0.703, 0.774, 0.937, 0.999, 1.609, 1.726),
    "cour_palais": (0.290, 0.438, 0.481, 0.583, 0.621, 1.001, 1.074),
    "summers_charters": (0.589, 0.890, 0.979, 1.186, 1.264, 2.037, 2.185),
    "herrmann_jones": (0.152, 0.414, 0.506, 0.726, 0.809, 1.535, 1.653),
}
FUNCTIONS = {
    "volume_energy": lambda v: volume_energy(v, projectile_density=2770, target_strength=265e6),
    "cour_palais": lambda v: cour_palais(v, diameter=20e-6, brinell=120, sound_speed=5330),
    "summers_charters": lambda v: summers_charters(v, sound_speed=5330),
    "herrmann_jones": lambda v: herrmann_jones(v, target_density=2770, brinell=120),
}


@pytest.mark.parametrize("name", TABLE)
def test_depth_is_the_published_one(name):
    found = [FUNCTIONS[name](speed) for speed in SPEEDS]
    print(name, [round(x, 4) for x in found])
    assert found == pytest.approx(TABLE[name], abs=6e-4)


def test_densities_and_angle_scale_as_published():
    kwargs = {"diameter": 1e-3, "brinell": 120, "sound_speed": 5330}
    assert cour_palais(5000, angle=1.0, **kwargs) / cour_palais(5000, **kwargs) == pytest.approx(
        0.5403 ** (2 / 3), rel=1e-4
    )
    assert cour_palais(5000, density_ratio=0.5, **kwargs) / cour_palais(5000, **kwargs) == pytest.approx(
        0.5**0.5
    )
    assert cour_palais(5000, density_ratio=2.8, **kwargs) / cour_palais(5000, **kwargs) == pytest.approx(
        2.8 ** (2 / 3)
    )
    double = summers_charters(5000, sound_speed=5330, density_ratio=2) / summers_charters(
        5000, sound_speed=5330
    )
    assert double == pytest.approx(2 ** (2 / 3))
    # Herrmann and Jones: linear in ratio^(2/3) outside the logarithm too.
    a, b = (herrmann_jones(500, target_density=2770, brinell=120, density_ratio=r) for r in (1e-3, 1e-3 * 8))
    assert b / a == pytest.approx(16, rel=0.02)
