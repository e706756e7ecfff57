"""Energy and pressure of a step that cannot be found together are counted: `eos_failures`, core/eos/energy.hpp."""

import numpy as np
import pytest
from builders import FREE, lattice, law, options, set_by_id, solver

from pockmark.scene.materials import Material, library

ROW = library()["al6061-t6-tillotson"]
H, SIDE = 4e-6, 16  # cell, m; points along a side
# The most that a scene may ask for: where a point closes by more than 2/(a + b) in a step, its equation of energy turns over.
STEEP = {"a": 5.0, "b": 20.0}


def fluid(**constants):
    """Return a fluid of aluminium with Tillotson's equation of state, some of its constants changed."""
    row = ROW | {"eos": ROW["eos"] | constants, "viscosity": {"quadratic": 0.0, "linear": 0.0}}
    return Material.model_validate(row | {"strength": law("fluid"), "failure": law("none")})


def disagreeing(material, s):
    """Return how many points have another pressure than the law's at their compression and energy."""
    mu = s.field("mass") / material.density / s.field("volume") - 1
    rows = np.stack([mu, s.field("energy")], axis=1)
    p, by_mu, by_energy = material.to_core().eos_at(rows).T[:3]
    scale = np.abs(p) + np.abs(by_mu * mu) + np.abs(by_energy * rows[:, 1])
    return int((np.abs(s.field("pressure") - p) > 1e-8 * scale).sum())


def after_a_step(material, driver):
    """Return a cube of points, expanded and partly vapour, after a step in which each closes or opens by up to a third."""
    rng = np.random.default_rng(7)
    position = lattice((4 * H, 4 * H, 4 * H), (SIDE, SIDE, SIDE), H / 2)
    n, eta = len(position), rng.uniform(0.3, 1.0, SIDE**3)
    s = solver(
        (0, 0, 0),
        H,
        (SIDE, SIDE, SIDE),
        [FREE] * 6,
        [material.to_core()],
        options("usl", cfl=1.0, strain_limit=1.0),
        [(position, rng.uniform(-20e3, 20e3, (n, 3)), (H / 2) ** 3, material.density, 0)],
        driver=driver,
    )
    energy = material.density * rng.uniform(1e6, 15e6, n)  # about E_iv to E_cv
    set_by_id(s, "volume", (H / 2) ** 3 / eta)
    set_by_id(s, "energy", energy)
    set_by_id(s, "pressure", material.to_core().eos_at(np.stack([eta - 1, energy], axis=1))[:, 0])
    s.advance(max_steps=1, end_time=1.0, pause=np.inf)
    return s


@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_each_point_whose_energy_and_pressure_disagree_is_counted(driver):
    material = fluid(**STEEP)
    s = after_a_step(material, driver)
    counted = s.counters()["eos_failures"]
    print(f"{driver}: {counted} of {SIDE**3} points do not converge")
    assert counted > 10
    assert counted == disagreeing(material, s)


@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_aluminium_converges_in_the_same_step(driver):
    material = fluid()
    s = after_a_step(material, driver)
    assert s.counters()["eos_failures"] == disagreeing(material, s) == 0
