"""What flies out of a transmitting face takes its energy and momentum along; only the target's waves are absorbed."""

from pathlib import Path

import numpy as np
import pytest
from builders import RHO, TRANSMITTING, aluminium, lattice, options, solver

from pockmark import Scene, Simulation

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
UM = 1e-6
FACES = {f"{axis}_{end}": "transmitting" for axis in "xyz" for end in ("lower", "upper")}
BALL = {
    "end_time": 1e-6,
    "grid": {"lower": [-40 * UM] * 3, "upper": [40 * UM] * 3, "cell": 4 * UM},
    "boundary": FACES,
    "impact": {"speed": 500.0, "angle": 0.0},
    "body": [
        {
            "name": "ball",
            "shape": "sphere",
            "center": [0.0, 0.0, 0.0],
            "radius": 8 * UM,
            "spacing": 2 * UM,
            "material": "al2024-liu2015",
            "projectile": True,
        }
    ],
}


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize(
    ("speed", "degrees"), [(500.0, 80.0), (3000.0, 80.0), (3000.0, 45.0), (10000.0, 0.0)]
)
def test_a_free_ball_passes_a_transmitting_face(shape, precision, speed, degrees):
    """Through a side face, over an edge, and through the lower face."""
    numerics = (f"numerics.shape_functions={shape}", f"numerics.precision={precision}")
    scene = Scene.from_dict(
        BALL, overrides=[*numerics, f"impact.speed={speed}", f"impact.angle={degrees} deg"]
    )
    simulation = Simulation(scene, 1)
    before = simulation.ledger()
    simulation.advance(100 * UM / speed)
    after = simulation.ledger()
    carried = after["left_energy"] / before["initial"]
    gained = [after[f"left_momentum_{a}"] - before[f"momentum_{a}"] for a in "xyz"]
    missing = np.abs(gained).max() / (before["mass"] * speed)
    print(
        f"{shape} {precision} {speed:g} m/s: energy carried out {carried:.6f}, momentum missing {missing:.1e}"
    )
    assert simulation.points == 0
    assert after["left_mass"] == pytest.approx(before["mass"], rel=1e-6)
    assert carried == pytest.approx(1.0, abs=0.01)
    assert missing < 0.01
    assert simulation.counters()["lost_points"] == 0


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("upper", [False, True], ids=["lower", "upper"])
@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
def test_debris_of_the_target_passes_above_its_surface(axis, upper, shape):
    """A clump of the target's own material flies out beside the target, which fills the same face further down."""
    h, cells = 1e-6, 12
    down = (axis + 1) % 3  # the direction into the target
    counts, lower = [2 * cells] * 3, [0.0] * 3
    counts[down] = 8
    block = lattice(lower, counts, h / 2)
    clump = lattice([4 * h] * 3, (8, 8, 8), h / 2)
    clump[:, down] += 3 * h
    v = np.zeros(3)
    v[axis] = 800.0 if upper else -800.0
    volume = h**3 / 8
    s = solver(
        (0, 0, 0),
        h,
        (cells,) * 3,
        [TRANSMITTING] * 6,
        [aluminium()],
        options("usavg", shape),
        [(block, (0, 0, 0), volume, RHO, 0), (clump, v, volume, RHO, 0)],
    )
    before = s.ledger()
    s.advance(10**6, 12 * h / 800.0)
    after = s.ledger()
    print(
        f"{shape}: carried out {after['left_energy'] / before['initial']:.6f}, absorbed {after['absorbed']:.1e} J"
    )
    assert s.counters()["left_points"] == len(clump)
    assert after["left_energy"] == pytest.approx(before["initial"], rel=0.01)


def ricochet(half):
    """Energy and momentum along x that have left, as shares, of a ball that ricochets off a block `half` um wide."""
    overrides = [
        "impact.angle='60 deg'",
        "impact.speed='3 km/s'",
        f"grid.lower=['-{half} um', '0 um', '-30 um']",
        f"grid.upper=['{half} um', '{half} um', '50 um']",
        f"body.target.lower=['-{half} um', '0 um', '-30 um']",
        f"body.target.upper=['{half} um', '{half} um', '0 um']",
    ]
    simulation = Simulation(Scene.load(QUICK, overrides), 2)
    simulation.advance(100e-9)
    ledger = simulation.ledger()
    z, v, mass = (simulation.field(name) for name in ("position", "velocity", "mass"))
    flying = z[:, 2] > 5 * UM
    inside = 0.5 * (mass * (v**2).sum(axis=1))[flying].sum()
    momentum = ledger["left_momentum_x"] + (mass * v[:, 0])[flying].sum()
    whole = 2 * ledger["initial"] / 3000.0
    return (ledger["left_kinetic"] + inside) / ledger["initial"], momentum / whole


def test_a_ricochet_leaves_a_small_domain_as_a_large_one():
    """Farther on debris is slower, with any scheme that strains by cells: it skids along the block, to which it sticks."""
    small, large = ricochet(40), ricochet(50)
    print(f"flying or left: energy {small[0]:.3f}, {large[0]:.3f}; momentum {small[1]:.3f}, {large[1]:.3f}")
    assert large[0] > 0.2
    assert small[0] == pytest.approx(large[0], rel=0.1)
    assert small[1] == pytest.approx(large[1], rel=0.1)
