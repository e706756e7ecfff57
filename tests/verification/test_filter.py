"""The filter of what the grid cannot see: what it takes, what it leaves, and where the energy goes."""

from math import comb
from pathlib import Path

import numpy as np
import pytest
from builders import C0, FREE, GAMMA0, RHO, SHEAR, SYMMETRY, S, aluminium, lattice, options, solver
from test_drivers import assert_same_bits
from test_restore import copied

from pockmark import PockmarkError, Scene
from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation
from pockmark.scene.identity import hash_of

H = 1e-6
QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
FILTER = ("numerics.filter.interval=5",)
SHAPES = pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
INSTANT = 1e-25  # s: a step in which nothing happens but the filter


def still(x, v, *, filtering, shape="trilinear", faces=FREE, driver="cpu", **fields):
    """Return a solver after two steps of no duration, the second with the filter before it, and its order of points."""
    s = solver(
        (0, 0, 0),
        H,
        (8, 8, 8),
        [faces] * 6,
        [aluminium()],
        options(shape=shape, filtering=filtering),
        [(x, v, (H / 2) ** 3, RHO, 0)],
        driver=driver,
    )
    s.advance(1, INSTANT)
    for name, values in fields.items():
        s.set_field(name, values[s.field("id")])
    s.advance(1, 2 * INSTANT)
    assert s.cycle == 2
    return s, np.argsort(s.field("id"))


def mie_gruneisen(mu, energy):
    """Return the pressure of the paper's law in compression (docs/theory.md, Eq. 10)."""
    eta = mu / (1 + mu)
    hugoniot = RHO * C0**2 * eta / (1 - S * eta) ** 2
    return hugoniot * (1 - GAMMA0 * eta / 2) + GAMMA0 * energy


def weights(x, shape):
    """Return S: the weight of each node of a grid of cells H, padded by two, at each point."""
    support = 2 if shape == "trilinear" else 3
    nodes = 13
    out = np.zeros((len(x), nodes**3))
    xi = x / H + 2
    base = np.floor(xi - (0 if support == 2 else 0.5)).astype(int)
    f = xi - base
    axis = [1 - f, f] if support == 2 else [0.5 * (1.5 - f) ** 2, 0.75 - (f - 1) ** 2, 0.5 * (f - 0.5) ** 2]
    for i in range(support):
        for j in range(support):
            for k in range(support):
                node = ((base[:, 0] + i) * nodes + base[:, 1] + j) * nodes + base[:, 2] + k
                out[np.arange(len(x)), node] += axis[i][:, 0] * axis[j][:, 1] * axis[k][:, 2]
    return out


@SHAPES
@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_velocities_are_those_of_the_formula(shape, order, driver):
    """v' = S sum_k c_k (S+ S)^(k-1) S+ v, with c_k of 1 - (1 - z)^m, by matrices.

    Failed points take part where the points fill half of the space at their nodes.
    """
    rng = np.random.default_rng(order)
    x = (2 + 4 * rng.random((250, 3))) * H
    v = rng.normal(size=x.shape) * 100
    damage = np.where(rng.random(len(x)) < 0.2, 1.0, 0.3)
    s, by_id = still(x, v, filtering=(1, order, 0.0), shape=shape, driver=driver, damage=damage)
    all_points = weights(x, shape)
    filling = all_points @ all_points.sum(axis=0) / 8
    intact = (damage < 1) | (filling >= 0.5)
    assert 0 < (intact & (damage >= 1)).sum() < (damage >= 1).sum()
    to_points = all_points[intact]
    touched = to_points.sum(axis=0) > 0
    to_points = to_points[:, touched]
    to_nodes = to_points.T / to_points.sum(axis=0)[:, None]
    term, want = v[intact], np.zeros_like(v[intact])
    for k in range(1, order + 1):
        term = to_points @ (to_nodes @ term)
        want += (-1) ** (k + 1) * comb(order, k) * term
    got = s.field("velocity")[by_id]
    assert np.abs(got[intact] - want).max() < 1e-9 * np.abs(v).max()
    assert np.abs(got[~intact] - v[~intact]).max() < 1e-12 * np.abs(v).max()
    heat = (s.field("energy")[by_id] * (H / 2) ** 3)[intact]
    taken = to_points @ (to_nodes @ ((v[intact] - want) ** 2).sum(axis=1))
    lost = 0.5 * RHO * (H / 2) ** 3 * (v[intact] ** 2 - want**2).sum()
    assert heat == pytest.approx(lost * taken / taken.sum(), rel=1e-9)
    assert heat.min() > 0
    ledger = s.ledger()
    assert ledger["filtered"] == pytest.approx(heat.sum(), rel=1e-9)
    assert abs(ledger["error"]) < 1e-13 * ledger["initial"]


