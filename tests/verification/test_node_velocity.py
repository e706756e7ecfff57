"""Velocities carried from the mass centres of the nodes' points to the nodes: what is linear stays so, all else holds."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from builders import FIXED, FREE, RHO, SYMMETRY, TRANSMITTING, by_id, elastic, lattice, options, solver
from test_drivers import assert_same_bits, cloud

from pockmark import PockmarkError, Scene
from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation

H = 1e-6
CELLS = 8  # of the grid, an edge
QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
YOUNG, NU = 70e9, 0.3
SHEAR = YOUNG / (2 * (1 + NU))
CORNERS = np.array(list(product((0, 1), repeat=3)))


def body(seed=2, shift=0.3):
    """Points of a block with faces anywhere within cells, a fifth of their spacing off the lattice."""
    x = lattice((2 * H + shift * H, 2.1 * H, 2.2 * H), (7, 6, 8), H / 2)
    return x + np.random.default_rng(seed).uniform(-0.1, 0.1, x.shape) * H


def moving(
    x,
    v,
    *,
    faces=(FREE,) * 6,
    driver="cpu",
    scheme="usf",
    volume="points",
    nodes="linear",
    cells=CELLS,
    **given,
):
    """Return a solver with an elastic body of these points."""
    opts = options(scheme, volume=volume, nodes=nodes, **given)
    bodies = [(x, v, (H / 2) ** 3, RHO, 0)]
    material = elastic(YOUNG, NU, RHO)
    return solver((0, 0, 0), H, (cells,) * 3, list(faces), [material], opts, bodies, driver=driver)


def strain_rates(solver):
    """Return the deviatoric strain rates of the first step, from stresses that were zero: xx, yy, zz, xy, yz, zx."""
    solver.advance(1, 1.0)
    return by_id(solver, "deviator") / (2 * SHEAR * solver.time)


def deviatoric(gradient):
    """Return the deviators of velocity gradients, in the core's order."""
    d = (gradient + np.swapaxes(gradient, -1, -2)) / 2
    d = d - np.trace(d, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) / 3
    return np.stack([d[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=-1)


def around(cells):
    """Return, for each node, the sum of what the cells around it have."""
    out = np.zeros([n + 1 for n in cells.shape[:3]] + list(cells.shape[3:]))
    for i, j, k in CORNERS:
        out[i : i + CELLS, j : j + CELLS, k : k + CELLS] += cells
    return out


def of_corners(nodes, weights):
    """Return, for each cell, the sum of what its corners have, with a weight each."""
    return sum(
        w * nodes[i : i + CELLS, j : j + CELLS, k : k + CELLS]
        for (i, j, k), w in zip(CORNERS, weights, strict=True)
    )


def slopes(nodes):
    """Return, for each cell, the mean slopes of a vector that its nodes have, per cell: [..., component, axis]."""
    return np.stack([of_corners(nodes, (2.0 * CORNERS[:, a] - 1) / 4) for a in range(3)], axis=-1)


def reference(x, v):
    """Return the velocity gradients of points of equal mass: docs/theory.md, Velocities at the nodes."""
    cell = np.floor(x / H).astype(int)
    f = x / H - cell
    mass, momentum, moment = (np.zeros((CELLS + 1,) * 3 + shape) for shape in ((), (3,), (3,)))
    for corner in CORNERS:
        at = tuple((cell + corner).T)
        n = np.prod(np.where(corner, f, 1 - f), axis=1)
        np.add.at(mass, at, n)
        np.add.at(momentum, at, n[:, None] * v)
        np.add.at(moment, at, n[:, None] * x / H)
    with np.errstate(invalid="ignore"):
        mean, centre = (np.nan_to_num(sum_ / mass[..., None]) for sum_ in (momentum, moment))
    place = np.stack(np.meshgrid(*[np.arange(CELLS + 1.0)] * 3, indexing="ij"), axis=-1)
    lever = np.where(mass[..., None] > 0, place - centre, 0.0)
    weight = np.zeros((CELLS,) * 3)
    np.add.at(weight, tuple(cell.T), 1.0)
    filled = (weight > 0)[..., None, None]

    def wide(rows):
        near = of_corners(around(weight[..., None, None] * rows), np.ones(8))
        return around(filled * near)

    span = wide(slopes(place - lever))
    total = around(filled[..., 0, 0] * of_corners(around(weight), np.ones(8)))
    tells = np.linalg.det(span) > 0.1 * total**3
    span[~tells] = np.eye(3)
    over = np.where(tells[..., None], np.linalg.solve(span, lever[..., None])[..., 0], 0.0)
    length = total * np.linalg.norm(over, axis=-1)
    over *= (np.minimum(length, 2) / np.maximum(length, 1e-300))[..., None]
    carried = mean + np.einsum("...ij,...j", wide(slopes(mean)), over)
    out = np.zeros((len(x), 3, 3))
    for corner in CORNERS:
        w, sign = np.where(corner, f, 1 - f), 2.0 * corner - 1
        slope = np.stack([sign[a] * np.prod(np.delete(w, a, axis=1), axis=1) for a in range(3)], axis=-1)
        out += carried[tuple((cell + corner).T)][:, :, None] * slope[:, None, :] / H
    return out


@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_the_strains_are_those_of_a_reference(driver):
    x = body()
    v = np.random.default_rng(5).normal(size=x.shape) * 1e-3  # strains of 1e-8: the squares are no part of it
    got, want = strain_rates(moving(x, v, driver=driver)), deviatoric(reference(x, v))
    off = np.abs(got - want).max() / np.abs(want).max()
    print(f"largest strain rate {np.abs(want).max():.2e}/s, largest difference {off:.1e} of it")
    assert off < 1e-6


def off_by(rates, stretch):
    """Return how far strain rates are off those of a linear velocity: the largest, and all but a fortieth, as shares.

    Levers at corners may be cut to two cells, which leaves some points there with a little of the error of the mean.
    """
    off = np.abs(rates - deviatoric(stretch)).max(axis=1) / np.abs(stretch).max()
    return off.max(), np.quantile(off, 0.975)


@pytest.mark.parametrize("scheme", ["usf", "usl", "musl"])
def test_a_linear_velocity_strains_every_point_alike(scheme):
    """At the surface too, where the mean of the points is another velocity: it strains a body that only turns."""
    x = body()
    stretch = np.array([[3.0, 1.0, -2.0], [0.5, -1.0, 2.0], [1.0, 0.3, 4.0]]) * 1e3
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0]]) * 1e4  # 1/s
    for nodes in ("mean", "linear"):
        worst, most = off_by(
            strain_rates(moving(x, x @ (stretch + turn).T, scheme=scheme, nodes=nodes)), stretch
        )
        print(f"{scheme}, {nodes}: strain rates off by up to {worst:.1e}, 39 in 40 by up to {most:.1e}")
        if nodes == "mean":
            assert most > 0.5
        else:
            assert most < 1e-5
            assert worst < 0.01


