"""Axisymmetric craters and holes on synthetic rings: what is measured must be what was carved, as in three dimensions."""

import numpy as np
import pytest

from pockmark.base.geometry import Mirror, Setup, Wall
from pockmark.metrology.cautions import of_crater, of_hole
from pockmark.metrology.ejecta import find_ejecta
from pockmark.metrology.lining import lining
from pockmark.metrology.results import crater_of, hole_of
from pockmark.metrology.section import section_filling
from pockmark.metrology.surface import target_filling

UM = 1e-6
H = 2.0  # point spacing, um; a cell is 2 H
RADIUS, DEPTH = 80.0, 60.0
SUB = 4  # rings along each edge of a spacing: each has its share of the volume, as in stretched material


def carved(solid, *, depth=DEPTH, top=0.0, face="transmitting"):
    """Rings (position m, volume m^3) where solid(r, z) holds (um), of a wall that reaches up to `top`, and its setup."""
    step = H / SUB
    r, z = np.meshgrid(
        np.arange(step / 2, RADIUS, step), np.arange(-depth + step / 2, top, step), indexing="ij"
    )
    r, z = r[solid(r, z)], z[solid(r, z)]
    wall = Wall(
        (0,), (-RADIUS * UM, -RADIUS * UM, -depth * UM), (RADIUS * UM, RADIUS * UM, 0.0), H * UM, face
    )
    position = np.column_stack([r, 0 * r, z]) * UM
    setup = Setup(H * UM, names=("wall",), wall=wall, walls=((0,),), is_axisymmetric=True)
    return position, 2 * np.pi * r * step**2 * UM**3, setup


def surface_of(solid, level=0.5, **more):
    filling = section_filling(*carved(solid, **more))
    return None if filling is None else filling.surface(level)


@pytest.mark.parametrize("radius", [12.0, 17.3, 24.0])
def test_hemisphere(radius):
    surface = surface_of(lambda r, z: r**2 + z**2 > radius**2)
    crater = crater_of(surface)
    exact = 2 / 3 * np.pi * radius**3
    print(
        f"C_p {crater.depth / UM:.2f}, D_c {crater.diameter / UM:.2f}, volume {crater.volume / UM**3 / exact:.3f}"
    )
    assert crater.depth / UM == pytest.approx(radius, abs=0.5)
    assert crater.diameter / UM == pytest.approx(2 * radius, abs=1.0)
    assert crater.volume / UM**3 == pytest.approx(exact, rel=0.03)
    assert crater.bottom == crater.pithead.centre == (0.0, 0.0)
    assert crater.pithead.e2 == 0
    assert crater.rim is None
    assert [*of_crater(crater, surface, carved(lambda r, z: r > 0)[2])] == []


@pytest.mark.parametrize(("depth", "diameter"), [(8.0, 40.0), (20.0, 36.0)])
def test_paraboloid_with_a_rim(depth, diameter):
    """A rim of 5 um at 1.25 times the crater's radius."""
    crest = 0.625 * diameter
    inside = lambda r: -depth * (1 - r**2 * 4 / diameter**2)  # noqa: E731
    outside = lambda r: np.maximum(5 - ((r - crest) / 3) ** 2, 0)  # noqa: E731
    solid = lambda r, z: z < np.where(r < diameter / 2, inside(r), outside(r))  # noqa: E731
    crater = crater_of(surface_of(solid, top=5))
    assert crater.depth / UM == pytest.approx(depth, abs=0.5)
    assert crater.diameter / UM == pytest.approx(diameter, abs=1.0)
    assert crater.volume / UM**3 == pytest.approx(np.pi / 8 * depth * diameter**2, rel=0.03)
    assert crater.rim_height / UM == pytest.approx(5, abs=0.7)
    assert crater.rim_diameter / UM == pytest.approx(2 * crest, abs=H)


