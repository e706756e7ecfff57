"""Two bodies in contact with Coulomb friction: what collides parts again, slides and rolls as mechanics says."""

import numpy as np
import pytest
from builders import FIXED, FREE, SYMMETRY, by_id, core, elastic, lattice, options

from pockmark.bench import bench_scene
from pockmark.simulation import Simulation

G, TILT = 2e-4, np.radians(30)  # in cells and the bar speed: the slab sinks in by a thousandth of a cell
LOADING = 60.0  # time in which gravity grows, so that the load does not bounce
H, SPEED = 1.0, 1e-2  # cell; of each bar, in bar speeds


def solver(bodies, friction, cells, faces, *, scheme="usavg", lanes=None, threads=1, nu=0.3):
    """bodies: (position, velocity, volumes of the points); density 1, Young's modulus 1. friction None: sticky."""
    opts = options(scheme)
    if lanes is not None:
        opts = core.Options(
            scheme=getattr(core.Scheme, scheme),
            shape=core.ShapeFunction.trilinear,
            cfl=0.5,
            strain_limit=0.2,
            pic_fraction=0.0,
            mass_cutoff=0.0,
            lanes=lanes,
            sleep=True,
        )
    s = core.Solver(
        lower=(0.0, 0.0, 0.0),
        cell=H,
        cells=cells,
        faces=faces,
        materials=[elastic(1.0, nu, 1.0)] * len(bodies),
        options=opts,
        threads=threads,
    )
    if friction is not None:
        s.set_contact([0, 1], friction)
    for i, (x, velocity, volume) in enumerate(bodies):
        n = len(x)
        v = np.ascontiguousarray(np.broadcast_to(velocity, (n, 3)), dtype=float)
        volumes = np.ascontiguousarray(np.broadcast_to(volume, n), dtype=float)
        s.add_points(position=x, velocity=v, mass=volumes, volume=volumes, body=np.full(n, i, dtype=np.uint8))
    s.initialize()
    return s


def bars(friction, gap=1.0, **kwargs):
    """Two equal bars with nu = 0 run into each other along x: waves without dispersion by the sides."""
    left = lattice((6 - gap / 2, 0, 0), (20, 2, 2), 0.5)
    right = lattice((16 + gap / 2, 0, 0), (20, 2, 2), 0.5)
    bodies = [(left, (SPEED, 0, 0), 0.125), (right, (-SPEED, 0, 0), 0.125)]
    return solver(bodies, friction, (32, 1, 1), [FREE, FREE] + [SYMMETRY] * 4, nu=0.0, **kwargs)


def mean_velocity(s, body):
    return s.field("velocity")[s.field("body") == body].mean(axis=0)


@pytest.mark.parametrize("scheme", ["usavg", "usf", "musl"])
def test_equal_bars_exchange_momenta_and_part(scheme):
    s = bars(0.3, scheme=scheme)
    unit = SPEED * s.ledger()["mass"] / 2
    s.advance(10**6, 200.0)
    left, right = mean_velocity(s, 0)[0] / SPEED, mean_velocity(s, 1)[0] / SPEED
    ledger = s.ledger()
    total = abs(ledger["momentum_x"]) / unit
    gap = by_id(s, "position")[:, 0].reshape(2, -1)
    error = ledger["error"] / ledger["initial"]
    print(
        f"{scheme}: {left:+.3f} and {right:+.3f} of the speed before, momentum {total:.1e}, ledger {error:+.1e}, "
        f"contact took {ledger['contact'] / ledger['initial']:.3f}"
    )
    assert total < 1e-13
    # The waves that the grid disperses stay in the bars as vibration.
    assert left == pytest.approx(-1.0, abs=0.1)
    assert right == pytest.approx(1.0, abs=0.1)
    assert gap[1].min() - gap[0].max() > 2.5  # the grid no longer couples them
    assert abs(error) < (1e-12 if scheme == "usavg" else 0.06)


def test_one_field_is_sticky_and_feels_the_contact_cells_early():
    """What contact is for: without it equal bars meet a cell or two before they touch, and do not part."""
    touch = 1.0 / (2 * SPEED)
    felt = {}
    for friction in (None, 0.3):
        s = bars(friction)
        while mean_velocity(s, 0)[0] > 0.99 * SPEED:
            s.advance(1, 1e9)
        felt[friction] = 2 * SPEED * (s.time - touch)
    s = bars(None)
    s.advance(10**6, 500.0)
    x = by_id(s, "position")[:, 0].reshape(2, -1)
    gap = x[1].min() - x[0].max() - 0.5
    print(
        f"felt {-felt[None]:.2f} cells early when sticky, {-felt[0.3]:+.3f} with contact; sticky gap {gap:.2f}"
    )
    assert felt[None] < -0.5
    assert abs(felt[0.3]) < 0.05
    assert gap < 2.0


