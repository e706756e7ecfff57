"""Two bodies in contact with Coulomb friction: what collides parts again, slides and rolls as mechanics says."""

import numpy as np
import pytest
from builders import (
    FIXED,
    FREE,
    RHO,
    SYMMETRY,
    aluminium,
    by_id,
    core,
    elastic,
    lattice,
    law,
    material,
    options,
)
from builders import solver as build

from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation

G, TILT = 2e-4, np.radians(30)  # in cells and the bar speed: the slab sinks in by a thousandth of a cell
LOADING = 60.0  # time in which gravity grows, so that the load does not bounce
H, SPEED = 1.0, 1e-2  # cell; of each bar, in bar speeds


def solver(bodies, friction, cells, faces, *, threads=1, nu=0.3, single=False, driver=core.DRIVER, **choices):
    """bodies: (position, velocity, volumes of the points); density 1, Young's modulus 1. friction None: sticky. The rest is of options()."""
    s = core.solver(single=single, driver=driver)(
        lower=(0.0, 0.0, 0.0),
        cell=H,
        cells=cells,
        faces=faces,
        materials=[elastic(1.0, nu, 1.0)] * len(bodies),
        options=options(**choices),
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


def bars(friction, length=10, gap=1.0, **kwargs):
    """Two equal bars, `length` cells long, run into each other along x; with nu = 0 the sides do not disperse waves."""
    left = lattice((6 - gap / 2, 0, 0), (2 * length, 2, 2), 0.5)
    right = lattice((6 + length + gap / 2, 0, 0), (2 * length, 2, 2), 0.5)
    bodies = [(left, (SPEED, 0, 0), 0.125), (right, (-SPEED, 0, 0), 0.125)]
    cells = (12 + 2 * length, 1, 1)
    return solver(bodies, friction, cells, [FREE, FREE] + [SYMMETRY] * 4, nu=0.0, **kwargs)


def mean_velocity(s, body):
    return s.field("velocity")[s.field("body") == body].mean(axis=0)


def rebound(length, scheme="usavg"):
    """What is left of the bars' speed after their collision, and the ledger."""
    s = bars(0.3, length, scheme=scheme)
    unit = SPEED * s.ledger()["mass"] / 2
    s.advance(10**6, 50.0 + 7.0 * length)
    left, right = mean_velocity(s, 0)[0] / SPEED, mean_velocity(s, 1)[0] / SPEED
    ledger = s.ledger()
    x = by_id(s, "position")[:, 0].reshape(2, -1)
    momentum, error = abs(ledger["momentum_x"]) / unit, ledger["error"] / ledger["initial"]
    print(
        f"{scheme}, {length} cells: {left:+.3f} and {right:+.3f} of the speed before, momentum {momentum:.1e}, "
        f"ledger {error:+.1e}, contact took {ledger['contact'] / ledger['initial']:.3f}"
    )
    assert momentum < 1e-13
    assert left == pytest.approx(-right, abs=1e-12)
    assert x[1].min() - x[0].max() > 1.3  # they parted
    return right, error


def test_equal_bars_exchange_velocities_the_better_the_finer():
    lost = []
    for length in (10, 20, 40):
        right, error = rebound(length)
        lost.append(1 - right)
        assert abs(error) < 1e-13
    assert lost[0] < 0.12
    assert lost[1] < 0.07
    assert lost[2] < 0.65**2 * lost[0]  # what is left is vibration: a front in a grid is h^(2/3) wide


@pytest.mark.parametrize("scheme", ["usf", "musl"])
def test_bars_part_with_the_other_schemes(scheme):
    right, error = rebound(10, scheme)
    assert right > 0.8
    assert abs(error) < 0.1


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


def down_the_slope(body, volume, friction, cells, end, **choices):
    """Velocity along a flat slab, in g sin(TILT) t, and spin, of a body that gravity acts on at a tilt, as kicks."""
    slab = lattice((0, 0, 0), (2 * cells[0], 2, 4), 0.5)
    s = solver(
        [(slab, 0.0, 0.125), (body, 0.0, volume)],
        friction,
        cells,
        [FREE, FREE, SYMMETRY, SYMMETRY, FIXED, FREE],
        **choices,
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


def block_on_an_incline(friction, end, **choices):
    """Its acceleration in g sin(TILT), and how far it came, as a share of a free slide."""
    block = lattice((3, 0, 2), (16, 2, 8), 0.5)
    a, s = down_the_slope(block, 0.125, friction, (24, 1, 9), end, **choices)
    free = G * np.sin(TILT) * end**2 / 2
    gone = (s.field("position")[s.field("body") == 1, 0].mean() - 7) / free
    print(f"mu {friction}: a = {a:+.4f} g sin; gone {gone:.4f} of a free slide")
    return a, gone


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.4])
def test_a_block_slips_on_an_incline(friction):
    a, _ = block_on_an_incline(friction, 300.0)
    assert a == pytest.approx(1 - friction / np.tan(TILT), abs=0.01)


