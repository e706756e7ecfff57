"""A velocity of its own: the points have it, the ledger and the forecast know it, and a projectile has none."""

from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene, Simulation
from pockmark.run.points import make_points
from pockmark.run.setup import setup_of
from pockmark.scene.forecast import forecast

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"


def moving(velocity, **body):
    """The quick scene, whose ball is no projectile but moves by itself."""
    table = Scene.load(QUICK).to_dict()
    table["body"][1] |= {"projectile": False, "velocity": velocity, **body}
    return Scene.from_dict(table)


def test_a_body_moves_as_it_says():
    scene = moving(["300 m/s", "0 m/s", "-2 km/s"])
    pieces = [p for p in make_points(scene) if p.body[0] == 1]
    assert all(np.array_equal(p.velocity, np.tile([300.0, 0.0, -2000.0], (len(p.mass), 1))) for p in pieces)
    mass = sum(p.mass.sum() for p in pieces)
    ledger = Simulation(scene, 1).ledger()
    assert ledger["momentum_z"] == pytest.approx(-2000 * mass, rel=1e-9)
    assert ledger["momentum_x"] == pytest.approx(300 * mass, rel=1e-9)
    setup = setup_of(scene)
    assert setup.momentum == pytest.approx(2000 * mass, rel=1e-9)
    assert setup.projectile_mass == 0
    assert setup.walls == ((0,),)  # what moves by itself is no part of the wall that it touches
    assert not any("nothing moves" in said for said in forecast(scene, 1).warnings)
    assert scene.wave_speed == pytest.approx(
        Scene.load(QUICK).wave_speed - 2200 + max(2200, np.hypot(300, 2000))
    )
    assert Scene.from_dict(scene.to_dict()) == scene


def test_it_flies_as_the_projectile_would():
    """The same ball with the same velocity, once as the projectile: the points are the same to the last bit."""
    speed = Scene.load(QUICK).impact.speed
    runs = [Simulation(scene, 1) for scene in (Scene.load(QUICK), moving([0.0, 0.0, -speed]))]
    for simulation in runs:
        simulation.advance(2e-9)
    assert all(
        np.array_equal(runs[0].field(name), runs[1].field(name))
        for name in ("position", "velocity", "energy")
    )


def test_what_contradicts_itself_is_refused():
    with pytest.raises(
        PockmarkError, match=r"body\[1\]\.velocity: found on a projectile, which moves as \[impact\] says"
    ):
        moving(["0 m/s", "0 m/s", "-2 km/s"], projectile=True)
    with pytest.raises(PockmarkError, match="moves it across the symmetry plane y_lower"):
        moving(["0 m/s", "1 m/s", "-2 km/s"])
    with pytest.raises(PockmarkError, match="allowed is -1e"):
        moving(["0 m/s", "0 m/s", "-2000 km/s"])
