"""Tillotson against NumPy: every region, the torn solid, and the Hugoniot of aluminium (docs/theory.md)."""

import numpy as np
import pytest

from pockmark.scene.materials import Material, library

ROW = library()["al6061-t6-tillotson"]
RHO, C = 2700.0, {"a": 0.5, "b": 1.63, "A": 75.2e9, "B": 65e9, "E0": 5e6, "E_iv": 3e6, "E_cv": 13.9e6}
ALPHA = BETA = 5.0


def reference(mu, energy, eta_min=0.0, eta_zero=0.0):
    """Pressure at rho/rho0 - 1 and an energy per initial volume, from the paper's form in rho and J/kg."""
    rho, e, h = RHO * (1 + mu), energy / RHO, 1 + mu
    bonds = C["b"] / (max(e, 0) / (C["E0"] * h**2) + 1)
    solid = (C["a"] + bonds) * rho * e + C["A"] * mu + C["B"] * mu**2
    if h < eta_min:
        solid *= min(max((h - eta_zero) / (eta_min - eta_zero), 0), 1)
    if h >= 1 or e <= C["E_iv"]:
        return solid
    nu = RHO / rho - 1
    gas = C["a"] * rho * e + (bonds * rho * e + C["A"] * mu * np.exp(-BETA * nu)) * np.exp(-ALPHA * nu**2)
    if e >= C["E_cv"]:
        return gas
    return ((e - C["E_iv"]) * gas + (C["E_cv"] - e) * solid) / (C["E_cv"] - C["E_iv"])


def made(**changed):
    return Material.model_validate(ROW | {"eos": ROW["eos"] | changed})


@pytest.mark.parametrize(
    "torn", [{"eta_min": 0.0, "eta_zero": 0.0}, {"eta_min": 0.95, "eta_zero": 0.85}], ids=["whole", "torn"]
)
def test_the_pressure_is_the_reference(torn):
    rng = np.random.default_rng(1)
    rows = np.stack([rng.uniform(-0.9, 1.5, 4000), RHO * 10 ** rng.uniform(3, 8, 4000)], axis=1)
    rows[::50, 1] *= -1e-3  # a little colder than at rest
    got = made(**torn).to_core().eos_at(rows)
    want = np.array([reference(*row, **torn) for row in rows])
    worst = (np.abs(got[:, 0] - want) / (np.abs(want) + 1e9)).max()
    phases = np.bincount(got[:, 5].astype(int))
    print(f"largest relative difference {worst:.1e}; condensed, partly vapour, vapour: {phases}")
    assert worst < 1e-12
    assert (phases > 200).all()
    assert (got[rows[:, 0] >= 0, 5] == 0).all()


@pytest.mark.parametrize(
    ("speed", "gpa", "eta"),
    [
        (5e3, 59.9, 1.392),
        (7e3, 96.4, 1.522),
        (10e3, 163.7, 1.702),
        (15e3, 308.4, 1.970),
        (20e3, 493.6, 2.207),
    ],
)
def test_the_hugoniot_of_aluminium_on_itself(speed, gpa, eta):
    """Solved apart from these constants: pressure and compression behind the shock, u_p half of the speed."""
    up = speed / 2
    p = made().shock_pressure(up)
    us = p / (RHO * up)
    print(f"{speed / 1e3:.0f} km/s: {p / 1e9:.2f} GPa, compressed {us / (us - up):.4f}")
    assert p == pytest.approx(gpa * 1e9, abs=0.06e9)
    assert us / (us - up) == pytest.approx(eta, abs=6e-4)


def test_what_tears_pulls_no_more():
    torn = made(eta_min=0.95, eta_zero=0.9).to_core()
    p = torn.eos_at(np.array([[-0.04, 0.0], [-0.09, 0.0], [-0.11, 0.0]]))[:, 0]
    assert p[0] == pytest.approx(reference(-0.04, 0.0))
    assert p[0] < p[1] < 0
    assert p[2] == 0


def test_the_energies_are_in_order():
    with pytest.raises(ValueError, match="E_cv must exceed E_iv"):
        made(E_cv="2 MJ/kg")