def down_the_slope(body, volume, friction, cells, end):
    """Velocity along a flat slab, in g sin(TILT) t, and spin, of a body that gravity acts on at a tilt, as kicks."""
    slab = lattice((0, 0, 0), (2 * cells[0], 2, 4), 0.5)
    s = solver(
        [(slab, 0.0, 0.125), (body, 0.0, volume)],
        friction,
        cells,
        [FREE, FREE, SYMMETRY, SYMMETRY, FIXED, FREE],
    )
    kick = G * np.array([np.sin(TILT), 0.0, -np.cos(TILT)])
    rows = []
    while s.time < end:
        s.advance(1, 1e9)
        v, moves = s.field("velocity"), s.field("body") == 1
        v[moves] += min(1.0, s.time / LOADING) * kick * s.dt
        s.set_field("velocity", v)
        rows.append((s.time, np.average(v[moves, 0], weights=s.field("mass")[moves])))
    t, u = np.array(rows[len(rows) // 4 :]).T
    return np.polyfit(t, u, 1)[0] / (G * np.sin(TILT)), s


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.4, 0.8])
def test_block_on_an_incline(friction):
    """Slips with a = g (sin - mu cos); sticks where mu > tan, but for a creep of steady speed (docs/theory.md)."""
    block = lattice((3, 0, 2), (16, 2, 8), 0.5)
    exact = max(0.0, 1 - friction / np.tan(TILT))
    end = 300.0 if exact > 0 else 600.0
    a, s = down_the_slope(block, 0.125, friction, (24, 1, 9), end)
    free = G * np.sin(TILT) * end**2 / 2
    gone = (s.field("position")[s.field("body") == 1, 0].mean() - 7) / free
    print(f"mu {friction}: a = {a:.4f} g sin, exact {exact:.4f}; gone {gone:.3f} of a free slide")
    if exact > 0:
        assert a == pytest.approx(exact, abs=0.01)
    else:
        assert abs(gone) < 0.08


def cylinder(radius, x, z, pitch=0.5):
    """Points on rings, so that it is round, in a slice one cell thick; their volumes."""
    points, volumes = [], []
    for r in np.arange(pitch / 2, radius, pitch):
        n = round(2 * np.pi * r / pitch)
        angle = 2 * np.pi * (np.arange(n) + 0.5) / n
        for y in (0.25, 0.75):
            points.append(np.stack([x + r * np.cos(angle), np.full(n, y), z + r * np.sin(angle)], axis=1))
            volumes.append(np.full(n, 2 * np.pi * r * pitch * 0.5 / n))
    return np.concatenate(points), np.concatenate(volumes)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.4])
def test_cylinder_rolls_or_slides(friction):
    """Rolls with a = 2/3 g sin where mu >= tan/3, and slides with g (sin - mu cos) below."""
    radius = 8.0
    a, s = down_the_slope(*cylinder(radius, 10.0, 2 + radius), friction, (36, 1, 21), 300.0)
    exact = 2 / 3 if friction >= np.tan(TILT) / 3 else 1 - friction / np.tan(TILT)
    rows = s.field("body") == 1
    x, v, m = (s.field(name)[rows] for name in ("position", "velocity", "mass"))
    dx, dv = x - np.average(x, axis=0, weights=m), v - np.average(v, axis=0, weights=m)
    spin = (m * (dx[:, 2] * dv[:, 0] - dx[:, 0] * dv[:, 2])).sum() / (m * (dx**2)[:, ::2].sum(axis=1)).sum()
    rolling = spin * radius / np.average(v[:, 0], weights=m)
    rolls = min(1.0, 2 * friction / np.tan(TILT) / exact)
    print(
        f"mu {friction}: a = {a:.3f} g sin, exact {exact:.3f}; spin {rolling:.3f} of rolling, exact {rolls:.3f}"
    )
    assert a == pytest.approx(exact, abs=0.03)
    assert rolling == pytest.approx(rolls, abs=0.15)


def oblique(**kwargs):
    """A brick hits a slab at a slant, in free space."""
    slab = lattice((2, 2, 2), (24, 24, 8), 0.5)
    brick = lattice((5.2, 5.1, 6.3), (8, 8, 8), 0.5)
    bodies = [(slab, 0.0, 0.125), (brick, (0.05, 0.02, -0.08), 0.125)]
    s = solver(bodies, 0.3, (18, 18, 14), [FREE] * 6, **kwargs)
    s.advance(60, 1e9)
    return s


def test_contact_keeps_momentum_and_energy():
    s = oblique()
    ledger = s.ledger()
    volume = 4.0**3
    lost = max(
        abs(ledger[f"momentum_{a}"] - volume * v) for a, v in zip("xyz", (0.05, 0.02, -0.08), strict=True)
    )
    error = ledger["error"] / ledger["initial"]
    share = ledger["contact"] / ledger["initial"]
    print(f"momentum {lost / (0.08 * volume):.1e}, ledger {error:+.1e}, contact took {share:.3f}")
    assert lost < 1e-12 * volume
    assert abs(error) < 1e-13
    assert share > 0.01


def test_threads_change_no_bit_of_contact():
    runs = [oblique(threads=threads) for threads in (1, 2)]
    for name in ("position", "velocity", "deviator", "energy"):
        assert np.array_equal(runs[0].field(name), runs[1].field(name)), name
    assert runs[0].ledger() == runs[1].ledger()
    print(f"bit-identical over {runs[0].cycle} steps")


@pytest.mark.skipif(not core.build_info()["lanes"], reason="this core has one driver only")
def test_lanes_agree_with_the_scalar_driver_in_contact():
    one_by_one, lanes = (oblique(lanes=use) for use in (False, True))
    a, b = by_id(one_by_one, "velocity"), by_id(lanes, "velocity")
    worst = np.abs(a - b).max() / np.abs(a).max()
    print(f"largest difference {worst:.1e} of the largest velocity")
    assert worst < 1e-10


def test_what_an_impact_loses_to_contact_falls_with_the_cell():
    """Contact is inelastic in the layer of nodes that it acts on: too much of an impact on few cells."""
    lost = []
    for points in (60_000, 480_000):
        simulation = Simulation(bench_scene(points, ("impact.speed=2200", "contact.friction=0")), 1)
        simulation.advance(4e-9)
        ledger = simulation.ledger()
        assert abs(ledger["error"]) < 1e-12 * ledger["initial"]
        lost.append(ledger["contact"] / ledger["initial"])
    print(f"contact without friction took {lost[0]:.3f} of the energy, in half the cell {lost[1]:.3f}")
    assert lost[1] < 0.5 * lost[0]