@pytest.mark.parametrize("friction", [0.7, 0.8])
def test_a_block_sticks_on_an_incline(friction):
    """mu > tan(30 deg) = .577. Without any PIC the block's vibration never ends, and it creeps (docs/theory.md)."""
    a, gone = block_on_an_incline(friction, 600.0, pic=0.05)
    assert abs(a) < 2e-3
    assert abs(gone) < 2e-3
    assert 0.01 < block_on_an_incline(friction, 600.0)[1] < 0.08


def cylinder(radius, x, z, pitch=0.5):
    """Points on rings, so that it is round, in a slice one cell thick; their volumes."""
    position, volumes = [], []
    for r in np.arange(pitch / 2, radius, pitch):
        n = round(2 * np.pi * r / pitch)
        angle = 2 * np.pi * (np.arange(n) + 0.5) / n
        for y in (0.25, 0.75):
            position.append(np.stack([x + r * np.cos(angle), np.full(n, y), z + r * np.sin(angle)], axis=1))
            volumes.append(np.full(n, 2 * np.pi * r * pitch * 0.5 / n))
    return np.concatenate(position), np.concatenate(volumes)


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.4])
def test_cylinder_rolls_or_slides(friction):
    """Rolls with a = 2/3 g sin where mu >= tan/3, and slides with g (sin - mu cos) below."""
    radius = 8.0
    a, s = down_the_slope(*cylinder(radius, 10.0, 2 + radius), friction, (40, 1, 21), 600.0)
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
    assert rolling == pytest.approx(rolls, abs=0.06)


def oblique(**kwargs):
    """A brick hits a slab at a slant, in free space."""
    slab = lattice((2, 2, 2), (24, 24, 8), 0.5)
    brick = lattice((5.2, 5.1, 6.3), (8, 8, 8), 0.5)
    bodies = [(slab, 0.0, 0.125), (brick, (0.05, 0.02, -0.08), 0.125)]
    s = solver(bodies, 0.3, (18, 18, 14), [FREE] * 6, **kwargs)
    s.advance(60, 1e9)
    return s


@pytest.mark.parametrize(("single", "tolerance"), [(False, 1e-13), (True, 1e-5)])
def test_contact_keeps_momentum_and_energy(single, tolerance):
    s = oblique(single=single)
    ledger = s.ledger()
    mass = 4.0**3
    lost = [ledger[f"momentum_{a}"] / mass - v for a, v in zip("xyz", (0.05, 0.02, -0.08), strict=True)]
    error, share = ledger["error"] / ledger["initial"], ledger["contact"] / ledger["initial"]
    print(f"momentum {np.abs(lost).max() / 0.08:.1e}, ledger {error:+.1e}, contact took {share:.3f}")
    assert np.abs(lost).max() < 0.08 * tolerance
    assert abs(error) < tolerance
    assert share > 0.01


def test_threads_change_no_bit_of_contact():
    runs = [oblique(threads=threads) for threads in (1, 2)]
    for name in ("position", "velocity", "deviator", "energy"):
        assert np.array_equal(runs[0].field(name), runs[1].field(name)), name
    assert runs[0].ledger() == runs[1].ledger()
    print(f"bit-identical over {runs[0].cycle} steps")


def test_the_drivers_agree_in_contact():
    a, b = (by_id(oblique(driver=driver), "velocity") for driver in ("plain", "cpu"))
    worst = np.abs(a - b).max() / np.abs(a).max()
    print(f"largest difference {worst:.1e} of the largest velocity")
    assert worst < 1e-10


