"""Scaling laws of Liu et al. 2015, Section 4.3, against the paper's own numbers, and fits of what is known."""

import math

import numpy as np
import pytest

from pockmark.laws.scaling import energy_flux, fit_depth, group_depth
from pockmark.scene.bodies.placement import sphere_diameter

MG_CM2 = 1e-2  # kg/m^2
J_CM2 = 1e4  # J/m^2
ROOT = math.sqrt(2770 / 265e6)


@pytest.mark.parametrize(
    ("flux", "speed", "angle", "total", "normal"),
    [(0.1, 700, 0, 0.0245, 0.0245), (1.0, 4500, 15, 10.1, 9.46), (0.5, 2200, 30, 1.21, 0.908)],
)
def test_energy_fluxes_are_those_of_table_5(flux, speed, angle, total, normal):
    found = energy_flux(flux * MG_CM2, speed, math.radians(angle))
    print(f"{found[0] / J_CM2:.4f}, {found[1] / J_CM2:.4f} J/cm^2")
    assert found[0] / J_CM2 == pytest.approx(total, rel=5e-3)
    assert found[1] / J_CM2 == pytest.approx(normal, rel=5e-3)


def test_diameters_are_those_of_equation_29():
    found = [1e6 * sphere_diameter(f * MG_CM2, area=1e-8, number=16, density=2770) for f in (0.1, 0.5, 1.0)]
    assert found == pytest.approx([7.553, 12.916, 16.273], abs=5e-4)


def test_equation_33_is_equation_32_for_the_papers_pattern():
    flux, speed = 0.5 * MG_CM2, 2000 * math.cos(math.radians(15))
    diameter = sphere_diameter(flux, area=625e-12, number=1, density=2770)
    shape = 0.1292 * (ROOT * (speed - 422.5)) ** 0.9234
    print(f"Eq. 32 {shape * diameter * 1e6:.3f} um, Eq. 33 {group_depth(flux, speed) * 1e6:.3f} um")
    assert group_depth(flux, speed) == pytest.approx(shape * diameter, rel=2e-3)
    assert group_depth(flux, 400.0) == 0


def test_a_fit_finds_the_constants_it_was_made_of():
    speed = np.array([606, 676, 700, 1126, 1256, 1300, 1500, 2000, 2200, 3897, 4347, 4500.0])
    exact = 0.1292 * (ROOT * (speed - 422.5)) ** 0.9234
    fit = fit_depth(speed, exact, density=2770, strength=265e6)
    assert (fit.factor, fit.threshold, fit.exponent) == pytest.approx((0.1292, 422.5, 0.9234), rel=1e-4)
    assert fit.goodness == pytest.approx(1.0)
    assert fit(speed, ROOT) == pytest.approx(exact, rel=1e-4)


def test_the_intervals_hold_the_truth_nineteen_times_in_twenty():
    speed = np.tile([606, 700, 1126, 1300, 1500, 2000, 2200, 3897, 4500.0], 3)
    random, held = np.random.default_rng(1), np.zeros(3)
    for _ in range(200):
        noisy = 0.1292 * (ROOT * (speed - 422.5)) ** 0.9234 + random.normal(0, 0.03, len(speed))
        fit = fit_depth(speed, noisy, density=2770, strength=265e6)
        found = np.array([fit.factor, fit.threshold, fit.exponent])
        held += np.abs(found - (0.1292, 422.5, 0.9234)) < fit.intervals
    print(held / 200)
    assert np.all(held / 200 > 0.9)


def test_too_few_depths_are_told():
    with pytest.raises(ValueError, match="found 3 depths"):
        fit_depth(np.ones(3), np.ones(3), density=2770, strength=265e6)
