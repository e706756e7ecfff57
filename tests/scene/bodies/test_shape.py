"""Bodies as they are placed: the size and mass that are asked, nothing dropped, faces and overlap held against the points."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene, Simulation
from pockmark.run.points import make_points
from pockmark.run.setup import setup_of
from pockmark.scene.bodies import Block, Sphere, Swarm, overlap

QUICK = Path(__file__).parents[3] / "examples" / "quick.toml"
UM = 1e-6
RATIOS = [
    1.5,
    2.0,
    2.5,
    3.5,
    4.5,
    5.0,
    6.3,
    8.0,
    10.0,
    12.5,
    20.0,
    *np.random.default_rng(1).uniform(1.5, 20, 12),
]


def ball(ratio, spacing=2 * UM, center=(0.0, 0.0, 0.0), **keys):
    keys |= {"shape": "sphere", "name": "p", "material": "m", "spacing": spacing, "center": center}
    return Sphere(radius=ratio * spacing, **keys)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("cut", [0, 1, 2])
def test_a_ball_has_the_mass_that_is_asked(ratio, cut):
    """Whole, and halved or quartered by symmetry planes through its centre, which lies anywhere."""
    center = (1.37 * UM, -0.71 * UM, 3.3 * UM)
    body = ball(ratio, center=center)
    box = [[-math.inf] * 3, [math.inf] * 3]
    box[0][:cut] = center[:cut]
    x = body.lattice(box)
    share = len(x) * body.point_volume / (4 / 3 * math.pi * body.radius**3) * 2**cut
    assert len(x) == body.count(box)
    assert share == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_ball_has_its_centre_size_and_moments(ratio):
    body = ball(ratio, center=(1.37 * UM, -0.71 * UM, 3.3 * UM))
    x = body.lattice() - np.array(body.center)
    pitch = body.fit.pitch
    assert pitch <= body.spacing * (1 + 1e-9)
    assert abs(x.mean(axis=0)).max() < 1e-9 * body.radius
    assert abs(x).max() + pitch / 2 == pytest.approx(
        body.radius, rel=1e-9
    )  # so that it touches where it is asked to
    second = ((x**2).mean(axis=0) + pitch**2 / 12) / (body.radius**2 / 5)
    n = body.fit.number
    print(
        f"radius {n:g} pitches: second moment {second[0]:.4f} of a ball's, {body.point_volume / pitch**3:.4f} cubes a point"
    )
    assert second == pytest.approx(1, abs=0.17 if n < 4 else 0.055 if n < 6 else 0.03)


@pytest.mark.parametrize("half", [1.5, 2.5, 3.5, 4.5, 9.5])
@pytest.mark.parametrize("rounded", [False, True])
def test_float_noise_decides_nothing(half, rounded):
    """A radius of n and a half spacings is the same ball, however the half was computed."""
    found = {
        ball(half * (1 + noise), rounded=rounded).count() for noise in (-2e-16, 0.0, 2e-16, 1e-12, -1e-12)
    }
    whole = {ball((half + 0.5) * (1 + noise), rounded=rounded).count() for noise in (-1e-12, 0.0, 1e-12)}
    assert len(found) == len(whole) == 1


@pytest.mark.parametrize("sides", [(10.0, 7.0, 3.0), (10.3, 7.7, 3.1), (1.0, 0.4, 50.5)])
def test_a_block_has_the_size_that_is_asked(sides):
    block = Block(
        shape="block",
        name="b",
        material="m",
        spacing=UM,
        lower=(-2 * UM, 0.0, -sides[2] * UM),
        upper=((sides[0] - 2) * UM, sides[1] * UM, 0.0),
    )
    x = block.lattice()
    assert len(x) * block.point_volume == pytest.approx(math.prod(sides) * UM**3, rel=1e-9)
    half = [fit.pitch / 2 for fit in block.fits]
    assert x.min(axis=0) - half == pytest.approx(block.lower, abs=1e-9 * UM)
    assert x.max(axis=0) + half == pytest.approx(block.upper, abs=1e-9 * UM)


def scene(*overrides):
    return Scene.load(QUICK, ["body.projectile.rounded=false", *overrides])


@pytest.mark.parametrize("radius", ["5 um", "6.1 um", "9.3 um", "10 um"])
def test_every_point_that_is_counted_is_there(radius):
    loaded = scene(
        f"body.projectile.radius='{radius}'",
        "body.projectile.center=['0 um', '0 um']",
        "body.projectile.gap='0 um'",
    )
    pieces = list(make_points(loaded))
    assert sum(len(p.mass) for p in pieces) == sum(b.count(loaded.grid.box) for b in loaded.body)
    mass = sum(p.mass[p.body == 1].sum() for p in pieces)
    asked = 2 / 3 * math.pi * loaded.body[1].radius ** 3 * 2770
    assert mass == pytest.approx(asked, rel=1e-9)
    assert setup_of(loaded).projectile_mass == pytest.approx(asked, rel=1e-9)
    assert setup_of(loaded).projectile_diameter == pytest.approx(2 * loaded.body[1].radius, rel=1e-9)
    assert all(np.allclose(p.mass, 2770 * p.volume, rtol=1e-15) for p in pieces)
    simulation = Simulation(loaded, 1)
    assert simulation.ledger()["mass"] == pytest.approx(asked + 2770 * 100 * 50 * 50 * UM**3, rel=1e-9)


def test_a_ball_that_reaches_out_of_the_grid_is_refused():
    """Its upper points used to be dropped without a word."""
    with pytest.raises(
        PockmarkError, match=r"body\[1\] 'projectile': reaches 1 um outside the grid's face z_upper"
    ):
        scene("grid.upper=['50 um', '50 um', '20 um']", "body.projectile.center=['0 um', '0 um', '11 um']")
    with pytest.raises(PockmarkError, match=r"outside the grid's face y_lower"):
        scene("body.projectile.center=['0 um', '1 um', '10 um']")


def test_overlap_is_of_what_is_placed():
    """7.6 um with 2 um between points: rounded, it is a ball of 8 um, and reaches into a block 7.6 um away."""
    block = Block(
        shape="block", name="b", material="m", spacing=UM, lower=(-9 * UM,) * 3, upper=(9 * UM, 9 * UM, 0.0)
    )
    asked, rounded = (ball(3.8, center=(0.0, 0.0, 7.6 * UM), rounded=r) for r in (False, True))
    assert not overlap(block, asked)
    assert overlap(block, rounded)
    assert overlap(rounded, block)
    beside = ball(3.8, center=(15.4 * UM, 0.0, 7.6 * UM), rounded=True)
    assert overlap(rounded, beside)  # 16 um wide, 15.4 um apart
    assert not overlap(asked, ball(3.8, center=(15.4 * UM, 0.0, 7.6 * UM)))


def test_rounded_is_told_with_its_mass():
    """The ball of cases/ball-rounded.toml: refused as it was placed, right as it is asked."""
    keys = (
        "body.projectile.radius='7 um'",
        "body.projectile.spacing='1.9 um'",
        "body.projectile.center=['0 um', '0 um', '7 um']",
    )
    assert setup_of(scene(*keys)).projectile_mass == pytest.approx(
        2 / 3 * math.pi * (7 * UM) ** 3 * 2770, rel=1e-9
    )
    with pytest.raises(PockmarkError, match="overlaps"):
        scene(*keys, "body.projectile.rounded=true")


@pytest.mark.parametrize("rounded", [False, True])
def test_a_gap_keeps_a_projectile_above_the_surface(rounded):
    for radius, gap in itertools.product((3.1, 5.0, 9.7), (0.0, 2.0)):
        body = Sphere(
            shape="sphere", name="p", material="m", spacing=2 * UM, rounded=rounded,
            center=(0.0, 0.0), gap=gap * UM, radius=radius * UM,
        )  # fmt: skip
        lowest = body.lattice()[:, 2].min() - body.fit.pitch / 2
        assert lowest == pytest.approx(gap * UM, abs=1e-9 * UM)
        assert body.box[0][2] == pytest.approx(gap * UM, abs=1e-9 * UM)


def test_a_swarm_keeps_its_gap_for_any_flux():
    for flux in (0.001, 0.005, 0.01):
        body = Swarm(
            shape="swarm", name="s", material="m", spacing=UM, lower=(-50 * UM, 0.0), upper=(50 * UM, 50 * UM),
            gap=UM, pitch=25 * UM, flux=flux,
        ).resolved(2770.0)  # fmt: skip
        assert body.lattice()[:, 2].min() - body.fit.pitch / 2 == pytest.approx(UM, rel=1e-9)
