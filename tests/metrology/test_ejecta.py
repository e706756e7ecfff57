"""Ejecta and lining of synthetic snapshots: what was thrown is what is found."""

import numpy as np
import pytest

from pockmark.base.geometry import Mirror, Setup
from pockmark.metrology.crater import measure_target
from pockmark.metrology.ejecta import enhancement, find_ejecta
from pockmark.metrology.lining import lining

H = 2e-6
HALF = (Mirror(1, 0.0, above=False),)


def lattice(x, y, z, keep=lambda p: p[:, 0] < np.inf):
    axes = [np.arange(a + 1, b, 2.0) * 1e-6 for a, b in (x, y, z)]
    position = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return position[keep(position)]


def snapshot(*parts):
    """Of parts (position, velocity, body); a point weighs a nanogram."""
    n = [len(p) for p, _, _ in parts]
    return {
        "position": np.concatenate([p for p, _, _ in parts]),
        "velocity": np.repeat([v for _, v, _ in parts], n, axis=0).astype(float),
        "body": np.repeat([b for _, _, b in parts], n),
        "volume": np.full(sum(n), H**3),
        "mass": np.full(sum(n), 1e-12),
    }


def test_only_what_is_detached_and_moves_away_is_ejecta():
    target = lattice((-40, 40), (0, 40), (-40, 0))
    rim = lattice((-8, 8), (0, 8), (0, 6))
    thrown = lattice((-4, 4), (0, 4), (20, 24))
    falling = lattice((20, 24), (0, 4), (20, 24))
    parts = (
        (target, (0, 0, 5), 0),
        (rim, (0, 0, 50), 0),
        (thrown, (300, 70, 400), 1),
        (falling, (0, 0, -90), 0),
    )
    found = find_ejecta(snapshot(*parts), Setup(H, HALF))
    mass = 2 * len(thrown) * 1e-12
    print(found.mass / mass, found.momentum / mass, found.kinetic / mass)
    assert found.mass == pytest.approx(mass)
    assert found.momentum == pytest.approx(mass * np.array([300, 0, 400]))  # the mirror image takes y back
    assert found.kinetic == pytest.approx(mass * (300**2 + 70**2 + 400**2) / 2)
    assert found.mass_by_speed.sum() == found.mass_by_angle.sum() == pytest.approx(mass)
    angle = np.degrees(np.arctan2(np.hypot(300, 70), 400))
    assert np.argmax(found.mass_by_angle) == int(angle // 10)


def test_beta():
    assert enhancement(0.0, 2.0) == 1.0
    assert enhancement(1.0, 2.0) == 1.5
    assert enhancement(1.0, 0.0) is None


@pytest.mark.parametrize(("y", "images"), [((0, 16), 2), ((24, 56), 1)])
def test_the_lining_is_what_lies_in_the_bowl(y, images):
    """A layer 4 um thick on the flat bottom of a box-shaped pit on the symmetry plane, or of one with a mirror image; a
    layer of it outside does not count."""

    def solid(p):
        across = (p[:, 1] > y[0] * 1e-6) & (p[:, 1] < y[1] * 1e-6)
        return ~((np.abs(p[:, 0]) < 16e-6) & across & (p[:, 2] > -12e-6))

    target = lattice((-60, 60), (0, 80), (-40, 0), solid)
    layer, outside = lattice((-16, 16), y, (-12, -8)), lattice((-30, -20), (0, 10), (0, 2))
    fields = snapshot((target, (0, 0, 0), 0), (layer, (0, 0, 0), 1), (outside, (0, 0, 0), 1))
    is_target = fields["body"] == 0
    crater = measure_target(fields["position"][is_target], fields["volume"][is_target], Setup(H, HALF))
    mass, thickness = lining(fields, crater, Setup(H, HALF, projectiles=(1,)))
    print(
        f"C_p {crater.depth * 1e6:.2f} of 12 um, lining {thickness * 1e6:.2f} of 4 um, mass {mass / len(layer) / 1e-12:.3f}"
    )
    assert crater.depth == pytest.approx(12e-6, abs=H / 2)
    assert mass == pytest.approx(images * len(layer) * 1e-12, rel=0.01)
    assert thickness == pytest.approx(4e-6, rel=0.15)
