"""Rigid motion is kept: free flight through the grid, and spin."""

import numpy as np
import pytest
from builders import FREE, PRECISIONS, RHO, aluminium, elastic, lattice, options, solver

YOUNG, NU, DENSITY = 73e9, 0.33, 2770.0
SPEED = np.sqrt(YOUNG / DENSITY)
H = 4e-6
SCHEMES = [("usf", "trilinear"), ("musl", "trilinear"), ("usavg", "trilinear"), ("usavg", "quadratic")]


@pytest.mark.parametrize(("scheme", "shape"), SCHEMES)
@PRECISIONS
def test_free_flight(scheme, shape, single):
    """A block crosses cells at constant velocity: no stress, no change of velocity."""
    velocity = np.array([310.0, -170.0, 90.0])
    position = lattice((10 * H, 10 * H, 10 * H), (8, 8, 8), H / 2)
    s = solver(
        (0, 0, 0),
        H,
        (24, 24, 24),
        [FREE] * 6,
        [elastic(YOUNG, NU, DENSITY)],
        options(scheme, shape),
        [(position, np.tile(velocity, (len(position), 1)), H**3 / 8, DENSITY, 0)],
        single=single,
    )
    time = 4 * H / 310.0
    s.advance(10**6, time)
    order = np.argsort(s.field("id"))
    moved = s.field("position")[order] - position
    drift = np.abs(s.field("velocity") - velocity).max() / 310.0
    stress = np.abs(s.field("deviator")).max() / YOUNG
    print(f"{scheme} {shape}: {s.cycle} steps, velocity drift {drift:.1e}, stress {stress:.1e} E")
    tolerance = 1e-4 if single else 1e-10
    assert np.allclose(moved, velocity * time, rtol=tolerance)
    assert drift < tolerance
    assert stress < tolerance


def spun(radius, scheme, shape, single):
    """Relative changes of angular momentum and kinetic energy of a ball (radius in points) after a quarter turn."""
    axis = np.arange(-radius, radius) + 0.5
    ball = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    ball = ball[(ball**2).sum(axis=1) < radius**2] * H / 2
    cells = radius + 6
    centre = np.full(3, cells / 2 * H)
    omega = 0.02 * SPEED / (radius * H / 2)  # the rim moves at 2 % of the bar speed
    v = np.stack([-omega * ball[:, 1], omega * ball[:, 0], np.zeros(len(ball))], axis=1)
    s = solver(
        (0, 0, 0),
        H,
        (cells, cells, cells),
        [FREE] * 6,
        [elastic(YOUNG, NU, DENSITY)],
        options(scheme, shape, cfl=0.5),
        [(ball + centre, v, H**3 / 8, DENSITY, 0)],
        single=single,
    )

    def spin():
        x, u, m = s.field("position") - centre, s.field("velocity"), s.field("mass")
        return (m * (x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0])).sum()

    before = spin()
    s.advance(10**6, np.pi / 2 / omega)
    ledger = s.ledger()
    return spin() / before - 1, ledger["kinetic"] / ledger["initial"] - 1, ledger["error"] / ledger["initial"]


@pytest.mark.parametrize(("scheme", "shape"), SCHEMES)
@PRECISIONS
def test_rigid_spin(scheme, shape, single):
    """A lumped mass matrix brakes a spinning ball through its surface nodes: the loss falls with the cell."""
    coarse, fine = spun(6, scheme, shape, single), spun(12, scheme, shape, single)
    print(
        f"{scheme} {shape}: radius 3 and 6 cells: angular momentum {coarse[0]:+.3f}, {fine[0]:+.3f}; "
        f"kinetic {coarse[1]:+.3f}, {fine[1]:+.3f}; ledger {fine[2]:+.1e}"
    )
    assert abs(fine[0]) < 0.6 * abs(coarse[0])
    assert abs(fine[0]) < 0.1
    if scheme == "usavg":
        assert abs(fine[2]) < (1e-4 if single else 1e-9)


@pytest.mark.parametrize("scale", [1.0, 1e-3], ids=["um", "nm"])
@pytest.mark.parametrize("offset", [0.0, 0.5, 0.25])
@PRECISIONS
def test_nodes_of_hardly_any_mass_have_a_velocity(scale, offset, single):
    """Points on the edge of quadratic stencils: a node's share of their mass is smaller than single precision's least number."""
    h = H * scale
    block = lattice((2 * h, 2 * h, 2 * h), (4, 4, 4), h) + offset * h
    ball = block + np.array([0.0, 0.0, 4 * h])
    s = solver(
        (0, 0, 0),
        h,
        (12, 12, 14),
        [FREE] * 6,
        [aluminium()],
        options("usavg", "quadratic"),
        [(block, (0, 0, 0), h**3, RHO, 0), (ball, (0, 0, -2000.0), h**3, RHO, 0)],
        single=single,
    )
    s.advance(40, 1.0)
    ledger = s.ledger()
    print(
        f"{scale:g}, {offset}: internal {ledger['internal'] / ledger['initial']:.4f}, error {ledger['error'] / ledger['initial']:.1e}"
    )
    assert np.isfinite(s.field("velocity")).all()
    assert ledger["internal"] > 0.1 * ledger["initial"]
    assert abs(ledger["error"]) < (1e-4 if single else 1e-9) * ledger["initial"]