def test_it_is_what_the_measures_of_three_dimensions_say():
    """The same bowl, with a peak in its middle, as rings and as points of a quarter."""
    bowl = lambda r, z: (r**2 + 2 * z**2 > 20**2) | (z < -10 - 0.5 * (r - 6) + 0 * z) & (r < 6)  # noqa: E731
    one = crater_of(surface_of(bowl))
    step = H / 2
    axis = np.arange(step / 2, 60, step)
    x = np.stack(np.meshgrid(axis, axis, -axis[:40], indexing="ij"), axis=-1).reshape(-1, 3)
    x = x[bowl(np.hypot(x[:, 0], x[:, 1]), x[:, 2])]
    mirrors = (Mirror(0, 0.0, above=False), Mirror(1, 0.0, above=False))
    wall = Wall((0,), (0.0, 0.0, -40 * UM), (60 * UM, 60 * UM, 0.0), H * UM, "transmitting")
    filling = target_filling(x * UM, np.full(len(x), (step * UM) ** 3), Setup(H * UM, mirrors, wall=wall))
    other = crater_of(filling.surface())
    for name, limit in (("depth", 0.03), ("diameter", 0.03), ("volume", 0.03)):
        a, b = getattr(one, name), getattr(other, name)
        print(f"{name}: {a:.4g} of rings, {b:.4g} of points")
        assert a == pytest.approx(b, rel=limit)


def test_a_whole_surface_and_a_dent_are_no_crater():
    assert surface_of(lambda r, z: r > 0) is None
    assert crater_of(surface_of(lambda r, z: (r > 10) | (z < -0.4))) is None


def test_a_crater_as_wide_as_the_wall_has_a_depth_alone():
    crater = crater_of(surface_of(lambda r, z: z < -12))
    assert crater.depth / UM == pytest.approx(12, abs=0.5)
    assert crater.diameter is crater.volume is crater.rim is crater.pithead is None


@pytest.mark.parametrize("face", [None, "free", "transmitting"])
def test_a_hole_has_a_width_where_the_back_is_free(face):
    through = lambda r, z: r > 9 + 0.5 * np.abs(z + 6)  # noqa: E731
    surface = surface_of(through, depth=12, face=face)
    assert crater_of(surface) is None
    hole = hole_of(surface)
    setup = carved(through, depth=12, face=face)[2]
    (sentence,) = of_hole(hole, surface, setup)
    if face == "transmitting":
        assert hole is None
        assert "cannot be told" in sentence
        return
    assert (hole.count, hole.place[:2]) == (1, (0.0, 0.0))
    assert (hole.width / UM, hole.diameter / UM) == pytest.approx((18, 18), abs=H / 2)
    assert hole.place[2] / UM == pytest.approx(-6, abs=H)


def test_a_plug_that_hangs_on_nothing_leaves_the_whole_hole():
    """What does not hang together with the wall is gone, here as in three dimensions."""
    hole = hole_of(surface_of(lambda r, z: (r > 20) | ((r < 12) & (z < -2) & (z > -8)), depth=12, face=None))
    assert hole.count == 1
    assert hole.width / UM == pytest.approx(40, abs=H)


def test_ejecta_are_rings_of_the_whole_circle():
    position, volume, setup = carved(lambda r, z: (z < 0) | ((r > 4) & (r < 8) & (z > 20)), top=24)
    up = position[:, 2] > 0
    velocity = np.where(up[:, None], [300.0, 0, 400.0], [0.0, 0, 5.0])
    snapshot = {"position": position, "velocity": velocity, "volume": volume, "mass": 2770 * volume}
    snapshot["body"] = np.zeros(len(volume), int)
    found = find_ejecta(snapshot, setup)
    mass = snapshot["mass"][up].sum()
    assert mass == pytest.approx(2770 * np.pi * (64 - 16) * 4 * UM**3)
    assert found.mass == pytest.approx(mass)
    assert found.momentum == pytest.approx(
        [0, 0, 400 * mass]
    )  # what moves outwards is balanced around the axis
    assert found.kinetic == pytest.approx(mass * 500**2 / 2)


def test_the_lining_is_what_lies_in_the_crater():
    position, volume, setup = carved(lambda r, z: r**2 + z**2 > 20**2)
    crater = crater_of(section_filling(position, volume, setup).surface())
    step = H / SUB
    r, z = np.meshgrid(np.arange(step / 2, 12, step), np.arange(-19.75, -17, step), indexing="ij")
    film = np.column_stack([r.ravel(), 0 * r.ravel(), z.ravel()]) * UM
    each = 2 * np.pi * r.ravel() * step**2 * UM**3
    snapshot = {"position": film, "volume": each, "mass": 2770 * each, "body": np.ones(len(each), int)}
    setup = Setup(H * UM, names=("wall", "ball"), projectiles=(1,), wall=setup.wall, is_axisymmetric=True)
    mass, thickness = lining(snapshot, crater, setup)
    assert mass == pytest.approx(2770 * each.sum())
    assert thickness / UM == pytest.approx(3, rel=0.05)
