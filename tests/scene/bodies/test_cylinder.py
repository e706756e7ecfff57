"""Cylinders: the mass, size and moments that are asked, halves and quarters, the grid's rim, overlap with any other shape."""

import math
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene, Simulation
from pockmark.run.setup import setup_of
from pockmark.scene.bodies import Block, Cylinder, Sphere, Swarm, overlap
from pockmark.scene.forecast import forecast
from pockmark.scene.warnings import cells_across

QUICK = Path(__file__).parents[3] / "examples" / "quick.toml"
UM = 1e-6
CENTER = (1.37 * UM, -0.71 * UM, 3.3 * UM)
SIZES = [
    (2.0, 0.0, 1.0),
    (3.3, 0.0, 7.7),
    (5.0, 2.0, 4.0),
    (6.3, 4.4, 0.6),
    (9.7, 1.1, 31.0),
    (12.5, 11.0, 5.5),
]


def cylinder(radius, inner=0.0, length=10.0, *, spacing=UM, center=CENTER, **keys):
    """Sizes in um."""
    sizes = {"radius": radius * UM, "inner_radius": inner * UM, "length": length * UM}
    return Cylinder(shape="cylinder", name="c", material="m", spacing=spacing, center=center, **sizes, **keys)


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("cut", [0, 1, 2, 3])
def test_it_has_the_mass_that_is_asked(axis, size, cut):
    """Whole, and halved, quartered or cut in eight by symmetry planes through its middle, which lies anywhere."""
    body = cylinder(*size, axis=axis)
    box = [[-math.inf] * 3, [math.inf] * 3]
    box[0][:cut] = CENTER[:cut]
    x = body.lattice(box)
    radius, inner, length = size
    asked = math.pi * (radius**2 - inner**2) * length * UM**3
    assert len(x) == body.count(box)
    assert len(x) * body.point_volume * 2**cut / asked == pytest.approx(1, rel=1e-9)
    assert all(body.is_halved_by(a, CENTER[a], 1e-15) for a in range(3))


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("size", [s for s in SIZES if s[0] - s[1] > 2])
def test_it_has_its_centre_size_and_moments(axis, size):
    body = cylinder(*size, axis=axis)
    x = body.lattice() - np.array(CENTER)
    w = "xyz".index(axis)
    radial, half = body.fits
    radius, inner, length = (s * UM for s in size)
    rho = np.linalg.norm(np.delete(x, w, axis=1), axis=1)
    assert abs(x.mean(axis=0)).max() < 1e-9 * UM
    assert max(radial.pitch, half.pitch) <= body.spacing * (1 + 1e-9)
    assert inner <= rho.min()
    assert rho.max() < radius
    assert abs(x[:, w]).max() + half.pitch / 2 == pytest.approx(length / 2, rel=1e-9)
    polar = ((rho**2).mean() + radial.pitch**2 / 6) / ((radius**2 + inner**2) / 2)
    print(
        f"{size}: second moment {polar:.4f}, {body.point_volume / radial.pitch**2 / half.pitch:.4f} bricks a point"
    )
    assert polar == pytest.approx(1, abs=0.05)
    assert body.points_about == pytest.approx(body.count(), rel=0.25)


def test_rounded_has_exactly_the_spacing():
    body = cylinder(6.4, 2.6, 9.0, rounded=True)
    assert [fit.pitch for fit in body.fits] == [UM, UM]
    assert body.point_volume == pytest.approx(UM**3)
    assert body.fits[0].length == pytest.approx(6 * UM)
    rho = np.hypot(*(body.lattice() - np.array(CENTER))[:, :2].T)
    assert rho.min() >= 3 * UM  # 2.6 rounds to 3


def test_what_is_no_cylinder_is_refused():
    with pytest.raises(ValueError, match="at least the spacing"):
        cylinder(5, 4.5)
    with pytest.raises(ValueError, match="at least the spacing"):
        cylinder(5, 6)
    with pytest.raises(ValueError, match="needs either a center"):
        cylinder(5, center=(0.0, 0.0))


def scene(*overrides, **body):
    """The quick scene, a half model, with a cylinder for its ball."""
    table = Scene.load(QUICK).to_dict()
    kept = {k: table["body"][1][k] for k in ("name", "material", "projectile", "spacing")}
    sizes = {
        "shape": "cylinder",
        "center": ["0 um", "0 um"],
        "gap": "0 um",
        "radius": "8 um",
        "length": "12 um",
    }
    table["body"][1] = kept | sizes | body
    return Scene.from_dict(table, overrides=overrides)


@pytest.mark.parametrize("axis", "xyz")
def test_a_half_is_placed_touches_and_runs(axis):
    loaded = scene(axis=axis)
    mass = math.pi * 64 * 12 / 2 * UM**3 * 2770
    setup = setup_of(loaded)
    assert setup.projectile_mass == pytest.approx(mass, rel=1e-9)
    assert setup.projectile_diameter == pytest.approx(16 * UM, rel=1e-9)
    assert cells_across(loaded) == pytest.approx(12 * UM / loaded.grid.cell)
    assert loaded.body[1].box[0][2] == pytest.approx(0, abs=1e-9 * UM)
    simulation = Simulation(loaded, 1)
    ledger = simulation.ledger()
    assert ledger["momentum_z"] == pytest.approx(-mass * 2200, rel=1e-9)
    simulation.advance(1e-9)
    assert simulation.counters()["lost_points"] == 0
    assert abs(simulation.ledger()["error"]) < 1e-4 * ledger["initial"]


