"""The mesh of a crater: closed, with the volume of what it bounds, few triangles, and the fields of the points."""

import numpy as np
import pytest

from pockmark.base.geometry import Mirror, Setup, Wall
from pockmark.metrology.mesh import MOST_NODES, meshes
from pockmark.metrology.section import section_filling
from pockmark.metrology.surface import target_filling
from pockmark.view.quantities import present

UM, H, RADIUS, HALF = 1e-6, 2e-6, 12e-6, 40e-6


def wall(*mirrors, lower=(-HALF, -HALF, -HALF), axisymmetric=False):
    """Return a setup of a wall of points H apart."""
    return Setup(
        H,
        mirrors,
        ("target",),
        wall=Wall((0,), lower, (HALF, HALF, 0.0), H, "transmitting"),
        walls=((0,),),
        tops=(0.0,),
        is_axisymmetric=axisymmetric,
    )


def snapshot(position, volume):
    """Return points with a pressure that is a linear function of their place."""
    n = len(position)
    return {
        "position": position,
        "volume": volume,
        "body": np.zeros(n, dtype=np.uint8),
        "velocity": np.zeros((n, 3)),
        "deviator": np.zeros((n, 6)),
        "damage": np.full(n, 2.0),
        "pressure": pressure(position),
    }


def pressure(place):
    return 1e6 * (3 * place[:, 2] + 2 * np.hypot(place[:, 0], place[:, 1])) / UM


def block(x, y, z):
    axes = [np.arange(low + H / 2, high, H) for low, high in (x, y, z)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return places[(places**2).sum(axis=1) > RADIUS**2]


def whole():
    places = block((-HALF, HALF), (-HALF, HALF), (-HALF, 0))
    setup = wall()
    return snapshot(places, np.full(len(places), H**3)), setup, target_filling


def half():
    places = block((-HALF, HALF), (0, HALF), (-HALF, 0))
    setup = wall(Mirror(1, 0.0, above=False), lower=(-HALF, 0.0, -HALF))
    return snapshot(places, np.full(len(places), H**3)), setup, target_filling


def rings():
    places = block((0, HALF), (-H / 2, H / 2), (-HALF, 0))
    setup = wall(lower=(0.0, 0.0, -HALF), axisymmetric=True)
    return snapshot(places, 2 * np.pi * places[:, 0] * H**2), setup, section_filling


def volume_of(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, n]] for n in range(3))
    return abs(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


def made(case):
    fields, setup, fill = case()
    surface = fill(fields["position"], fields["volume"], setup).surface()
    return surface, meshes(surface, fields, setup, present(fields))


@pytest.mark.parametrize("case", [whole, half, rings])
def test_a_mesh_is_closed_and_has_the_volume_of_the_block_without_the_pit(case):
    _, found = made(case)
    mesh = found["whole"]
    edges = np.sort(np.concatenate([mesh.triangles[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    expected = np.prod(high - low) - 2 / 3 * np.pi * RADIUS**3
    print(f"{case.__name__}: volume {volume_of(mesh) / expected:.4f} of what is expected")
    assert volume_of(mesh) == pytest.approx(expected, rel=0.02)
    for name in ("cut across x", "cut across y"):
        assert volume_of(found[name]) == pytest.approx(expected / 2, rel=0.04), name


@pytest.mark.parametrize("case", [whole, half, rings])
def test_the_fields_on_a_mesh_are_those_of_the_points(case):
    _, found = made(case)
    for mesh in found.values():
        error = np.abs(mesh.fields["pressure"] - pressure(mesh.vertices) / 1e6)
        print(f"{case.__name__}: off by {error.max():.2f} MPa where a spacing makes up to {3.6 * H / UM:.1f}")
        assert error.max() < 3.6 * H / UM
        assert mesh.fields["damage"] == pytest.approx(1), "what has failed can fail no more"
        assert "temperature" not in mesh.fields  # which these points lack


def test_a_mesh_of_many_nodes_is_thinned():
    surface, found = made(whole)
    fine = type(surface)(
        *(np.linspace(x[0], x[-1], 4 * len(x)) for x in (surface.x, surface.y, surface.z)),
        np.kron(surface.fraction, np.ones((4, 4, 4))),
        H,
    )
    fields, setup, _ = whole()
    thin = meshes(fine, fields, setup, present(fields))["whole"]
    assert max(fine.fraction.shape) > MOST_NODES
    print(
        f"{fine.fraction.shape} nodes, {len(thin.triangles)} triangles, {len(found['whole'].triangles)} before"
    )
    assert len(thin.triangles) < 12 * MOST_NODES**2
    assert volume_of(thin) == pytest.approx(volume_of(found["whole"]), rel=0.05)
