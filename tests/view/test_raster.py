"""What a picture's pixels are: a known field to what a cell resolves, without checkerboard, gaps or blanks."""

from dataclasses import replace

import numpy as np
import pytest
from planes import CELL, PROJECTILE, SETUP, TARGET, UM, H, block, fields, rings
from scipy import ndimage

from pockmark.view.quantities import PRESSURE
from pockmark.view.raster import Cut, Raster

MPA = 1e6
SLAB = block((-40, 0, -40), (40, 12, 0))


def raster_of(snapshot, setup=SETUP):
    cut = Cut.of(snapshot, setup, [PRESSURE])
    return Raster.of(cut, cut.limits)


def inside(raster, away):
    """The pixels of the slab that are some um away from its edges."""
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    return (np.abs(x) < 40 - away) & (z < -away) & (z > away - 40), x, z


@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.25])
def test_a_linear_field_is_drawn_as_it_is(jitter):
    """To a fraction of what it changes by over a cell; at the edges to half a cell."""
    snapshot = fields(SLAB, TARGET, jitter=jitter)
    x, _, z = snapshot["position"].T / UM
    snapshot["pressure"] = (3.0 * x - 2.0 * z) * MPA
    raster = raster_of(snapshot)
    drawn = raster.field(raster.cut.values["pressure"])
    for away, allowed in ((CELL, 0.02 + 0.4 * jitter), (0.0, 0.5)):
        where, px, pz = inside(raster, away)
        error = np.abs(drawn - (3.0 * px - 2.0 * pz))[where].max() / (np.hypot(3, 2) * CELL)
        print(f"jitter {jitter}: {error:.3f} of the change over a cell, {away} um from the edges")
        assert error < allowed


def test_what_alternates_between_neighbours_is_not_drawn():
    """A checkerboard of the points of a cell, of +-100 MPa, is less than 1 MPa in the picture: no grid sees it."""
    snapshot = fields(SLAB, TARGET)
    place = np.round((snapshot["position"] / UM - H / 2) / H).astype(int)
    snapshot["pressure"] = 100 * MPA * (1 - 2.0 * (place.sum(axis=1) % 2))
    raster = raster_of(snapshot)
    where, _, _ = inside(raster, CELL)
    assert np.abs(raster.field(raster.cut.values["pressure"])[where]).max() < 1


def test_noise_of_points_makes_no_confetti():
    """Between neighbouring pixels a noisy field changes by no more than a tent lets it: values over a cell's width."""
    snapshot = fields(SLAB, TARGET, jitter=0.2)
    snapshot["pressure"] = np.random.default_rng(3).uniform(-100, 100, len(SLAB)) * MPA
    raster = raster_of(snapshot)
    drawn = raster.field(raster.cut.values["pressure"])
    where, _, _ = inside(raster, CELL)
    step = np.abs(np.diff(drawn, axis=0))[where[1:]].max()
    print(f"largest step between pixels {step:.2f} MPa, of 200; a pixel is {raster.pixel / CELL:.3f} cells")
    assert step < 200 * 2 * raster.pixel / CELL
    assert drawn[where].std() < 0.6 * snapshot["pressure"].std() / MPA


@pytest.mark.parametrize("jitter", [0.0, 0.25])
@pytest.mark.parametrize("stretch", [(1, 1, 1), (1.3, 1, 0.8), (1.5, 1, 1)])
def test_no_pixel_within_material_is_blank(jitter, stretch):
    """Nor where points have parted by less than a cell, as in a wall that was stretched without growing."""
    snapshot = fields(SLAB, TARGET, jitter=jitter)
    snapshot["position"] = snapshot["position"] * stretch
    raster = raster_of(snapshot)
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    within = (np.abs(x) < 40 * stretch[0] - H) & (z < -H) & (z > H - 40 * stretch[2])
    drawn = raster.field(raster.cut.values["pressure"])
    blank = int(np.ma.getmaskarray(drawn)[within].sum())
    print(f"{blank} of {within.sum()} pixels are blank")
    assert blank == 0
    assert np.isfinite(drawn.compressed()).all()