def test_it_keeps_to_the_grid():
    with pytest.raises(PockmarkError, match="outside the grid's face y_lower"):
        scene(center=["0 um", "1 um"])
    with pytest.raises(PockmarkError, match="outside the grid's face z_upper"):
        scene(length="200 um")
    top = Scene.load(QUICK).grid.corner[2] / UM
    scene(length=f"{top} um")  # it may touch the face


def test_a_coarse_one_is_told():
    said = forecast(scene(inner_radius="7 um", spacing="1 um"), 1).warnings
    assert any("through the cylinder's wall" in text for text in said)
    assert cells_across(scene(inner_radius="6 um", spacing="1 um")) == pytest.approx(
        2 * UM / scene().grid.cell
    )


def block(lower, upper):
    corners = {"lower": tuple(x * UM for x in lower), "upper": tuple(x * UM for x in upper)}
    return Block(shape="block", name="b", material="m", spacing=UM, **corners)


def ball(center, radius):
    return Sphere(
        shape="sphere",
        name="s",
        material="m",
        spacing=UM,
        center=tuple(x * UM for x in center),
        radius=radius * UM,
    )


def tube(axis="z", center=(0.0, 0.0, 0.0), radius=10.0, inner=6.0, length=20.0):
    return cylinder(radius, inner, length, axis=axis, center=tuple(x * UM for x in center))


OVERLAPS = [
    (tube(), block((-30, -30, -20), (30, 30, -10)), False),  # it stands on it
    (tube(), block((-30, -30, -20), (30, 30, -9.9)), True),
    (tube("x"), block((-30, -30, -20), (30, 30, -10)), False),  # it lies on it
    (tube("x"), block((-30, -30, -20), (30, 30, -9.99)), True),
    (tube(), ball((0, 0, 0), 6), False),  # a ball in a tube
    (tube(), ball((0, 0, 0), 6.01), True),
    (tube(), ball((13, 0, 0), 3), False),
    (tube(), ball((12.99, 0, 0), 3), True),
    (tube(), tube(radius=6, inner=0, length=40), False),  # a rod in a tube
    (tube(), tube(radius=6.01, inner=0, length=40), True),
    (tube(), tube(radius=6, inner=0, length=40, center=(0.05, 0, 0)), True),
    (tube(), tube(center=(20, 0, 0)), False),
    (tube(), tube(center=(14.1, 14.1, 0)), True),
    (tube(), tube(center=(14.2, 14.2, 0)), False),
    (tube(), tube("x", center=(0, 0, 20)), False),  # crossed, one on the other
    (tube(), tube("x", center=(0, 0, 19.9)), True),
    (tube(), block((-4, -4, -50), (4, 4, 50)), False),  # a square rod in a tube
    (tube(), block((-4.3, -4.3, -50), (4.3, 4.3, 50)), True),
    (tube(inner=0), block((7.1, 7.1, -50), (20, 20, 50)), False),  # the box's corner, but not the round
    (tube(inner=0), block((7.0, 7.0, -50), (20, 20, 50)), True),
]  # fmt: skip


@pytest.mark.parametrize(("a", "b", "expected"), OVERLAPS)
def test_overlap_is_of_what_is_filled(a, b, expected):
    assert overlap(a, b) is expected
    assert overlap(b, a) is expected


def contains(body, x):
    """Whether places lie in a body as it is written."""
    if isinstance(body, Block):
        return np.all((x > body.lower) & (x < body.upper), axis=1)
    if isinstance(body, Cylinder):
        w = "xyz".index(body.axis)
        local = x - np.array(body.center)
        rho = np.linalg.norm(np.delete(local, w, axis=1), axis=1)
        return (rho > body.inner_radius) & (rho < body.radius) & (abs(local[:, w]) < body.length / 2)
    places = np.array(body.places)[:, None]
    return (np.linalg.norm(x - places, axis=2) < body.written_radius).any(axis=0)


def random_body(rng):
    center = rng.uniform(-12, 12, 3)
    kind = rng.integers(4)
    if kind == 0:
        half = rng.uniform(1, 8, 3)
        return block(center - half, center + half)
    if kind == 1:
        return ball(center, rng.uniform(1, 8))
    if kind == 2:
        keys = {"lower": (-12 * UM, -12 * UM), "upper": (12 * UM, 12 * UM), "height": center[2] * UM}
        return Swarm(
            shape="swarm",
            name="w",
            material="m",
            spacing=UM,
            pitch=8 * UM,
            radius=rng.uniform(1, 4) * UM,
            **keys,
        )
    radius = rng.uniform(2, 8)
    inner = rng.choice([0.0, rng.uniform(0, radius - 1.1)])
    return tube(str(rng.choice(list("xyz"))), center, radius, inner, rng.uniform(1, 16))


def test_overlap_is_what_places_say():
    """Random pairs against a hundred thousand places: what shares places overlaps, and nothing else but what shares hardly any."""
    rng, seen, thin = np.random.default_rng(5), {True: 0, False: 0}, 0
    places = rng.uniform(-20, 20, (100_000, 3)) * UM
    for _ in range(300):
        a, b = random_body(rng), random_body(rng)
        shared = int((contains(a, places) & contains(b, places)).sum())
        found = overlap(a, b)
        seen[found] += 1
        assert found or not shared
        thin += found and not shared
        assert overlap(b, a) is found
    print(seen, f"{thin} overlap by less than the places show")
    assert min(seen.values()) > 50
    assert thin < 15
