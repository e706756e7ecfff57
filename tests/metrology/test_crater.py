"""Crater metrology on synthetic craters: what is measured must be what was carved."""

from itertools import product

import numpy as np
import pytest

from pockmark.base.geometry import Mirror, Setup
from pockmark.metrology.crater import measure_target
from pockmark.metrology.surface import SIGMA
from pockmark.metrology.uncertainty import LEVELS, uncertainties

UM = 1e-6
H = 2.0  # point spacing, um; a cell is 2 H
QUARTER = 1.0  # of a cell, um
HALF = (Mirror(1, 0.0, above=False),)


def block(solid, lower=(-80, 0, -60), top=0):
    """Lattice of points (m) with the share of their volume (m^3) where solid(x, y, z) holds (um); half model."""
    axes = [np.arange(a + 1, b, H) for a, b in zip(lower, (80, 80, top), strict=True)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = np.arange(-0.75, 1.0, 0.5)
    share = np.mean([solid(*(x + np.array(d)).T) for d in product(inside, inside, inside)], axis=0)
    return x[share > 0] * UM, share[share > 0] * (H * UM) ** 3


def measured(points, mirrors=HALF, level=0.5):
    return measure_target(*points, Setup(H * UM, mirrors), level=level)


def hemisphere(radius, at=0.0):
    return lambda x, y, z: (x - at) ** 2 + y**2 + z**2 > radius**2


def close(crater, depth, major, minor, e1, e2):
    e = crater.pithead
    found = (crater.depth / UM, e.major / UM, e.minor / UM, e.e1(crater.bottom, (1.0, 0.0)), e.e2)
    errors = np.array(found) - (depth, major, minor, e1, e2)
    print("C_p, D_max, D_min off by {:+.2f} {:+.2f} {:+.2f} um; e1, e2 by {:+.4f} {:+.4f}".format(*errors))
    assert np.all(np.abs(errors[:3]) < QUARTER)
    assert abs(errors[3]) < 0.02
    # On a circle e2 is the root of twice the axes' relative difference: .02 would ask for a thousandth of a cell.
    assert abs(errors[4]) < 0.02 if e2 else (e.major - e.minor) / UM < QUARTER / 4


@pytest.mark.parametrize("radius", [12.0, 17.3, 24.0])
def test_hemisphere(radius):
    crater = measured(block(hemisphere(radius)))
    close(crater, radius, 2 * radius, 2 * radius, 0, 0)
    exact = 2 / 3 * np.pi * radius**3
    print(f"D_c {crater.diameter / UM:.2f}, volume {crater.volume / UM**3 / exact:.3f} of the exact one")
    assert crater.diameter / UM == pytest.approx(2 * radius, abs=QUARTER)
    assert crater.volume / UM**3 == pytest.approx(exact, rel=0.05)
    assert crater.rim_height < 0.1 * UM


@pytest.mark.parametrize(("depth", "diameter"), [(8.0, 40.0), (20.0, 36.0)])
def test_paraboloid(depth, diameter):
    crater = measured(block(lambda x, y, z: z < -depth * (1 - (x**2 + y**2) * 4 / diameter**2)))
    close(crater, depth, diameter, diameter, 0, 0)
    assert crater.volume / UM**3 == pytest.approx(np.pi / 8 * depth * diameter**2, rel=0.05)


@pytest.mark.parametrize("tilt", [0.0, 15.0, 30.0])
def test_tilted_ellipsoid(tilt):
    """Semi-axes 26, 18, 16 um, turned about y, centre at x = 3 um in the plane."""
    a, b, c, t = 26.0, 18.0, 16.0, np.radians(tilt)
    pxx = np.cos(t) ** 2 / a**2 + np.sin(t) ** 2 / c**2
    pzz = np.sin(t) ** 2 / a**2 + np.cos(t) ** 2 / c**2
    pxz = np.sin(t) * np.cos(t) * (1 / a**2 - 1 / c**2)
    solid = block(lambda x, y, z: pxx * (x - 3) ** 2 + 2 * pxz * (x - 3) * z + pzz * z**2 + (y / b) ** 2 > 1)
    depth = 1 / np.sqrt(pzz - pxz**2 / pxx)
    bottom, major, minor = 3 + pxz / pxx * depth, 2 / np.sqrt(pxx), 2 * b
    crater = measured(solid)
    close(crater, depth, major, minor, 2 * (3 - bottom) / major, np.sqrt(1 - (minor / major) ** 2))
    assert abs(crater.pithead.orientation) < 0.01


def test_two_overlapping_bowls_are_one_crater():
    radius, at = 14.0, 8.0
    crater = measured(
        block(lambda x, y, z: hemisphere(radius, at)(x, y, z) & hemisphere(radius, -at)(x, y, z))
    )
    area = 2 * (radius**2 * (np.pi - np.arccos(at / radius)) + at * np.sqrt(radius**2 - at**2))
    exact = 2 * np.sqrt(area / np.pi)
    print(f"C_p {crater.depth / UM:.2f} of {radius}, D_c {crater.diameter / UM:.2f} of {exact:.2f}")
    assert crater.depth / UM == pytest.approx(radius, abs=QUARTER)
    assert crater.diameter / UM == pytest.approx(exact, abs=QUARTER)
    assert abs(abs(crater.bottom[0]) / UM - at) < QUARTER


def test_a_rim_is_measured_and_moves_nothing_else():
    radius, crest, height = 16.0, 20.0, 5.0

    def solid(x, y, z):
        rim = height * (1 - ((np.hypot(x, y) - crest) / (crest - radius)) ** 2)
        return hemisphere(radius)(x, y, z) & (z < np.maximum(rim, 0))

    crater = measured(block(solid, top=10))
    close(crater, radius, 2 * radius, 2 * radius, 0, 0)
    print(f"rim {crater.rim_height / UM:.2f} of {height} um")
    assert crater.rim_height / UM == pytest.approx(height, abs=QUARTER)
    assert crater.rim_diameter / UM == pytest.approx(2 * crest, abs=H / 2)


def torus(x, y, crest, height, width):
    """Height of a rim whose section is a parabola."""
    return np.maximum(height * (1 - ((np.hypot(x, y) - crest) / width) ** 2), 0)


@pytest.mark.parametrize(
    ("radius", "crest", "height", "width"), [(12, 15.3, 3, 3.3), (17.3, 22, 5, 4.7), (17.3, 24.6, 2.5, 7.3)]
)
def test_the_rim_diameter_is_that_of_the_crest(radius, crest, height, width):
    """Debris that hangs over the rim, a point spacing wide, and a chip in the air move nothing."""

    def solid(x, y, z):
        return hemisphere(radius)(x, y, z) & (z < torus(x, y, crest, height, width))

    position, volume = block(solid, top=10)
    debris = np.array([[21, 1, 7], [23, 3, 9], [-30, 9, 7]]) * UM
    crater = measured((np.concatenate([position, debris]), np.append(volume, np.full(3, (H * UM) ** 3))))
    error, u = crater.rim_diameter / UM - 2 * crest, crater.rim.uncertainty / UM
    print(f"rim diameter off by {error:+.2f} +- {u:.2f} um")
    assert abs(error) < H / 2
    assert 0.1 < u < H
    assert abs(error) < 3 * u


def test_the_rim_of_an_oblique_crater_is_the_mean_over_directions():
    a, b, crest = 24.0, 16.0, 1.3  # semi-axes of the pithead; the crest is an ellipse as much larger

    def solid(x, y, z):
        r = np.hypot(x / a, y / b)
        rim = np.maximum(4 * (1 - ((r - crest) / (crest - 1)) ** 2), 0)
        return (r**2 + (z / 15) ** 2 > 1) & (z < rim)

    crater = measured(block(solid, top=10))
    angle = np.linspace(0, np.pi / 2, 1000)
    exact = 2 * crest * np.mean(1 / np.hypot(np.cos(angle) / a, np.sin(angle) / b))
    print(f"rim diameter {crater.rim_diameter / UM:.2f} of {exact:.2f} um")
    assert crater.rim_diameter / UM == pytest.approx(exact, abs=H / 2)


@pytest.mark.parametrize("faces", ["x_lower", "y_upper", "x_lower y_upper"])
def test_the_rim_is_mirrored(faces):
    def solid(x, y, z):
        return hemisphere(17.3)(x, y, z) & (z < torus(x, y, 22, 5, 4.7))

    position, volume = block(solid, lower=(-80, -80, -60), top=10)
    whole, mirrors = measured((position, volume), ()), []
    for face in faces.split():
        axis, above = "xy".index(face[0]), face.endswith("upper")
        kept = (position[:, axis] < 0) == above
        position, volume = position[kept], volume[kept]
        mirrors.append(Mirror(axis, 0.0, above))
    part = measured((position, volume), mirrors)
    assert part.rim_diameter == pytest.approx(whole.rim_diameter, rel=1e-6)
    assert part.rim.uncertainty == pytest.approx(whole.rim.uncertainty, rel=1e-6)


def test_a_crater_without_a_raised_edge_has_no_rim():
    assert measured(block(hemisphere(17.3))).rim is None


def test_an_opening_at_the_edge_has_a_depth_and_nothing_that_is_cut_off():
    crater = measured(block(lambda x, y, z: (abs(x) > 12) | (z < -12)))  # a trench along y
    assert crater.depth / UM == pytest.approx(12, abs=QUARTER)
    assert crater.diameter is crater.volume is crater.rim_height is crater.rim_diameter is None


def test_debris_in_the_bowl_and_voids_under_it_change_nothing():
    plain = measured(block(hemisphere(15)))
    position, volume = block(
        lambda *x: hemisphere(15)(*x) & (x[0] ** 2 + x[1] ** 2 + (x[2] + 30) ** 2 > 6**2)
    )
    debris = np.array([[x, y, z] for x in (-1, 1) for y in (1, 3) for z in (-7, -5, 14, 16)]) * UM
    volume = np.append(volume, np.full(len(debris), (H * UM) ** 3))
    disturbed = measured((np.concatenate([position, debris]), volume))
    print(
        f"C_p moves by {(disturbed.depth - plain.depth) / UM:.1e}, D_c by {(disturbed.diameter - plain.diameter) / UM:.1e} um"
    )
    for key in ("depth", "diameter", "volume"):
        assert getattr(disturbed, key) == pytest.approx(getattr(plain, key), rel=1e-9)


def test_an_off_axis_crater_is_found():
    crater = measured(block(hemisphere(14, at=21)))
    assert crater.bottom[0] / UM == pytest.approx(21, abs=QUARTER)
    close(crater, 14, 28, 28, 0, 0)


def test_a_flat_target_has_no_crater():
    assert measured(block(lambda x, y, z: z < 0)) is None
    assert measured(block(lambda x, y, z: z < -0.8)) is None  # sunk by less than half a spacing


@pytest.mark.parametrize(
    "faces", ["y_lower", "y_upper", "x_lower", "x_upper", "x_lower y_upper", "x_lower x_upper"]
)
@pytest.mark.parametrize("shift", [0.0, 6.0])
def test_every_symmetry_plane_is_mirrored(faces, shift):
    """What is left of a block by its symmetry planes, wherever they are, gives the whole block's crater."""
    position, volume = block(hemisphere(17.3), lower=(-80, -80, -60))
    whole = measured((position, volume), ())
    mirrors = []
    for face in faces.split():
        axis, above = "xy".index(face[0]), face.endswith("upper")
        at = 80 * UM if faces == "x_lower x_upper" and above else 0.0
        kept = (position[:, axis] < at) == above
        position, volume = position[kept], volume[kept]
        mirrors.append(Mirror(axis, at + shift * UM, above))
    crater = measured((position + np.array([shift, shift, 0]) * UM, volume), mirrors)
    for key in ("depth", "diameter", "volume"):
        print(key, getattr(crater, key) / getattr(whole, key) - 1)
        assert getattr(crater, key) == pytest.approx(getattr(whole, key), rel=1e-6)


def test_the_levels_of_the_uncertainty_move_the_surface_by_its_standard_deviation():
    points, radius = block(hemisphere(20)), 20.0
    crater, low, high = (measured(points, level=level) for level in (0.5, *LEVELS))
    u = uncertainties(crater, (low, high), H * UM)
    print({key: f"{value:.3g}" for key, value in u.items()})
    assert u["depth"] / UM == pytest.approx(SIGMA * H, rel=0.15)
    # Two walls, and the pithead is extrapolated: 3/2 of one slice less 1/2 of the other.
    assert 2 * SIGMA * H < u["diameter"] / UM < 1.5 * 2 * SIGMA * H
    assert abs(crater.depth / UM - radius) < 2 * u["depth"] / UM
    assert all(value is not None and value >= 0 for value in u.values())
