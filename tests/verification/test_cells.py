"""Volumetric strain by cells: the plateau of a shock in any frame, and all that holds with the points' own."""

from pathlib import Path

import numpy as np
import pytest
from builders import FREE, RHO, SYMMETRY, TRANSMITTING, aluminium, lattice, options, solver
from test_drivers import assert_same_bits, cloud
from test_hugoniot import MOVING, TABLE, off, shock_in_a_frame

from pockmark import PockmarkError, Scene
from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation

H = 1e-6
QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
CELLS = "numerics.volumetric_strain=cells"
SHAPES = pytest.mark.parametrize("shape", ["trilinear", "quadratic"])


@SHAPES
@pytest.mark.parametrize(
    ("at_rest", "v"), [case[:2] for case in MOVING] + [("none", 700.0), ("none", 4500.0)]
)
def test_the_plateau_holds_in_any_frame(at_rest, v, shape):
    """With trilinear functions the points' own volumetric strain leaves .51 of the pressure at 1 km/s."""
    got = shock_in_a_frame(at_rest, v, shape, "cells")
    assert off(got.pressure, TABLE[v][1] * 1e9) < 0.012
    if shape == "trilinear":
        assert got.ripple < 0.08


def test_the_points_of_a_linear_flow_have_its_divergence():
    """Where velocity is linear in space, cells and points say the same, away from surfaces: volumes agree to rounding."""
    x = lattice((2 * H, 2 * H, 2 * H), (24, 24, 24), H / 2)
    gradient = np.array([[3.0, 1.0, -2.0], [0.5, -1.0, 2.0], [1.0, 0.3, 4.0]]) * 1e3
    volumes = []
    for volume in ("points", "cells"):
        s = solver(
            (0, 0, 0),
            H,
            (16, 16, 16),
            [FREE] * 6,
            [aluminium()],
            options(volume=volume),
            [(x, x @ gradient.T, (H / 2) ** 3, RHO, 0)],
        )
        s.advance(1, 1.0)
        inner = np.all(
            np.abs(x - 8 * H) < 2 * H, axis=1
        )  # the mapping to the nodes is not linear at a surface
        volumes.append((s.field("volume")[np.argsort(s.field("id"))] / (H / 2) ** 3 - 1)[inner])
    print(f"dilation {volumes[0].mean():.3e}, largest difference {np.abs(volumes[1] - volumes[0]).max():.1e}")
    assert volumes[0].min() > 1e-8
    assert np.abs(volumes[1] - volumes[0]).max() < 1e-3 * volumes[0].mean()


@SHAPES
@pytest.mark.parametrize("faces", [FREE, SYMMETRY, TRANSMITTING], ids=["free", "symmetry", "transmitting"])
@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_the_ledger_closes_where_points_fill_the_grid_to_its_faces(shape, faces, driver):
    """Strain and force are each other's transpose: what random velocities lose is what the points gain."""
    x = lattice((0, 0, 0), (12, 12, 12), H / 2)
    v = np.random.default_rng(1).normal(size=x.shape) * 20
    s = solver(
        (0, 0, 0),
        H,
        (6, 6, 6),
        [faces] * 6,
        [aluminium()],
        options(shape=shape, volume="cells"),
        [(x, v, (H / 2) ** 3, RHO, 0)],
        driver=driver,
    )
    s.advance(30, 1.0)
    ledger = s.ledger()
    print(f"error {ledger['error'] / ledger['initial']:.1e} of the energy")
    assert abs(ledger["error"]) < 1e-13 * ledger["initial"]


@SHAPES
@pytest.mark.parametrize("contact", [(), ("contact.friction=0.3",)], ids=["sticks", "contact"])
def test_an_impact_closes_its_ledger(shape, contact):
    """With failure, transmitting faces and points that leave."""
    leaving = ("impact.speed=12000", "grid.upper=['100 um', '100 um', '21 um']")
    simulation = Simulation(
        bench_scene(20_000, (CELLS, f"numerics.shape_functions={shape}", *contact, *leaving)), 2
    )
    simulation.advance(150e-9)
    ledger, counters = simulation.ledger(), simulation.counters()
    print(f"error {ledger['error'] / ledger['initial']:.1e}, {counters['left_points']} points left")
    assert counters["left_points"] > 0 or shape == "quadratic"
    assert abs(ledger["error"]) < 1e-12 * ledger["initial"]


@SHAPES
@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
@pytest.mark.parametrize(("single", "tolerance"), [(False, 1e-11), (True, 3e-3)], ids=["fp64", "fp32"])
def test_the_drivers_agree_on_random_points(scheme, shape, single, tolerance):
    plain, cpu = (cloud(scheme, shape, driver, single=single, volume="cells") for driver in ("plain", "cpu"))
    for name, want in plain.items():
        scale = np.abs(want).max()
        assert np.abs(cpu[name] - want).max() <= tolerance * scale, name


@SHAPES
def test_threads_sleep_and_a_restore_change_no_bit(shape):
    scene = bench_scene(20_000, (CELLS, f"numerics.shape_functions={shape}", "impact.speed=4000"))
    runs = [
        Simulation(scene, threads, driver="cpu", sleep=sleep) for threads, sleep in ((1, False), (2, True))
    ]
    for run in runs:
        run.advance(1.0, max_steps=30)
    parts = {
        name: np.array(part) if isinstance(part, np.ndarray) else part
        for name, part in runs[1].save().items()
    }
    runs.append(Simulation(scene, 1, driver="cpu", parts=parts))
    for run in runs:
        run.advance(1.0, max_steps=30)
        assert_same_bits(runs[0], run)


def test_a_fluid_in_free_flight_keeps_its_volume():
    """Cells beside a surface, where nodes have no mass, take no part: nothing is strained by the void."""
    x = lattice((10.3 * H, 10.3 * H, 10.3 * H), (12, 12, 12), H / 2)
    s = solver(
        (0, 0, 0),
        H,
        (40, 40, 40),
        [FREE] * 6,
        [aluminium()],
        options(volume="cells"),
        [(x, (500.0, 300.0, 200.0), (H / 2) ** 3, RHO, 0)],
    )
    s.advance(10**6, 15 * H / 500)
    ledger = s.ledger()
    print(f"{s.cycle} steps, internal energy {ledger['internal'] / ledger['kinetic']:.1e} of the kinetic one")
    assert abs(ledger["internal"]) < 1e-20 * ledger["kinetic"]
    assert np.abs(s.field("volume") / (H / 2) ** 3 - 1).max() < 1e-10


def test_usl_is_refused_with_cells():
    """USL strains by the velocities of slivers of mass, which cells would carry farther."""
    with pytest.raises(PockmarkError, match=r"numerics\.volumetric_strain"):
        Scene.load(QUICK, ["numerics.scheme='usl'", "numerics.volumetric_strain='cells'"])