def test_an_impact_without_friction_loses_next_to_nothing_to_contact():
    """An impulse that the points felt whole would take .36 and .15 of the energy here (docs/theory.md)."""
    for points in (60_000, 480_000):
        simulation = Simulation(bench_scene(points, ("impact.speed=2200", "contact.friction=0")), 1)
        simulation.advance(4e-9)
        ledger = simulation.ledger()
        share = ledger["contact"] / ledger["initial"]
        print(f"{points} points: contact took {share:.4f} of the energy")
        assert abs(ledger["error"]) < 1e-12 * ledger["initial"]
        assert 0 <= share < 0.02


# ---- when contact begins -------------------------------------------------------------------------

CELL = 2e-6


def falling(speed, gap, *, single=False, shape="trilinear", scheme="usavg", cfl=0.5, ice=False):
    """A block of aluminium, or of ice as a fluid, comes down on aluminium, `gap` cells below it; exactly one-dimensional."""
    soft = material(
        law("mie-gruneisen", c0=2500.0, s=1.5, gamma0=1.0), law("fluid"), density=917.0, q=(1.5, 0.06)
    )
    volume = (CELL / 2) ** 3
    target = lattice((0, 0, 0), (4, 4, 40), CELL / 2)
    block = lattice((0, 0, (20 + gap) * CELL), (4, 4, 30), CELL / 2)
    return build(
        (0, 0, 0),
        CELL,
        (2, 2, 60),
        [SYMMETRY] * 4 + [FREE, FREE],
        [aluminium(), soft if ice else aluminium()],
        options(scheme, shape, cfl=cfl),
        [(target, (0, 0, 0), volume, RHO, 0), (block, (0, 0, -speed), volume, 917.0 if ice else RHO, 1)],
        single=single,
        friction=0.0,
    )


def overlap(s):
    """How far the blocks lie within each other, in cells. The points are squeezed along z only, so their thickness is known."""
    z, second = s.field("position")[:, 2], s.field("body") == 1
    half = s.field("volume") / (CELL / 2) ** 2 / 2
    return ((z + half)[~second].max() - (z - half)[second].min()) / CELL


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
@pytest.mark.parametrize("ice", [False, True], ids=["aluminium", "ice"])
@pytest.mark.parametrize("speed", [500.0, 2000.0, 10000.0, 15000.0])
def test_nothing_comes_within_the_other_body(speed, ice, shape):
    """However the steps fall on the moment of touch: 0.05 cells at most, which bounds how late contact can be, too."""
    deepest = 0.0
    for gap in (0.0, 0.1, 0.35, 0.5, 0.7):
        s = falling(speed, gap, ice=ice, shape=shape)
        while s.time < (gap + 3) * CELL / speed:
            s.advance(1, 1.0)
            deepest = max(deepest, overlap(s))
    print(f"{speed:g} m/s, {'ice' if ice else 'aluminium'}, {shape}: {deepest:+.3f} cells within")
    assert deepest < 0.05


@pytest.mark.parametrize("scheme", ["usavg", "usf", "musl"])
@pytest.mark.parametrize("single", [False, True], ids=["fp64", "fp32"])
def test_no_last_bit_decides_when_contact_begins(scheme, single):
    """Surfaces that coincide, or are apart or within by a billionth of a cell; single precision as double."""
    speeds = []
    for gap in (0.0, 1e-9, -1e-9):
        s = falling(2000.0, gap, scheme=scheme)
        s.advance(40, 1.0)
        speeds.append(by_id(s, "velocity")[:, 2])
    other = falling(2000.0, 0.0, scheme=scheme, single=single)
    other.advance(40, 1.0)
    speeds.append(by_id(other, "velocity")[:, 2])
    worst = [np.abs(v - speeds[0]).max() / 2000.0 for v in speeds[1:]]
    print(
        f"{scheme}: by a billionth of a cell {max(worst[:2]):.1e}, {'single' if single else 'the same'} {worst[2]:.1e}"
    )
    assert max(worst[:2]) < 1e-7
    assert worst[2] < (1e-3 if single else 1e-15)
