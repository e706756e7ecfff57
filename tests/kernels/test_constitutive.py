"""The stress update against a reference written in NumPy/SciPy from the equations.

Liu et al. 2015, Eqs. 16-20 with their misprints corrected (docs/theory.md): Mie-Grueneisen about the Hugoniot
Us = c0 + s up, Johnson-Cook strength with a radial return, Johnson-Cook failure with an explicit treatment
of failure strains that are not positive. Documented choice: gamma stays gamma0 in expansion (mu < 0).
"""

import numpy as np
import pytest
from builders import kernels, law, material
from scipy.optimize import brentq

import pockmark._core as core

RHO, C0, S, GAMMA0 = 2770.0, 5330.0, 1.34, 2.0
G = 27.44e9
JC = {"A": 265e6, "B": 426e6, "n": 0.34, "C": 0.015, "m": 1.0, "reference_rate": 1.0}
D = (-0.77, 1.45, -0.47, 0.0, 1.6)
D_RATE = (-0.77, 1.45, -0.47, 0.014, 1.6)  # with a rate term, to exercise it
T_ROOM, T_MELT, CP, CHI = 293.0, 775.0, 875.0, 0.9
Q2, Q1 = 1.5, 0.06
CELL, DT, V0 = 4e-6, 2e-10, 8e-18
FLOOR, CLAMP = 0.05, (-1.5, 1 / 3)
LANES = [False, True] if core.build_info()["lanes"] else [False]
GRUNEISEN = law("mie-gruneisen", c0=C0, s=S, gamma0=GAMMA0)
LINEAR, NONE = law("linear", bulk_modulus=70e9), law("none")
TREATMENTS = ["no_damage", "signed", "floor", "clamp_triaxiality"]

# Round-off of a few hundred operations; Newton and brentq each stop at ~1e-14.
TOLERANCE = 1e-10


# ---- the reference -------------------------------------------------------------------------------


def mie_gruneisen(mu, energy):
    """Pressure; mu may be complex (for a derivative by an imaginary increment)."""
    if np.real(mu) < 0:
        return RHO * C0**2 * mu * (1 - GAMMA0 * mu / 2) + GAMMA0 * (1 + mu) * energy
    eta = 1 - 1 / (1 + mu)  # = up/Us
    up = C0 * eta / (1 - S * eta)
    hugoniot = RHO * (C0 + S * up) * up
    gamma = GAMMA0 / (1 + mu)
    return hugoniot * (1 - gamma * mu / 2) + gamma * (1 + mu) * energy


def linear(mu, energy):
    return 70e9 * mu + 0 * energy


def isentropic_c2(eos, mu, energy, pressure):
    h = 1e-30
    by_mu = np.imag(eos(mu + 1j * h, energy)) / h
    by_energy = np.imag(eos(mu, energy + 1j * h)) / h
    return (by_mu + by_energy * pressure / (1 + mu) ** 2) / RHO


def softening(T, m):
    star = np.clip((T - T_ROOM) / (T_MELT - T_ROOM), 0, 1)
    return 1 - star**m


def flow_stress(eps, rate, T, jc):
    return (
        (jc["A"] + jc["B"] * eps ** jc["n"])
        * (1 + jc["C"] * np.log(max(rate / jc["reference_rate"], 1)))
        * softening(T, jc["m"])
    )


def failure_strain(triaxiality, rate, T, d):
    star = np.clip((T - T_ROOM) / (T_MELT - T_ROOM), 0, 1)
    with np.errstate(over="ignore"):
        return (
            (d[0] + d[1] * np.exp(d[2] * triaxiality)) * (1 + d[3] * np.log(max(rate, 1))) * (1 + d[4] * star)
        )


def tensor(v):
    return np.array([[v[0], v[3], v[5]], [v[3], v[1], v[4]], [v[5], v[4], v[2]]])


def vector(t):
    return np.array([t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[1, 2], t[0, 2]])


def von_mises(s):
    return np.sqrt(1.5 * np.sum(s * s))