def test_unseen_pressure_relaxes_and_its_energy_stays_in_the_cells():
    """Each point opens by the share of (1 - S S+)^2 p that its isentrope has for it; the energy of all is what it was.

    From rest to a compression of a third, where a point is five times as stiff.
    """
    rng = np.random.default_rng(7)
    x = (2 + 4 * rng.random((150, 3))) * H
    mu = rng.uniform(0, 0.5, len(x))
    energy = rng.uniform(0, 5e9, len(x))
    pressure = mie_gruneisen(mu, energy)
    volume = (H / 2) ** 3 / (1 + mu)
    state = {"volume": volume, "energy": energy, "pressure": pressure}
    s, by_id = still(x, (0.0, 0.0, 0.0), filtering=(1, 0, 0.5), **state)
    to_points = weights(x, "trilinear")
    to_points = to_points[:, to_points.sum(axis=0) > 0]
    seen = to_points @ (to_points.T / to_points.sum(axis=0)[:, None])
    unseen = pressure - seen @ pressure
    unseen -= seen @ unseen
    ratio, small = 1 / (1 + mu), 1e-6
    closed, opened = (
        mie_gruneisen(1 / (ratio + change) - 1, energy - pressure * change) for change in (-small, small)
    )
    falls = (closed - opened) / (2 * small)
    stiffer = 2 * ratio * np.maximum(-0.5 * unseen, 0)  # in the mean of a rise of the pressure
    growth = 0.5 * unseen / (falls + (4 / 3 * SHEAR + stiffer) / ratio**2)
    work = (pressure - 0.25 * unseen) * growth
    assert np.abs(growth).max() > 1e-3
    got = s.field("volume")[by_id] / (H / 2) ** 3 - ratio
    assert np.abs(got - growth).max() < 1e-5 * np.abs(growth).max()
    after = s.field("energy")[by_id]
    assert np.abs(after - energy - (seen @ work - work)).max() < 1e-5 * np.abs(work).max()
    ledger = s.ledger()
    assert abs(ledger["internal"] - (energy * (H / 2) ** 3).sum()) < 1e-12 * ledger["internal"]
    assert ledger["filtered"] == pytest.approx((work * (H / 2) ** 3).sum(), rel=1e-5)
    assert ledger["filtered"] > 0


def test_an_open_failed_point_has_no_pressure_that_could_change():
    """Every other point has failed and is open, between others under pressure and in tension: it keeps volume and energy."""
    x = (2 + 4 * np.random.default_rng(3).random((600, 3))) * H
    failed = np.arange(len(x)) % 2 == 0
    for pressure in (1e9, -1e9):
        s, order = still(
            x, (0, 0, 0), filtering=(1, 0, 0.5), pressure=np.where(failed, 0.0, pressure), damage=1.0 * failed
        )
        volume = s.field("volume")[order] / (H / 2) ** 3
        moved = np.abs(volume - 1)
        print(f"{pressure:g} Pa: failed {moved[failed].max():.1e}, others {moved[~failed].max():.1e}")
        assert moved[failed].max() < 1e-12
        assert moved[~failed].max() > 1e-4


@pytest.mark.parametrize("speed", ["8 km/s", "12 km/s"])
def test_debris_of_a_fast_impact_gives_no_energy_away(speed):
    """It opens to a vapour, or fails: the filter took energy of it until none was left, and the step fell to nothing."""
    impact = (f"impact.speed='{speed}'", "end_time='26 ns'")
    simulation = Simulation(Scene.load(GALLERY / "09-tillotson.toml", impact), 1)
    simulation.run()
    assert simulation.counters()["negative_energies"] == 0


def test_a_long_wave_of_pressure_is_left_alone():
    """Of a wave over 16 cells the filter relaxes less than a thousandth a time, and (1 - S S+) p would be twenty times as much."""
    x = lattice((0, 0, 0), (16, 16, 16), H / 2)
    pressure = 1e8 * np.cos(np.pi * x[:, 0] / (8 * H))
    s, by_id = still(x, (0.0, 0.0, 0.0), filtering=(1, 0, 0.5), faces=SYMMETRY, pressure=pressure)
    relaxed = (s.field("volume")[by_id] / (H / 2) ** 3 - 1) * (RHO * C0**2 + 4 / 3 * SHEAR)
    print(f"relaxed: {np.abs(relaxed).max() / 1e8:.1e}")
    assert 0 < np.abs(relaxed).max() < 1e-3 * 1e8


