"""The spall pressure against NumPy, on a solid that flows, an elastic one and a fluid (docs/theory.md)."""

import numpy as np
import pytest
from lawbook import LANES, V0, states_of, update

from pockmark.scene.materials import Material, library

ROW = library()["cu-ofhc-spall"]
LIMIT = 1.35e9
STRENGTHS = [
    ROW["strength"],
    {"model": "elastic", "shear_modulus": "47.7 GPa"},
    {"model": "fluid"},
]


@LANES
@pytest.mark.parametrize("strength", STRENGTHS, ids=[table["model"] for table in STRENGTHS])
def test_what_is_pulled_beyond_the_pressure_fails(strength, lanes):
    material = Material.model_validate(ROW | {"strength": strength})
    rng = np.random.default_rng(1)
    mu = rng.uniform(-0.03, 0.03, 1000)
    states = states_of(len(mu), material, volume=V0 / (1 + mu), damage=rng.choice([0.0, 0.4, 1.5], len(mu)))
    states[:, 2] = material.to_core().eos_at(np.stack([mu, 0 * mu], axis=1))[:, 0]
    states[states[:, 6] >= 1, 2] = np.maximum(states[states[:, 6] >= 1, 2], 0)
    after = update(material, states, lanes=lanes)
    pulled = (states[:, 6] < 1) & (-states[:, 2] >= LIMIT)
    np.testing.assert_allclose(after[:, 6], states[:, 6] + pulled, rtol=1e-12)
    assert (after[pulled, 2] == 0).all()
    np.testing.assert_allclose(after[~pulled, 2], states[~pulled, 2], rtol=1e-9, atol=1e3)
    print(
        f"{pulled.sum()} of {len(mu)} come apart, {(~pulled & (states[:, 2] < 0)).sum()} stand their tension"
    )
    assert 100 < pulled.sum() < 500


def test_the_one_law_that_needs_no_flow_is_accepted_on_a_fluid():
    assert Material.model_validate(ROW | {"strength": {"model": "fluid"}}).failure.model == "spall"