def reference_update(state, gradient, mass, *, eos, shear, jc, treatment, d=D, slip=0.0):
    volume, energy, pressure, viscosity, eps, temperature, damage = state[:7]
    s, rate = tensor(state[7:]), tensor(gradient[:6])
    w = gradient[6:]
    W = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    V0_ = mass / RHO
    one = np.eye(3)
    # First half of the work, by the old stress.
    energy = energy + 0.5 * DT * np.sum((s - (pressure + viscosity) * one) * rate) * volume / V0_
    opened = np.trace(rate) * DT
    volume = volume * (1 + opened / 2) / (1 - opened / 2)

    increment, flow = 0.0, 0.0
    if damage >= 1:
        s = np.zeros((3, 3))
    else:
        R = np.linalg.solve(one - DT * W / 2, one + DT * W / 2)
        change = 2 * shear * DT * (rate - np.trace(rate) / 3 * one)
        # Elastic: per initial volume.
        before, after = (state[0] / V0_, volume / V0_) if jc is None else (1.0, 1.0)
        s = (R @ s @ R.T * before + change) / after
        trial = von_mises(s)
        if jc is not None and trial > flow_stress(eps, 0, temperature, jc):
            increment = (
                brentq(
                    lambda x: trial - 3 * shear * x - flow_stress(eps + x, x / DT, temperature, jc),
                    0,
                    trial / (3 * shear),
                    xtol=1e-25,
                    rtol=1e-15,
                )
                if softening(temperature, jc["m"]) > 0
                else trial / (3 * shear)
            )
            flow = trial - 3 * shear * increment
            s = s * (flow / trial)
            eps += increment

    ratio = volume / V0_
    mu = 1 / ratio - 1
    c2 = max(isentropic_c2(eos, mu, energy, pressure), 0)
    viscosity = 0.0
    if opened < 0:
        D_ = -opened / DT
        viscosity = RHO / ratio * CELL * (Q2 * CELL * D_**2 + Q1 * np.sqrt(c2) * D_)
    # Second half, by the new stress: p = eos(mu, E1) with E1 that holds p itself.
    work = lambda p: 0.5 * ratio * (DT * np.sum(s * rate) - (p + viscosity) * opened)  # noqa: E731
    slope = (eos(mu, 1e10) - eos(mu, 0.0)) / 1e10  # linear in E
    p = (eos(mu, 0.0) + slope * (energy + work(0.0))) / (1 + slope * 0.5 * ratio * opened)
    assert eos(mu, energy + work(p)) == pytest.approx(p, rel=1e-10, abs=1e-3)
    if damage >= 1:
        c2 = c2 if p >= 0 else 0.0  # what has opened bears no wave
        p = max(p, 0.0)
    paid = energy
    energy = paid + work(p)

    wave = 4 / 3 * shear / RHO * (1 if jc is None else ratio)
    sound = np.sqrt(c2 + (0 if damage >= 1 else wave))
    if damage < 1 and increment > 0:
        triaxiality = -p / max(flow, 1e-200)
        if treatment is not None:
            if treatment == "clamp_triaxiality":
                triaxiality = np.clip(triaxiality, *CLAMP)
            limit = failure_strain(triaxiality, increment / DT, temperature, d)
            if treatment == "floor":
                limit = max(limit, FLOOR)
            if limit > 0 or treatment == "signed":
                damage = max(damage + increment / (limit + (slip / CELL if limit > 0 else 0.0)), 0.0)
        temperature = temperature + CHI * flow * increment * ratio / (RHO * CP)
        if treatment is not None and temperature >= T_MELT:
            damage = max(damage, 1.0)
        if damage >= 1:
            s, p = np.zeros((3, 3)), max(p, 0.0)
            energy = paid + work(p)  # the forces feel the failed stress: it is what the step pays with
    return np.array([volume, energy, p, viscosity, eps, temperature, damage, *vector(s), sound])


# ---- random states -------------------------------------------------------------------------------