@SHAPES
def test_noise_that_no_node_sees_goes_at_once_and_becomes_heat(shape):
    """Points of a cell, two an edge, that move by turns to and fro: order 1 leaves nothing of it away from surfaces."""
    x = lattice((0, 0, 0), (16, 16, 16), H / 2)
    sign = (-1.0) ** np.floor(x / (H / 2)).sum(axis=1)
    v = 50 * sign[:, None] * np.array([1.0, 0.5, -0.3])
    s, by_id = still(x, v, filtering=(1, 1, 0.0), shape=shape, faces=SYMMETRY)
    inner = np.all(np.abs(x - 4 * H) < 2 * H, axis=1)
    assert np.abs(s.field("velocity")[by_id][inner]).max() < 1e-9
    heat = s.field("energy")[by_id][inner]
    assert heat == pytest.approx(0.5 * RHO * (v**2).sum(axis=1)[inner], rel=1e-9)


@SHAPES
def test_a_body_in_uniform_motion_is_not_braked(shape):
    x = lattice((2.3 * H, 2.3 * H, 2.3 * H), (5, 6, 7), H / 2)
    v = np.broadcast_to((700.0, -300.0, 200.0), x.shape)
    s, by_id = still(x, v, filtering=(1, 3, 0.5), shape=shape)
    assert np.abs(s.field("velocity")[by_id] - v).max() < 1e-10
    assert abs(s.ledger()["filtered"]) < 1e-13 * s.ledger()["kinetic"]


def test_the_heat_of_a_point_knows_no_frame():
    """A cloud at 3 km/s gets the heat that it gets at rest: handed out by each point's own loss, some would be cooled."""
    rng = np.random.default_rng(11)
    x = (2 + 4 * rng.random((150, 3))) * H
    v = rng.normal(size=x.shape) * 10
    heats = []
    for frame in (0.0, 3000.0):
        s, by_id = still(x, v + frame, filtering=(1, 3, 0.0))
        heats.append(s.field("energy")[by_id])
    assert heats[0].min() > 0
    assert np.abs(heats[1] - heats[0]).max() < 1e-6 * heats[0].max()


@SHAPES
@pytest.mark.parametrize("contact", [(), ("contact.friction=0.3",)], ids=["sticks", "contact"])
def test_an_impact_closes_its_ledger_and_settles(shape, contact):
    """With failure, transmitting faces and points that leave; less is left in motion than without the filter."""
    sets = (f"numerics.shape_functions={shape}", *contact)
    runs = [
        Simulation(bench_scene(20_000, (*sets, *more)), 2)
        for more in (("numerics.filter.interval=0",), FILTER)
    ]
    for run in runs:
        run.advance(150e-9)
    plain, filtered = (run.ledger() for run in runs)
    print(
        f"kinetic {plain['kinetic'] / plain['initial']:.3f} -> {filtered['kinetic'] / filtered['initial']:.3f}"
    )
    assert filtered["kinetic"] < 0.7 * plain["kinetic"]
    assert filtered["filtered"] > 0.01 * filtered["initial"]
    assert plain["filtered"] == 0
    assert abs(filtered["error"]) < 1e-12 * filtered["initial"]


def test_threads_sleep_and_a_restore_change_no_bit():
    scene = bench_scene(20_000, (*FILTER, "impact.speed=4000"))
    runs = [
        Simulation(scene, threads, driver="cpu", sleep=sleep) for threads, sleep in ((1, False), (2, True))
    ]
    for run in runs:
        run.advance(1.0, max_steps=33)
    runs.append(Simulation(scene, 1, driver="cpu", parts=copied(runs[1].save())))
    for run in runs:
        run.advance(1.0, max_steps=30)
        assert_same_bits(runs[0], run)


def test_a_filter_that_does_nothing_is_refused():
    with pytest.raises(PockmarkError, match=r"numerics\.filter.*order = 0 and pressure = 0"):
        Scene.load(
            QUICK, ["numerics.filter.interval=9", "numerics.filter.order=0", "numerics.filter.pressure=0"]
        )
    with pytest.raises(PockmarkError, match=r"numerics\.filter\.interval"):
        Scene.load(QUICK, ["numerics.filter.interval=-1"])


def test_a_scene_without_a_filter_keeps_its_hash():
    scene = Scene.load(QUICK, ["numerics.filter.interval=0"])
    table = scene.to_dict()
    del table["numerics"]["filter"]
    assert scene.hash == hash_of(table)
    assert scene.hash == Scene.load(QUICK, ["numerics.filter.interval=0", "numerics.filter.order=5"]).hash
    assert scene.hash != Scene.load(QUICK, ["numerics.filter.interval=20"]).hash
