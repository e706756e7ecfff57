"""What a view in three dimensions is made of: a known field to what a cell resolves, on one side of the plane."""

from dataclasses import replace

import numpy as np
import pytest
from planes import CELL, PROJECTILE, SETUP, TARGET, UM, block, fields, only, rings

from pockmark import PockmarkError
from pockmark.view.quantities import DAMAGE, PRESSURE, quantity_of
from pockmark.view.space import MOST_NODES, Solid

MPA = 1e6
SLAB = block((-20, 0, -20), (20, 20, 0))


@pytest.mark.parametrize("jitter", [0.0, 0.25])
def test_a_linear_field_is_as_it_is_and_no_node_within_material_is_blank(jitter):
    snapshot = fields(SLAB, TARGET, jitter=jitter)
    position = snapshot["position"] / UM
    snapshot["pressure"] = position @ (3.0, 0.0, -2.0) * MPA  # even across the plane of symmetry
    solid = Solid.of(snapshot, SETUP, PRESSURE)
    x, y, z = np.meshgrid(*solid.nodes, indexing="ij")
    assert y.min() == 0
    within = (np.abs(x) < 20 - CELL) & (y < 20 - CELL) & (z < -CELL) & (z > CELL - 20)
    assert (solid.filling[within] > 0.5).all()
    error = np.abs(solid.values - (3 * x - 2 * z))[within].max() / (np.hypot(3, 2) * CELL)
    print(f"jitter {jitter}: {error:.3f} of the change over a cell")
    assert error < 0.02 + 0.4 * jitter
    assert (solid.filling[z > CELL] < 0.5).all()


def test_rings_become_a_half_of_what_they_are():
    solid = Solid.of(rings(), replace(SETUP, mirrors=(), is_axisymmetric=True), PRESSURE)
    x, y, z = np.meshgrid(*solid.nodes, indexing="ij")
    radius = np.hypot(x, y)
    within = (radius < 26) & (z < -CELL) & (z > CELL - 30)
    assert y.min() == 0
    assert (solid.filling[within] > 0.5).all()
    assert np.allclose(solid.values[within & (radius > CELL)], radius[within & (radius > CELL)], atol=0.1)
    assert (solid.filling[radius > 32] < 0.5).all()


def test_the_projectile_is_told_from_the_target():
    body = np.where(SLAB[:, 2] > -8, PROJECTILE, TARGET)
    solid = Solid.of(fields(SLAB, body), SETUP, DAMAGE)
    z = solid.nodes[2]
    inside = solid.projectile[np.abs(solid.nodes[0]) < 15][:, solid.nodes[1] < 15]
    assert (inside[:, :, (z > -4) & (z < -1)] > 0.9).all()
    assert (inside[:, :, (z > -18) & (z < -12)] < 0.1).all()


def test_many_cells_are_taken_together():
    solid = Solid.of(
        fields(block((-60, 0, -60), (60, 60, 0), 6.0), TARGET, 6.0),
        replace(SETUP, spacing=1e-7, cell=2e-7),
        DAMAGE,
    )
    assert solid.filling.size <= MOST_NODES


@pytest.mark.parametrize("kept", [0, 1])
def test_few_points_are_a_solid(kept):
    snapshot = only(fields(SLAB, TARGET), np.arange(len(SLAB)) < kept)
    solid = Solid.of(snapshot, SETUP, PRESSURE)
    assert np.isfinite(solid.values).all()
    assert np.isfinite(solid.filling).all()


def test_what_cannot_be_shown_is_a_sentence():
    snapshot = fields(SLAB, TARGET)
    del snapshot["damage"]
    with pytest.raises(PockmarkError, match=r"the snapshot lacks the field damage$"):
        Solid.of(snapshot, SETUP, DAMAGE)
    with pytest.raises(PockmarkError, match=r"found tempurature, expected one of .*did you mean temperature"):
        quantity_of("tempurature")