def test_a_void_wider_than_a_cell_is_shown():
    middle = np.hypot(SLAB[:, 0], SLAB[:, 2] + 20)
    raster = raster_of(fields(SLAB[middle > 6], TARGET, jitter=0.1))
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    assert not raster.material[np.hypot(x, z + 20) < 4].any()
    assert raster.material[(np.hypot(x, z + 20) > 8) & (z < -2) & (z > -38) & (np.abs(x) < 38)].all()


def test_the_edge_of_the_material_is_where_it_is():
    raster = raster_of(fields(SLAB, TARGET))
    i = int(np.argmin(np.abs(raster.x)))
    solid = raster.z[raster.material[i]]
    assert solid.max() == pytest.approx(0, abs=raster.pixel)
    assert solid.min() == pytest.approx(-40, abs=raster.pixel)


def test_the_projectile_is_where_its_points_are():
    ball = block((-10, 0, 0), (10, 10, 20), 1.0)
    ball = ball[np.linalg.norm(ball - (0, 0, 10), axis=1) < 10]
    n, m = len(SLAB), len(ball)
    raster = raster_of(
        fields(
            np.concatenate([SLAB, ball]), np.repeat([TARGET, PROJECTILE], [n, m]), np.repeat([H, 1.0], [n, m])
        )
    )
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    mine = raster.projectile > 0.5
    assert mine[np.hypot(x, z - 10) < 8].all()
    assert not mine[
        (z < -1) | ((np.hypot(x, z - 10) > 11) & (z > 4))
    ].any()  # the gap below is narrower than a cell
    assert ndimage.label(mine)[1] == 1


def test_a_value_lies_between_those_of_the_points():
    snapshot = fields(SLAB, TARGET, jitter=0.3)
    snapshot["pressure"] = np.random.default_rng(5).choice([-7.0, 11.0], len(SLAB)) * MPA
    raster = raster_of(snapshot)
    drawn = raster.field(raster.cut.values["pressure"]).compressed()
    assert drawn.min() >= -7 - 1e-9
    assert drawn.max() <= 11 + 1e-9


def test_the_mean_is_by_mass():
    snapshot = fields(SLAB, TARGET)
    right = np.round(snapshot["position"][:, 0] / UM / H - 0.5).astype(int) % 2 == 1
    snapshot["mass"] = np.where(right, 3.0, 1.0) * snapshot["mass"]
    snapshot["pressure"] = np.where(right, 8.0, 0.0) * MPA
    raster = raster_of(snapshot)
    where, _, _ = inside(raster, CELL)
    assert raster.field(raster.cut.values["pressure"])[where].mean() == pytest.approx(6.0, rel=0.01)


def test_rings_are_drawn_on_both_sides_of_the_axis_as_wide_as_their_section():
    raster = raster_of(rings(), replace(SETUP, mirrors=(), is_axisymmetric=True))
    assert raster.cut.width == pytest.approx(H)
    assert sorted(set(np.round(raster.cut.x))) == [*range(-29, 30, 2)]
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    drawn = raster.field(raster.cut.values["pressure"])
    within = (z < -H) & (z > H - 30) & (np.abs(x) < 28)
    assert not np.ma.getmaskarray(drawn)[within].any()
    far = within & (np.abs(x) > CELL) & (np.abs(x) < 26)
    assert np.allclose(drawn[far], np.abs(x)[far], atol=0.1)
    assert np.allclose(drawn.filled(-1), drawn.filled(-1)[::-1], atol=0.3)  # as pixels lie


def test_what_lies_behind_a_plane_of_symmetry_is_drawn():
    from pockmark.base.geometry import Mirror

    quarter = SLAB[SLAB[:, 0] > 0]
    mirrors = (*SETUP.mirrors, Mirror(0, 0.0, False))
    raster = raster_of(fields(quarter, TARGET), replace(SETUP, mirrors=mirrors))
    x, z = np.meshgrid(raster.x, raster.z, indexing="ij")
    assert raster.material[(np.abs(x) < 38) & (z < -2) & (z > -38)].all()
