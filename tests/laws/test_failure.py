"""What every failure law must do, whatever its law."""

import numpy as np
import pytest
from lawbook import DT, LANES, V0, declared, each, materials, states_of, update

from pockmark.scene.materials import Material, library


def loaded(material, n=2000, seed=1):
    """States in tension and compression, with a shear that may yield, and gradients of every kind."""
    rng = np.random.default_rng(seed)
    mu = rng.uniform(-0.12, 0.1, n)
    damage = np.where(rng.random(n) < 0.5, 0, 1 - 10 ** rng.uniform(-7, -0.5, n))
    states = states_of(n, material, volume=V0 / (1 + mu), damage=damage)
    states[:, 2] = material.to_core().eos_at(np.stack([mu, np.zeros(n)], axis=1))[:, 0]
    states[:, 10] = rng.uniform(-3e8, 3e8, n)
    return states, rng.normal(size=(n, 9)) * 10 ** rng.uniform(3, 7, n)[:, None]


@each("failure")
@LANES
def test_damage_never_falls_and_what_failed_has_neither_shear_nor_tension(material, lanes):
    states, gradients = loaded(material)
    after = update(material, states, gradients, lanes=lanes)
    assert (after[:, 6] >= states[:, 6]).all()
    failed = after[:, 6] >= 1
    print(f"{lanes=}: {failed.sum()} of {len(states)} fail, {(after[:, 6] > states[:, 6]).sum()} are damaged")
    assert (after[failed, 2] >= 0).all()
    assert (after[failed, 7:13] == 0).all()
    if declared("failure", material.failure.model)["may_fail"]:
        assert failed.any()
    else:
        assert not failed.any()


@each("failure")
@LANES
def test_damage_without_plastic_strain_is_of_laws_that_say_so(material, lanes):
    """Pulled apart without shear, nothing flows."""
    dilation = np.linspace(0, 0.3, 301)
    states = states_of(len(dilation), material, volume=V0 * (1 + dilation))
    states[:, 2] = material.to_core().eos_at(np.stack([1 / (1 + dilation) - 1, 0 * dilation], axis=1))[:, 0]
    after = update(material, states, lanes=lanes)
    assert (after[:, 4] == 0).all()
    if declared("failure", material.failure.model)["needs_flow"]:
        assert (after[:, 6] == 0).all()
        return
    failed = after[:, 6] >= 1
    print(
        f"{lanes=}: fails at a dilation of {dilation[failed][0]:.3f}, a tension of {-states[failed][0, 2] / 1e9:.3f} GPa"
    )
    assert failed.any()
    assert not failed[0]
    assert (after[failed, 2] == 0).all()


def test_a_step_in_which_a_point_fails_pays_with_its_failed_stress():
    """The energy of a point that fails now is that of one that has neither shear nor tension."""
    for material in materials("failure").values():
        states, gradients = loaded(material, seed=2)
        after = update(material, states, gradients, q=False)
        fresh = (states[:, 6] < 1) & (after[:, 6] >= 1)
        growth = gradients[:, :3].sum(axis=1) * DT
        ratio = after[:, 0] / V0
        old = (states[:, 7:13] * gradients[:, :6] * [1, 1, 1, 2, 2, 2]).sum(axis=1) * DT - states[
            :, 2
        ] * growth
        want = states[:, 1] + 0.5 * old * states[:, 0] / V0 - 0.5 * after[:, 2] * growth * ratio
        np.testing.assert_allclose(after[fresh, 1], want[fresh], rtol=1e-9, atol=1e-2)


@pytest.mark.parametrize("displacement", [0.0, 3e-6])
def test_a_layer_fails_after_a_slip_that_a_displacement_makes_its_own(displacement):
    """Without one the slip is the failure strain times the cell; with one it tends to it as the cell shrinks."""
    table = library()["al2024-t351"]
    failure = table["failure"] | {"displacement": displacement, "D2": 0.0, "D4": 0.0}
    material = Material.model_validate(table | {"failure": failure})
    strain, slips = failure["D1"], []  # whatever the triaxiality: heat makes a pressure
    for cell in (4e-6, 2e-6, 1e-6):
        states, gradients = states_of(1, material), np.zeros((1, 9))
        gradients[0, 3] = 5e-4 / DT  # of the layer's sides
        while states[0, 6] < 1:
            states = update(material, states, gradients, cell=cell)[:, :13]
        slips.append(states[0, 4] * cell)  # the elastic part comes back
        assert slips[-1] == pytest.approx(strain * cell + displacement, rel=0.005)
    print(f"{displacement=}: slips of {slips} m")