def random_states(n, seed):
    rng = np.random.default_rng(seed)
    mu = np.where(rng.random(n) < 0.5, rng.uniform(0, 0.6, n), rng.uniform(-0.35, 0.05, n))
    mu[::10] = rng.uniform(-1e-3, 1e-3, len(mu[::10]))
    states = np.zeros((n, 13))
    states[:, 0] = V0 / (1 + mu)
    states[:, 1] = rng.uniform(0, 1, n) ** 2 * 2e10
    states[:, 2] = [mie_gruneisen(m, e) for m, e in zip(mu, states[:, 1], strict=True)]
    states[:, 3] = np.where(rng.random(n) < 0.5, rng.uniform(0, 2e9, n), 0)
    states[:, 4] = np.where(rng.random(n) < 0.2, 0, rng.uniform(0, 1.5, n))
    states[:, 5] = rng.choice([T_ROOM, 450.0, 700.0, 774.9], n) + rng.uniform(0, 0.05, n)
    molten = rng.random(n) < 0.08
    states[molten, 5] = T_MELT + rng.uniform(0, 300, molten.sum())
    states[:, 6] = np.where(rng.random(n) < 0.5, 0, rng.uniform(0, 0.99, n))
    failed = rng.random(n) < 0.15
    states[failed, 6] = rng.uniform(1, 3, failed.sum())
    s = rng.normal(size=(n, 6))
    s[:, :3] -= s[:, :3].mean(axis=1, keepdims=True)
    norm = np.sqrt(1.5 * ((s[:, :3] ** 2).sum(1) + 2 * (s[:, 3:] ** 2).sum(1)))
    size = rng.uniform(0, 265e6, n)
    states[:, 7:] = s * np.where(failed, 0, size / norm)[:, None]
    gradients = rng.normal(size=(n, 9)) * 10 ** rng.uniform(4, 7.6, n)[:, None]
    # Hydrostatic tension and compression give the extremes of the triaxiality.
    k = n // 5
    gradients[:k, :3] += np.sign(rng.normal(size=(k, 1))) * 4e7
    return states, gradients


def compare(got, want, states, gradients, shear):
    """Largest relative difference, each column against its own natural scale."""
    shear_scale = np.abs(states[:, 7:]).max(1) + 2 * shear * DT * np.abs(gradients).max(1) + 1.0
    pressure_scale = np.abs(want[:, 2]) + RHO * C0**2 * np.abs(V0 / want[:, 0] - 1) + np.abs(want[:, 1]) + 1.0
    scale = np.abs(want).copy()
    scale[:, 1] = scale[:, 2] = pressure_scale
    scale[:, 3] += 1.0
    scale[:, 4] += 1e-12
    scale[:, 6] += 1e-3
    scale[:, 7:13] = shear_scale[:, None]
    scale[:, 13] += 1.0  # m/s: what has failed and opened has no sound
    return np.abs(got - want) / scale


def build(eos, strength, failure=NONE, q=(Q2, Q1)):
    return material(eos, strength, failure=failure, q=q, specific_heat=CP, heating=CHI)


def johnson_cook(**changed):
    return law("johnson-cook", shear_modulus=G, **{**JC, **changed})


def failure_model(treatment, d=D, slip=0.0):
    return law(
        "johnson-cook",
        treatment=treatment,
        **{f"D{i + 1}": x for i, x in enumerate(d)},
        floor=FLOOR,
        triaxiality_min=CLAMP[0],
        triaxiality_max=CLAMP[1],
        displacement=slip,
    )


def check(name, material, *, eos, shear, jc, treatment, d=D, slip=0.0, n=400, seed=1):
    states, gradients = random_states(n, seed)
    want = np.array(
        [
            reference_update(s, g, RHO * V0, eos=eos, shear=shear, jc=jc, treatment=treatment, d=d, slip=slip)
            for s, g in zip(states, gradients, strict=True)
        ]
    )
    assert np.isfinite(want).all()
    for lanes in LANES:
        got = kernels.update_stress(material, states, gradients, RHO * V0, CELL, DT, lanes)
        worst = compare(got, want, states, gradients, shear)
        row, column = np.unravel_index(worst.argmax(), worst.shape)
        print(
            f"{name}, {lanes=}: largest relative difference {worst.max():.2e} (state {row}, column {column})"
        )
        assert worst.max() < TOLERANCE
    return states, want