def test_within_a_body_nodes_keep_the_mean_and_a_linear_velocity_is_strained_alike_all_the_same():
    """There the mass centres of a lattice lie at the nodes: nothing is carried, and nothing has to be."""
    cells, edge = 13, 20
    x = lattice((1.3 * H, 1.4 * H, 1.1 * H), (edge,) * 3, H / 2)
    inside = np.all((x > x.min(axis=0) + 3.5 * H) & (x < x.max(axis=0) - 3.5 * H), axis=1)
    v = np.random.default_rng(3).normal(size=x.shape) * 1e-3
    mean, linear = (strain_rates(moving(x, v, nodes=nodes, cells=cells)) for nodes in ("mean", "linear"))
    assert inside.sum() > 50
    assert np.array_equal(mean[inside], linear[inside])
    assert np.abs(mean - linear).max() > 0.1 * np.abs(mean).max()
    stretch = np.array([[3.0, 1.0, -2.0], [0.5, -1.0, 2.0], [1.0, 0.3, 4.0]]) * 1e3
    worst, most = off_by(strain_rates(moving(x, x @ stretch.T, cells=cells)), stretch)
    print(
        f"{inside.sum()} of {len(x)} points inside; strain rates off by up to {worst:.1e}, most by {most:.1e}"
    )
    assert most < 1e-5
    assert worst < 0.02


@pytest.mark.parametrize("densities", [(1.0, 1.0), (1.0, 8.0)])
def test_a_face_between_bodies_is_a_surface_where_their_densities_differ(densities):
    """Mass centres lie off the nodes there; a body of equal density goes on behind it."""
    cells = 13
    x = lattice((1 * H,) * 3, (22,) * 3, H / 2)
    light = x[:, 0] < 6.5 * H
    v = np.random.default_rng(3).normal(size=x.shape) * 1e-3
    rates = []
    for nodes in ("mean", "linear"):
        bodies = [
            (x[of], v[of], (H / 2) ** 3, RHO * factor, i)
            for i, (of, factor) in enumerate(zip((light, ~light), densities, strict=True))
        ]
        materials = [elastic(YOUNG, NU, RHO * factor) for factor in densities]
        s = solver((0, 0, 0), H, (cells,) * 3, [FREE] * 6, materials, options("usf", nodes=nodes), bodies)
        rates.append(strain_rates(s)[np.argsort(np.argsort(~light, kind="stable"))])
    within = np.all(np.abs(x - 6.5 * H) < H, axis=1)
    assert np.array_equal(rates[0][within], rates[1][within]) == (densities[0] == densities[1])


def momenta(s):
    """Return the angular momentum about the origin, kg m^2/s, and momentum, kg m/s."""
    x, v, m = s.field("position"), s.field("velocity"), s.field("mass")[:, None]
    return (m * np.cross(x, v)).sum(axis=0), (m * v).sum(axis=0)


