"""However the core walks the points, the result is the same: by either driver, asleep or awake, one thread or two."""

import numpy as np
import pytest
from builders import FREE, RHO, TRANSMITTING, aluminium, by_id, core, elastic, lattice, options, solver

from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation

H = 4e-6
FIELDS = ("position", "velocity", "volume", "energy", "pressure", "viscosity", "deviator", "damage")
SHAPES = pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
LEAVING = ("impact.speed=12000", "grid.upper=['100 um', '100 um', '21 um']")  # points fly through the lid
SCHEMES = pytest.mark.parametrize("scheme", ["usf", "musl", "usl", "usavg"])


def cloud(scheme, shape, driver, *, single=False, seed=3, volume="points", nodes="mean"):
    """Random points of two bodies: runs of every length, lone points, empty cells, packs that hold both bodies."""
    rng = np.random.default_rng(seed)
    n, cells = 1500, (9, 17, 7)
    # Squared, so that some cells are crowded and some empty.
    x = (rng.random((n, 3)) ** 2 * (np.array(cells) - 1.0) + 0.5) * H
    v = rng.normal(size=(n, 3)) * 50
    body = rng.integers(0, 2, n)
    options = core.Options(
        scheme=getattr(core.Scheme, scheme),
        shape=getattr(core.ShapeFunction, shape),
        volumetric_strain=getattr(core.VolumetricStrain, volume),
        node_velocity=getattr(core.AtNodes, nodes),
        cfl=0.5,
        strain_limit=0.2,
        pic_fraction=0.02,
        mass_cutoff=0.0,
        sleep=True,
    )
    bodies = [(x[body == b], v[body == b], H**3 / 8, RHO, b) for b in (0, 1)]
    s = solver(
        (0, 0, 0),
        H,
        cells,
        [TRANSMITTING, FREE, FREE, TRANSMITTING, FREE, FREE],
        [aluminium(), aluminium()],
        options,
        bodies,
        single=single,
        driver=driver,
    )
    s.advance(6, 1.0)
    order = np.argsort(s.field("id"))
    return {name: s.field(name)[order] for name in FIELDS}


@SHAPES
@SCHEMES
@pytest.mark.parametrize(("single", "tolerance"), [(False, 1e-11), (True, 3e-3)], ids=["fp64", "fp32"])
def test_the_drivers_agree_on_random_points(scheme, shape, single, tolerance):
    plain, cpu = (cloud(scheme, shape, driver, single=single) for driver in ("plain", "cpu"))
    worst = 0.0
    for name, want in plain.items():
        scale = np.abs(want).max()
        if scale > 0:
            worst = max(worst, np.abs(cpu[name] - want).max() / scale)
    print(
        f"{scheme} {shape} {'fp32' if single else 'fp64'}: largest difference {worst:.1e} of a field's largest"
    )
    assert worst < tolerance


def assert_same_bits(one, other):
    for name in FIELDS:
        assert np.array_equal(one.field(name), other.field(name)), name
    assert one.ledger() == other.ledger()


@SHAPES
@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
def test_sleep_changes_no_bit(scheme, shape):
    """An impact on a target larger than its waves have come: what sleeps would have stayed as it was."""
    sets = (f"numerics.scheme={scheme}", f"numerics.shape_functions={shape}", "numerics.node_velocity=mean")
    scene = bench_scene(60_000, (*sets, "impact.speed=4000"))
    runs, asleep = [], []
    for sleep in (False, True):
        simulation = Simulation(scene, 1, driver="cpu", sleep=sleep)
        for _ in range(12):
            simulation.advance(1.0, max_steps=1)
            asleep.append(simulation.sleeping_points)
        runs.append(simulation)
    share = np.array(asleep[12:]) / runs[0].points
    print(f"{scheme} {shape}: {share[0]:.0%} asleep after a step, {share[-1]:.0%} after twelve")
    assert not any(asleep[:12])
    assert share[0] > 0.2
    assert share[-1] < share[0]
    assert_same_bits(*runs)
    assert runs[0].counters() == runs[1].counters()


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
def test_sleep_changes_no_bit_where_velocities_are_carried(scheme, axis):
    """What is carried moves points farther off in a step than else, and so does a filter: a long bar, struck at one end."""
    cells, points = [8, 8, 8], [7, 7, 7]
    cells[axis], points[axis] = 150, 280
    x = lattice((2.3 * H, 2.3 * H, 2.3 * H), points, H / 2)
    v = np.where(x[:, [axis]] < 5 * H, np.random.default_rng(4).normal(size=x.shape) * 300, 0.0)
    runs = []
    for sleep in (False, True):
        opts = options(scheme, volume="cells", nodes="linear", filtering=(3, 3, 0.5), sleep=sleep)
        bodies = [(x, v, (H / 2) ** 3, RHO, 0)]
        s = solver((0, 0, 0), H, cells, [FREE] * 6, [elastic(70e9, 0.3, RHO)], opts, bodies, driver="cpu")
        runs.append(s)
    asleep = []
    for _ in range(9):
        for s in runs:
            s.advance(1, 1.0)
        asleep.append(runs[1].sleeping_points / len(x))
        for name in FIELDS:
            assert np.array_equal(by_id(runs[0], name), by_id(runs[1], name)), name
    print(f"{scheme}: asleep after each step: {', '.join(f'{share:.0%}' for share in asleep)}")
    assert runs[0].sleeping_points == 0
    assert asleep[0] > 0.5
    assert 0 < asleep[-1] < asleep[0]


@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
def test_points_mapped_ahead_are_mapped_as_they_would_be(scheme):
    """Through sorts and points that leave: to set a field, to what it is, has them mapped anew in the next step."""
    scene = bench_scene(20_000, (f"numerics.scheme={scheme}", "numerics.filter.interval=0", *LEAVING))
    runs = [Simulation(scene, 1, driver="cpu", sleep=False) for _ in range(2)]
    for _ in range(250):
        runs[0].advance(1.0, max_steps=1)
        solver = runs[1]._solver
        solver.set_field("temperature", solver.field("temperature"))
        runs[1].advance(1.0, max_steps=1)
    print(f"{scheme}: {runs[0].sorts} sorts, {runs[0].counters()['left_points']} points left")
    assert runs[0].sorts > 2
    assert runs[0].counters()["left_points"] > 0
    assert_same_bits(*runs)


@pytest.mark.parametrize(
    ("precision", "scheme"), [("double", "usavg"), ("single", "usavg"), ("double", "usf"), ("double", "musl")]
)
def test_threads_change_no_bit_of_an_impact(precision, scheme):
    """Through sorts, points that leave, and tiles that wake."""
    interval = 0 if scheme == "musl" else 10  # filtered, none of its points leaves so early
    numerics = (
        f"numerics.precision={precision}",
        f"numerics.scheme={scheme}",
        f"numerics.filter.interval={interval}",
    )
    scene = bench_scene(20_000, (*numerics, *LEAVING))
    runs = []
    for threads in (1, 2, 2):
        simulation = Simulation(scene, threads, driver="cpu")
        simulation.advance(60e-9)
        runs.append(simulation)
    left = runs[0].counters()["left_points"]
    print(f"{precision}: {runs[0].steps} steps, {runs[0].sorts} sorts, {left} points left")
    assert runs[0].sorts > 2
    assert left > 0
    for other in runs[1:]:
        assert_same_bits(runs[0], other)