@pytest.mark.parametrize(
    ("d", "slip"), [(D, 0.0), (D_RATE, 0.0), (D, 2e-7)], ids=["paper", "with rate", "with a displacement"]
)
@pytest.mark.parametrize("treatment", [None, *TREATMENTS])
def test_johnson_cook_and_mie_gruneisen(treatment, d, slip):
    failure = NONE if treatment is None else failure_model(treatment, d, slip)
    states, want = check(
        f"{treatment}",
        build(GRUNEISEN, johnson_cook(), failure),
        eos=mie_gruneisen,
        shear=G,
        jc=JC,
        treatment=treatment,
        d=d,
        slip=slip,
    )
    # The draw has what it is meant to have.
    yielded = want[:, 4] > states[:, 4]
    assert 100 < yielded.sum() < len(states)
    assert (states[yielded, 4] == 0).sum() > 5
    assert (want[:, 2] < 0).sum() > 20
    if treatment:
        fresh = (states[:, 6] < 1) & (want[:, 6] >= 1)
        print(
            f"{treatment}: {yielded.sum()} yield, {fresh.sum()} fail now, {(want[:, 2] < 0).sum()} in tension"
        )
        assert fresh.sum() > 5
        assert (want[want[:, 6] >= 1, 2] >= 0).all()
    if treatment == "signed":
        assert (want[:, 6] < states[:, 6]).any()


@pytest.mark.parametrize(
    "changed", [{"m": 1.7}, {"C": 0.0}, {"B": 0.0}, {"n": 0.73}, {"reference_rate": 1e6}]
)
def test_other_constants(changed):
    check(
        f"{changed}",
        build(GRUNEISEN, johnson_cook(**changed), NONE),
        eos=mie_gruneisen,
        shear=G,
        jc={**JC, **changed},
        treatment=None,
        seed=2,
    )


def test_elastic_fluid_and_linear_eos():
    common = {"jc": None, "treatment": None, "seed": 3}
    check(
        "elastic",
        build(GRUNEISEN, law("elastic", shear_modulus=G), NONE),
        eos=mie_gruneisen,
        shear=G,
        **common,
    )
    check(
        "elastic, linear EOS",
        build(LINEAR, law("elastic", shear_modulus=G), NONE),
        eos=linear,
        shear=G,
        **common,
    )
    # A fluid carries no deviator: start it without one.
    states, gradients = random_states(400, 4)
    states[:, 7:] = 0
    got = kernels.update_stress(
        build(GRUNEISEN, law("fluid"), NONE), states, gradients, RHO * V0, CELL, DT, False
    )
    want = np.array(
        [
            reference_update(s, g, RHO * V0, eos=mie_gruneisen, shear=0.0, jc=None, treatment=None)
            for s, g in zip(states, gradients, strict=True)
        ]
    )
    worst = compare(got, want, states, gradients, 0.0).max()
    print(f"fluid: largest relative difference {worst:.2e}")
    assert worst < TOLERANCE


@pytest.mark.parametrize("up", [10.0, 350.0, 1100.0, 2250.0, 4000.0])
def test_the_eos_reproduces_the_hugoniot(up):
    """E = up^2/2 per mass at rho = rho0 Us/(Us - up) gives p = rho0 Us up, exactly."""
    us = C0 + S * up
    states = np.zeros((1, 13))
    states[0, 0] = V0 * (us - up) / us
    states[0, 1] = RHO * up**2 / 2
    states[0, 5] = T_ROOM
    got = kernels.update_stress(
        build(GRUNEISEN, law("fluid"), NONE),
        states,
        np.zeros((1, 9)),
        RHO * V0,
        CELL,
        DT,
        lanes=False,
    )[0, 2]
    difference = abs(got / (RHO * us * up) - 1)
    print(f"up = {up} m/s: p = {got:.9e} Pa, relative difference {difference:.1e}")
    assert difference < 1e-11  # mu from the volume loses up to 3 digits at the smallest up


