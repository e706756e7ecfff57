"""Steinberg-Guinan against NumPy: shear modulus, flow stress, its ceiling and its melting (docs/theory.md)."""

import numpy as np
import pytest
from lawbook import LANES, states_of, update

from pockmark.scene.materials import Material, library

ROW = library()["al6061-t6-steinberg"]
G0, Y0, Y_MAX, BETA, N = 27.6e9, 0.29e9, 0.68e9, 125.0, 0.1
A, B, T_M0, SMALL_A, GAMMA0 = 65.2e-12, 6.16e-4, 1220.0, 1.5, 1.97


def reference(plastic, temperature, pressure, h, e_i=0.0):
    """Shear modulus and flow stress; h = rho/rho0."""
    g = max(1 + A * pressure / np.cbrt(h) - B * (temperature - 300), 0.01)
    melt = T_M0 * np.exp(2 * SMALL_A * (1 - 1 / h)) * h ** (2 * (GAMMA0 - SMALL_A - 1 / 3))
    flow = min(Y0 * (1 + BETA * (plastic + e_i)) ** N, Y_MAX) * g if temperature < melt else 0.0
    return G0 * g, flow


def made(**changed):
    return Material.model_validate(ROW | {"strength": ROW["strength"] | changed})


@pytest.mark.parametrize("changed", [{}, {"e_i": 0.05}], ids=["annealed", "worked"])
def test_modulus_and_flow_stress_are_the_reference(changed):
    rng, n = np.random.default_rng(1), 3000
    plastic = np.where(rng.random(n) < 0.2, 0, 10 ** rng.uniform(-5, 2.5, n))
    temperature, pressure, h = rng.uniform(250, 2500, n), rng.uniform(-2e10, 1e11, n), rng.uniform(0.8, 2, n)
    rows = np.stack([plastic, 10 ** rng.uniform(-2, 8, n), temperature, pressure, 1 / h, np.zeros(n)], axis=1)
    got = made(**changed).to_core().strength_at(rows)
    want = np.array(
        [reference(*row, **changed) for row in zip(plastic, temperature, pressure, h, strict=True)]
    )
    off = np.abs(got[:, [6, 0]] - want).max(axis=0) / [G0, Y0]
    capped, molten = (want[:, 1] > 0) & (got[:, 1] == 0) & (plastic > 0), want[:, 1] == 0
    print(f"off by {off[0]:.1e} of G0, {off[1]:.1e} of Y0; {capped.sum()} at Y_max, {molten.sum()} molten")
    assert off.max() < 1e-12
    assert capped.sum() > 50
    assert molten.sum() > 50


def test_at_rest_it_is_what_the_table_says():
    material = made()
    assert material.shear_modulus == G0
    # 293 K are 7 below those of the law.
    assert material.yield_strength == pytest.approx(Y0 * (1 + 7 * B), rel=1e-12)


@LANES
def test_a_return_at_the_ceiling_and_of_a_melt(lanes):
    """The ceiling is met exactly; of a melt nothing is left."""
    states = states_of(2, made(), shear=1e9 / np.sqrt(3), plastic_strain=300.0, temperature=[300.0, 1300.0])
    after = update(made(), states, lanes=lanes)
    flow = np.sqrt(3) * after[:, 10]
    np.testing.assert_allclose(flow, [Y_MAX, 0.0], rtol=1e-12, atol=1e-3)
    assert after[0, 4] - 300.0 == pytest.approx((1e9 - Y_MAX) / (3 * G0), rel=1e-9)
