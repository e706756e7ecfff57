"""Crater metrology on synthetic craters: what is measured must be what was carved."""

from itertools import product

import numpy as np
import pytest

from pockmark.crater import measure_crater, target_surface
from pockmark.scene import Mirror

UM = 1e-6
H = 2.0 * UM  # point spacing; a cell is 2 H


def block(keep):
    """Half block 160 x 80 x 60 um of points where keep(x, y, z) holds (um): positions, and the volume that is in it."""
    axes = [np.arange(-79, 80, 2.0), np.arange(1, 80, 2.0), np.arange(-59, 0, 2.0)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = np.arange(-0.75, 1.0, 0.5)
    share = np.mean([keep(*(x + np.array(d)).T) for d in product(inside, inside, inside)], axis=0)
    return x[share > 0] * UM, share[share > 0] * H**3


HALF = (Mirror(1, 0.0, above=False),)


def measured(points, mirrors=HALF):
    return measure_crater(target_surface(*points, H, mirrors=mirrors), spacing=H)


@pytest.mark.parametrize("radius", [12.0, 17.3, 24.0])
def test_hemisphere(radius):
    crater = measured(block(lambda x, y, z: x**2 + y**2 + z**2 > radius**2))
    exact = 2 / 3 * np.pi * radius**3
    print(
        f"R {radius}: depth {crater.depth / UM:.2f}, D {crater.diameter / UM:.2f}, volume {crater.volume / UM**3 / exact:.3f}"
    )
    assert crater.depth / UM == pytest.approx(radius, abs=1.0)  # a quarter of a 4 um cell
    assert crater.diameter / UM == pytest.approx(2 * radius, abs=1.0)
    assert crater.volume / UM**3 == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize(("depth", "diameter"), [(8.0, 40.0), (20.0, 36.0)])
def test_paraboloid(depth, diameter):
    crater = measured(block(lambda x, y, z: z < -depth * (1 - (x**2 + y**2) * 4 / diameter**2)))
    print(f"paraboloid {depth} x {diameter}: {crater.depth / UM:.2f} x {crater.diameter / UM:.2f}")
    assert crater.depth / UM == pytest.approx(depth, abs=1.0)
    assert crater.diameter / UM == pytest.approx(diameter, abs=1.0)
    assert crater.volume / UM**3 == pytest.approx(np.pi / 8 * depth * diameter**2, rel=0.05)


def test_ejecta_and_inner_voids_do_not_count():
    """A detached fragment above the crater and a spall void below it leave the measures as they are."""

    def carved(x, y, z):
        return x**2 + y**2 + z**2 > 15**2

    plain = measured(block(carved))
    fragment = np.array([[0.0, y, z] for y in (1, 3, 5) for z in (14, 16, 18)]) * UM
    position, volume = block(lambda *x: carved(*x) & (x[0] ** 2 + x[1] ** 2 + (x[2] + 30) ** 2 > 6**2))
    volume = np.append(volume, np.full(len(fragment), H**3))
    disturbed = measured((np.concatenate([position, fragment]), volume))
    assert disturbed.depth == pytest.approx(plain.depth, abs=0.1 * UM)
    assert disturbed.diameter == pytest.approx(plain.diameter, abs=0.1 * UM)


def test_an_off_axis_crater_is_found():
    crater = measured(block(lambda x, y, z: (x - 21) ** 2 + y**2 + z**2 > 14**2))
    assert crater.bottom[0] / UM == pytest.approx(21, abs=2)
    assert crater.depth / UM == pytest.approx(14, abs=1.0)


def test_a_flat_target_has_no_crater():
    assert measured(block(lambda x, y, z: z < 0)) is None


@pytest.mark.parametrize(
    "faces", ["y_lower", "y_upper", "x_lower", "x_upper", "x_lower y_upper", "x_lower x_upper"]
)
@pytest.mark.parametrize("shift", [0.0, 6.0])
def test_every_symmetry_plane_is_mirrored(faces, shift):
    """What is left of a block by its symmetry planes, wherever they are, gives the whole block's crater."""
    position, volume = block(lambda x, y, z: x**2 + y**2 + z**2 > 17.3**2)
    whole = measured((position, volume))
    position = np.concatenate([position, position * (1, -1, 1)])
    volume = np.tile(volume, 2)
    mirrors = []
    for face in faces.split():
        axis, above = "xy".index(face[0]), face.endswith("upper")
        at = 80 * UM if faces == "x_lower x_upper" and above else 0.0
        kept = (position[:, axis] < at) == above
        position, volume = position[kept], volume[kept]
        mirrors.append(Mirror(axis, at + shift * UM, above))
    crater = measured((position + np.array([shift, shift, 0]) * UM, volume), mirrors)
    # Four columns are deepest alike; which is taken moves the fitted bottom by a thousandth.
    assert crater.depth == pytest.approx(whole.depth, rel=5e-3)
    assert crater.diameter == pytest.approx(whole.diameter, rel=1e-6)
    assert crater.volume == pytest.approx(whole.volume, rel=1e-6)
    for mirror in mirrors:  # the bottom is named where points are
        assert (crater.bottom[mirror.axis] < mirror.at) == mirror.above