def test_the_eos_is_continuous_at_zero_compression():
    states = np.zeros((2, 13))
    states[:, 0] = V0 * (1 + np.array([-1e-9, 1e-9]))
    states[:, 1], states[:, 5] = 1e9, T_ROOM
    got = kernels.update_stress(
        build(GRUNEISEN, law("fluid"), NONE),
        states,
        np.zeros((2, 9)),
        RHO * V0,
        CELL,
        DT,
        lanes=False,
    )
    jump = (got[0, 2] - got[1, 2]) / (RHO * C0**2 * 2e-9)
    print(f"slope across mu = 0: {jump:.6f} of K + gamma0 E terms")
    # dp/dmu is K on the compressed side, K + gamma0 E on the other: the mean of both over K, E = 1e9.
    assert jump == pytest.approx(1 + 0.5 * GAMMA0 * 1e9 / (RHO * C0**2), rel=1e-5)


def test_flow_stress_against_the_closed_form():
    rng = np.random.default_rng(5)
    jc = {**JC, "m": 1.34, "C": 0.02, "reference_rate": 10.0}
    rows = np.array(
        [[rng.uniform(0, 2), 10 ** rng.uniform(-2, 8), rng.uniform(250, 800), 0, 1, 0] for _ in range(300)]
    )
    got = build(GRUNEISEN, johnson_cook(m=1.34, C=0.02, reference_rate=10.0)).strength_at(rows)[:, 0]
    want = np.array([flow_stress(*row[:3], jc) for row in rows])
    worst = np.abs(got - want).max() / JC["A"]
    hand = (265e6 + 426e6 * 0.5**0.34) * (1 + 0.015 * np.log(1e5)) * (1 - 207 / 482)
    by_name = build(GRUNEISEN, johnson_cook()).strength_at(np.array([[0.5, 1e5, 500.0, 0, 1, 0]]))[0, 0]
    assert by_name == pytest.approx(hand, rel=1e-13)
    print(f"flow stress: largest difference {worst:.1e} of A")
    assert worst < 1e-13


def test_failure_strain_against_table_and_closed_form():
    def core_strain(model, triaxiality, rate, temperature):
        """The failure strain, from the damage of a plastic strain of 1."""
        row = np.array([[1.0, rate, triaxiality, 1.0, temperature, 0.0, CELL]])
        return 1 / kernels.failure_at(build(GRUNEISEN, johnson_cook(), model), row)[0, 0]

    model = failure_model("signed")
    # reading.md, section 1: to the four digits printed there.
    table = {
        -3: 5.1691,
        -1: 1.55,
        -1 / 3: 0.9259,
        0: 0.68,
        1 / 3: 0.4697,
        1: 0.1363,
        1.35: -0.0012,
        2: -0.2036,
    }
    off = max(abs(core_strain(model, x, 1.0, T_ROOM) - want) for x, want in table.items())
    print(f"failure strain: largest difference from the table {off:.1e}")
    assert off < 0.51e-4
    zero = brentq(lambda x: core_strain(model, x, 1.0, T_ROOM), 0, 3)
    assert zero == pytest.approx(np.log(0.77 / 1.45) / -0.47, abs=1e-9)
    rng = np.random.default_rng(6)
    rated = failure_model("signed", D_RATE)
    worst = 0.0
    for _ in range(300):
        x, rate, T = rng.uniform(-3, 3), 10 ** rng.uniform(-2, 8), rng.uniform(250, 900)
        worst = max(worst, abs(core_strain(rated, x, rate, T) - failure_strain(x, rate, T, D_RATE)))
    print(f"failure strain: largest difference from the closed form {worst:.1e}")
    assert worst < 1e-13