@pytest.mark.parametrize("volume", ["points", "cells"])
@pytest.mark.parametrize("filtering", [(0, 0, 0.0), (2, 3, 0.5), (2, 2, 0.0)])
def test_a_free_body_keeps_its_momenta_and_its_energy(volume, filtering):
    """Random velocities: what they turn into is no part of it."""
    x = body()
    v = np.random.default_rng(6).normal(size=x.shape) * 20 + np.cross([0, 0, 3e7], x)
    changes = {}
    for nodes in ("mean", "linear"):
        s = moving(x, v, scheme="usavg", volume=volume, nodes=nodes, filtering=filtering)
        before = momenta(s)
        s.advance(20, 1.0)
        turned, moved = (np.abs(now - was).max() for now, was in zip(momenta(s), before, strict=True))
        changes[nodes] = turned / np.abs(before[0]).max()
        assert moved < 1e-12 * np.abs(s.field("mass")[:, None] * v).sum()
        assert abs(s.ledger()["error"]) < 1e-12 * s.ledger()["initial"]
    print(f"angular momentum changes by {changes['mean']:.1e} with means, {changes['linear']:.1e} linear")
    assert changes["linear"] < 0.02 * changes["mean"]


@pytest.mark.parametrize("faces", [FREE, SYMMETRY, FIXED, TRANSMITTING])
@pytest.mark.parametrize("driver", ["cpu", "plain"])
def test_the_ledger_closes_where_points_fill_the_grid_to_its_faces(faces, driver):
    """What carries the velocity and what takes the force back are each other's transpose, mirrors included."""
    x = lattice((0, 0, 0), (2 * CELLS,) * 3, H / 2)[:-200]
    v = np.random.default_rng(1).normal(size=x.shape) * 20
    s = moving(x, v, faces=(faces,) * 6, scheme="usavg", volume="cells", driver=driver)
    s.advance(4, 1.0)
    print(f"ledger error {s.ledger()['error'] / s.ledger()['initial']:.1e}")
    assert abs(s.ledger()["error"]) < 1e-12 * s.ledger()["initial"]


@pytest.mark.parametrize("filtering", [(0, 0, 0.0), (2, 3, 0.5)])
def test_half_of_a_body_before_a_mirror_is_as_in_the_whole(filtering):
    x = body(shift=0.0)
    half = x[:, 0] - x[:, 0].min() + 0.07 * H
    near = np.column_stack([half, x[:, 1:]])
    v = np.random.default_rng(7).normal(size=x.shape) * 20
    centre = np.array([CELLS / 2 * H, 0, 0])
    image = near * [-1, 1, 1]
    whole = moving(
        np.concatenate([near, image]) + centre,
        np.concatenate([v, v * [-1, 1, 1]]),
        scheme="usavg",
        volume="cells",
        filtering=filtering,
    )
    mirrored = moving(
        near, v, faces=(SYMMETRY, *[FREE] * 5), scheme="usavg", volume="cells", filtering=filtering
    )
    for s in (whole, mirrored):
        s.advance(6, 1.0)
    got, want = by_id(mirrored, "velocity"), by_id(whole, "velocity")[: len(x)]
    off = np.abs(got - want).max() / np.abs(want).max()
    print(f"velocities differ by {off:.1e} of the largest")
    assert off < 1e-10


def test_strain_does_not_depend_on_the_frame():
    x = body()
    v = np.random.default_rng(8).normal(size=x.shape) * 0.01
    still, flying = (strain_rates(moving(x, v + u)) for u in (0.0, 1000.0))
    # Their steps are not of the same length, and strains not quite small.
    assert np.abs(flying - still).max() < 1e-6 * np.abs(still).max()


def test_a_lone_point_and_a_row_of_points_keep_the_mean():
    """They tell no gradient: nothing is carried, and nothing divided by what is not there."""
    x = np.array([[2.3, 2.4, 2.6]] + [[4.2 + 0.3 * i, 5.5, 5.5] for i in range(6)]) * H
    v = np.random.default_rng(9).normal(size=x.shape)
    mean, linear = (strain_rates(moving(x, v, nodes=nodes)) for nodes in ("mean", "linear"))
    assert np.array_equal(mean, linear)


@pytest.mark.parametrize("volume", ["points", "cells"])
def test_the_drivers_agree_on_random_points(volume):
    plain, cpu = (
        cloud("usavg", "trilinear", driver, volume=volume, nodes="linear") for driver in ("plain", "cpu")
    )
    for name, want in plain.items():
        assert np.abs(cpu[name] - want).max() <= 1e-10 * np.abs(want).max(), name


def test_two_threads_give_the_bits_of_one():
    sets = ("numerics.node_velocity=linear", "numerics.volumetric_strain=cells", "numerics.filter.interval=4")
    scene = bench_scene(20_000, (*sets, "impact.speed=4000"))
    one, two = (Simulation(scene, threads, driver="cpu") for threads in (1, 2))
    for simulation in (one, two):
        simulation.advance(1.0, max_steps=40)
    assert_same_bits(one, two)


def test_that_quadratic_functions_do_not_go_with_it_is_said():
    with pytest.raises(
        PockmarkError, match=r"numerics\.node_velocity: found 'linear' .*shape_functions 'quadratic'"
    ):
        Scene.load(QUICK, ["numerics.node_velocity=linear", "numerics.shape_functions=quadratic"])
