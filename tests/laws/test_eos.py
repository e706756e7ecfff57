"""What every equation of state must do, whatever its law."""

import numpy as np
import pytest
from lawbook import DT, LANES, V0, core, differences, each, materials, states_of, update
from scipy.integrate import solve_ivp

SPEEDS = [100.0, 1000.0, 3000.0, 6000.0]  # m/s, of the material behind a shock


def pressure(core_material):
    return lambda rows: core_material.eos_at(rows)[:, 0]


def rows_of(material, n=2000, seed=1):
    """Compressions and energies, hot and cold, that bodies come to."""
    rng = np.random.default_rng(seed)
    mu = np.r_[rng.uniform(-0.6, 0, n // 2), rng.uniform(0, 0.9, n - n // 2)]
    return np.ascontiguousarray(np.stack([mu, material.density * 10 ** rng.uniform(3, 7.7, n)], axis=1))


def test_every_law_is_tried():
    for kind in ("eos", "strength", "failure"):
        models = {getattr(m, kind).model for m in materials(kind).values()}
        assert models == {entry["name"] for entry in core.laws()[kind]}


@each("eos")
def test_the_slopes_are_those_of_the_pressure(material):
    made, rows = material.to_core(), rows_of(material)
    p, by_mu, by_energy, capped = made.eos_at(rows).T[:4]
    assert np.isfinite([p, by_mu, by_energy]).all()
    for column, slope, change in ((0, by_mu, 1e-6), (1, by_energy, 1e-6 * material.bulk_modulus)):
        got, smooth = differences(pressure(made), rows, column, change)
        held = smooth & (capped == 0)
        scale = np.abs(slope) + (material.bulk_modulus if column == 0 else 0.1)
        worst = (np.abs(got - slope) / scale)[held].max()
        print(f"column {column}: slopes off by {worst:.1e}, {len(rows) - held.sum()} rows at a kink or a cap")
        assert worst < 1e-5
        assert held.mean() > 0.9


@each("eos")
def test_the_pressure_has_no_steps(material):
    made = material.to_core()
    for energy in material.density * np.array([0.0, 1e5, 3e6, 2e7]):
        mu = np.linspace(-0.7, 0.9, 20001)
        p, slope = made.eos_at(np.stack([mu, np.full_like(mu, energy)], axis=1)).T[:2]
        most = np.maximum(np.abs(slope[1:]), np.abs(slope[:-1])) * np.diff(mu)
        assert (np.abs(np.diff(p)) <= 1.5 * most + 1e-6 * material.bulk_modulus).all()


@each("eos")
def test_the_hugoniot_obeys_rankine_and_hugoniot(material):
    """The pressure behind a shock is on the law's surface, rises with the speed, and the shock outruns what it moves."""
    made, before = material.to_core(), 0.0
    for up in SPEEDS:
        p = material.shock_pressure(up)
        us = p / (material.density * up)
        mu = up / (us - up)
        on_law = made.eos_at(np.array([[mu, material.density * up**2 / 2]]))[0, 0]
        print(f"up {up:.0f} m/s: Us {us:.0f} m/s, p {p / 1e9:.2f} GPa, off the law by {on_law / p - 1:.1e}")
        assert on_law == pytest.approx(p, rel=1e-9)
        assert us > up
        assert p > before
        before = p


@each("eos")
def test_a_compression_by_the_update_ends_on_the_isentrope(material):
    """Compressed in small steps without viscosity: dE = -p dV, by scipy; and back to where it began: nothing is won."""
    made, steps = material.to_core(), 4000
    shut = np.zeros((1, 9))
    shut[0, :3] = -0.2 / 3 / steps / DT
    states = states_of(1, material)
    fluid = material.model_copy(
        update={
            "strength": materials("strength")["fluid"].strength,
            "failure": materials("failure")["none"].failure,
        }
    )
    for _ in range(steps):
        states = update(fluid, states, shut, q=False)[:, :13]
    ratio = states[0, 0] / V0

    def slope(v, energy):
        return [-made.eos_at(np.array([[1 / v - 1, energy[0]]]))[0, 0]]

    want = solve_ivp(slope, (1.0, ratio), [0.0], rtol=1e-10, atol=1.0).y[0, -1]
    off = states[0, 1] / want - 1
    for _ in range(steps):
        states = update(fluid, states, -shut, q=False)[:, :13]
    left = states[0, 1] / want
    print(f"V/V0 {ratio:.3f}: energy off the isentrope by {off:.1e}, back at rest {left:.1e} of it are left")
    assert abs(off) < 1e-6
    assert abs(left) < 1e-6


@each("eos")
def test_sound_is_real_behind_a_shock_and_in_its_release(material):
    made = material.to_core()

    def stiffness(mu, energy):
        p, by_mu, by_energy = made.eos_at(np.array([[mu, energy]]))[0, :3]
        return by_mu + by_energy * p / (1 + mu) ** 2

    for up in SPEEDS:
        p = material.shock_pressure(up)
        mu, energy = up / (p / (material.density * up) - up), material.density * up**2 / 2
        released = solve_ivp(
            lambda v, e: [-made.eos_at(np.array([[1 / v - 1, e[0]]]))[0, 0]],
            (1 / (1 + mu), 1.0),
            [energy],
            rtol=1e-8,
            dense_output=True,
        )
        for v in np.linspace(1 / (1 + mu), 1.0, 50):
            assert stiffness(1 / v - 1, released.sol(v)[0]) > 0


@each("eos")
@LANES
def test_energy_and_pressure_of_a_step_agree(material, lanes):
    """After strains of up to a tenth the pressure is the law's at the energy that it has worked into."""
    rows = rows_of(material, 1000, seed=2)
    p = material.to_core().eos_at(rows)[:, 0]
    states = states_of(len(rows), material, volume=V0 / (1 + rows[:, 0]), energy=rows[:, 1], pressure=p)
    gradients = np.zeros((len(rows), 9))
    gradients[:, :3] = np.random.default_rng(3).uniform(-0.1, 0.1, (len(rows), 1)) / 3 / DT
    after = update(material, states, gradients, lanes=lanes)
    intact = (states[:, 6] < 1) & (after[:, 6] < 1)
    want = material.to_core().eos_at(np.stack([V0 / after[:, 0] - 1, after[:, 1]], axis=1))
    scale = np.abs(want[:, 0]) + material.bulk_modulus * np.abs(V0 / after[:, 0] - 1) + np.abs(after[:, 1])
    worst = (np.abs(after[:, 2] - want[:, 0]) / scale)[intact].max()
    print(f"{lanes=}: pressure off the law by {worst:.1e}")
    assert worst < 1e-9


@each("eos")
def test_lanes_are_the_numbers(material):
    rows = rows_of(material, 1003, seed=4)
    p = material.to_core().eos_at(rows)[:, 0]
    states = states_of(len(rows), material, volume=V0 / (1 + rows[:, 0]), energy=rows[:, 1], pressure=p)
    gradients = np.random.default_rng(5).normal(size=(len(rows), 9)) * 1e7
    if not core.build_info()["lanes"]:
        pytest.skip("this core was built without SIMD lanes")
    one, many = (update(material, states, gradients, lanes=lanes) for lanes in (False, True))
    scale = np.abs(one) + 1e-3 * np.abs(one).max(axis=0)
    scale[:, 1] += np.abs(one[:, 2]) + material.bulk_modulus * np.abs(V0 / one[:, 0] - 1)
    scale[:, 2] = scale[:, 1]
    worst = (np.abs(one - many) / np.maximum(scale, 1e-300)).max()
    print(f"largest relative difference {worst:.1e}")
    assert worst < 1e-11