@pytest.mark.parametrize("lanes", LANES)
@pytest.mark.parametrize("changed", [{}, {"C": 0.0}, {"B": 0.0}, {"m": 1.7}])
def test_the_return_ends_on_the_yield_surface(changed, lanes):
    """From a hair above yield to a thousand times it, across the kink at the reference rate, hot and molten."""
    n, jc = 20000, {**JC, **changed}
    rng = np.random.default_rng(7)
    plastic = np.where(rng.random(n) < 0.3, 0, 10 ** rng.uniform(-13, 0.3, n))
    hot = rng.choice([T_ROOM, 500.0, 774.0, 800.0], n)
    still = np.array([flow_stress(e, 0.0, t, jc) for e, t in zip(plastic, hot, strict=True)])
    excess = 10 ** rng.uniform(-10, 3, n)
    trial = np.where(still > 0, still * (1 + excess), 1e8 * excess)
    states = np.zeros((n, 13))
    states[:, 0], states[:, 4], states[:, 5], states[:, 10] = V0, plastic, hot, trial / np.sqrt(3)
    material = build(GRUNEISEN, johnson_cook(**changed), NONE)
    got = kernels.update_stress(material, states, np.zeros((n, 9)), RHO * V0, CELL, DT, lanes)
    flow = np.sqrt(3) * got[:, 10]
    # The increment, by whichever of the two differences loses less to rounding.
    by_stress, by_strain = np.maximum((trial - flow) / (3 * G), 0), got[:, 4] - plastic
    increment = np.where(plastic < trial / (3 * G), by_strain, by_stress)
    want = [flow_stress(e + d, d / DT, t, jc) for e, d, t in zip(plastic, increment, hot, strict=True)]
    # What rounding leaves of the increment moves the logarithm of the rate, above the kink.
    lost = 8 * np.finfo(float).eps * np.minimum(plastic, trial / (3 * G))
    unsure = jc["C"] * np.array(want) * lost / np.maximum(increment, DT)
    worst = (np.abs(flow - want) - unsure) / trial
    slow = (increment > 0) & (increment < DT)
    print(
        f"{changed}, {lanes=}: off the yield surface by {worst.max():.1e} of the trial; {slow.sum()} slow returns"
    )
    assert slow.sum() > 100 or changed == {"B": 0.0}
    assert worst.max() < 1e-12


@pytest.mark.parametrize("lanes", LANES)
def test_elementary_functions(lanes):
    rng = np.random.default_rng(8)
    x = 10 ** rng.uniform(-280, 280, 4001)
    near = 1 + rng.uniform(-0.3, 0.3, 1003)
    for values in (x, near):
        error = np.abs(kernels.elementary("log", values, 0.0, lanes) / np.log(values) - 1).max()
        print(f"log, {lanes=}: largest relative error {error:.1e}")
        assert error < 1e-14
        rough = np.abs(kernels.elementary("rough_log", values, 0.0, lanes) - np.log(values)).max()
        print(f"rough_log, {lanes=}: largest error {rough:.1e}")
        assert rough < 4e-6
    powers = rng.uniform(-640, 640, 4001)
    error = np.abs(kernels.elementary("exp", powers, 0.0, lanes) / np.exp(powers) - 1).max()
    print(f"exp, {lanes=}: largest relative error {error:.1e}")
    assert error < 1e-14
    strains = 10 ** rng.uniform(-14, 2, 4001)
    error = np.abs(kernels.elementary("pow", strains, 0.34, lanes) / strains**0.34 - 1).max()
    print(f"pow, {lanes=}: largest relative error {error:.1e}")
    assert error < 1e-14
    assert kernels.elementary("pow", np.zeros(9), 0.34, lanes).max() == 0


def test_an_elastic_solid_gives_back_what_it_took():
    """Sheared, compressed, sheared back and expanded: the same energy as before, however large the strains."""
    shear, steps, compression = 1.0, 4000, 0.5
    still = np.zeros(9)
    turn, shut = still.copy(), still.copy()
    # Pure shear along the diagonals: it turns nothing.
    turn[3] = shear / steps / DT
    shut[:3] = -compression / 3 / steps / DT
    states = np.zeros((1, 13))
    states[0, 0], states[0, 5] = V0, T_ROOM
    solid = build(LINEAR, law("elastic", shear_modulus=G), q=(0.0, 0.0))
    most = 0.0
    for gradient in (turn, shut, -turn, -shut):
        for _ in range(steps):
            states = kernels.update_stress(solid, states, gradient[None], RHO * V0, CELL, DT, False)[:, :13]
        most = max(most, states[0, 1])
    print(f"energy at the end {states[0, 1] / most:+.1e} of the largest, {most:.2e} J/m3")
    assert abs(states[0, 1]) < 1e-3 * most
