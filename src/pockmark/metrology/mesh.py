"""The crater as a mesh for a view in three dimensions: the target's surface, and what fields are on it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from skimage.measure import block_reduce, marching_cubes

from ..base.geometry import Setup
from .surface import Surface, with_image

Array = NDArray[np.float64]
MOST_NODES = 80  # along an axis: what a page can hold and a browser turns
CUTS = {"whole": None, "cut across y": 1, "cut across x": 0}  # the axis of which one half is left out


@dataclass(frozen=True)
class Mesh:
    """A closed mesh: vertices (n, 3), m, triangles (k, 3) of them, and fields (n,) by name."""

    vertices: Array
    triangles: NDArray[np.int64]
    fields: Mapping[str, Array]


def meshes(
    surface: Surface,
    snapshot: Mapping[str, NDArray[Any]],
    setup: Setup,
    values: Mapping[str, Array],
) -> dict[str, Mesh]:
    """Return the target near the crater as closed meshes: whole, and cut in half across y and across x.

    The surface is that of the snapshot's points. The vertices get fields of these, whose `values` (n,) have names.
    """
    nodes, fraction = _block(surface)
    fields = _Fields.of(snapshot, setup, values, [(x[0], x[-1]) for x in nodes])
    out = {}
    for name, axis in CUTS.items():
        solid = fraction
        if axis is not None:
            half = nodes[axis] > _middle(
                surface, axis
            )  # what a view from above x and y would have in its way
            solid = np.where(np.expand_dims(half, [a for a in range(3) if a != axis]), 0.0, fraction)
        vertices, triangles = _closed(nodes, solid)
        if len(triangles):
            out[name] = Mesh(vertices, triangles, fields.at(vertices))
    return out


def _middle(surface: Surface, axis: int) -> float:
    """Return where the middle of what is open below z = 0 lies on an axis, m."""
    if surface.is_section:
        return 0.0
    below = surface.fraction[:, :, surface.z < -0.25 * surface.spacing] <= 0.5
    weight = below.sum(axis=tuple(a for a in range(3) if a != axis))
    nodes = (surface.x, surface.y)[axis]
    return float(np.average(nodes, weights=weight)) if weight.any() else float(nodes.mean())


def _block(surface: Surface) -> tuple[list[Array], Array]:
    """Return nodes (m) and fraction (nx, ny, nz) of a surface, on MOST_NODES along an axis at most.

    A section is turned about its axis.
    """
    nodes, fraction = [surface.x, surface.y, surface.z], surface.fraction
    if surface.is_section:
        step = -(-len(surface.x) // MOST_NODES)
        nodes[0] = nodes[1] = surface.x[::step]
        radius = np.hypot(*np.meshgrid(nodes[0], nodes[1], indexing="ij")).ravel()
        rows = [np.interp(radius, surface.x, row) for row in fraction[:, 0].T]
        fraction = np.stack(rows, axis=-1).reshape(len(nodes[0]), len(nodes[1]), -1)
    steps = tuple(-(-len(x) // MOST_NODES) for x in nodes)
    if max(steps) > 1:  # means, or a thin wall would come and go with its place
        whole = tuple(slice(len(x) // step * step) for x, step in zip(nodes, steps, strict=True))
        fraction = np.asarray(block_reduce(fraction[whole], steps, np.mean))  # type: ignore[no-untyped-call]
        nodes = [
            x[part].reshape(-1, step).mean(axis=1) for x, part, step in zip(nodes, whole, steps, strict=True)
        ]
    return nodes, fraction


def _closed(nodes: list[Array], fraction: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices (n, 3), m, and triangles (k, 3) where a fraction is 1/2. What lies outside is not solid."""
    padded = np.pad(fraction, 1)
    if not (padded.min() < 0.5 < padded.max()):
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    distance = tuple(float(x[1] - x[0]) for x in nodes)
    vertices, triangles, _, _ = marching_cubes(padded, 0.5, spacing=distance)  # type: ignore[no-untyped-call]
    origin = np.array([x[0] - d for x, d in zip(nodes, distance, strict=True)])
    return origin + vertices, triangles.astype(np.int64)


@dataclass(frozen=True)
class _Fields:
    """The fields of the target's points near a crater, and where these lie: in a section as r and z."""

    tree: cKDTree
    values: Mapping[str, Array]
    width: float
    is_section: bool

    @classmethod
    def of(
        cls,
        snapshot: Mapping[str, NDArray[Any]],
        setup: Setup,
        fields: Mapping[str, Array],
        box: list[tuple[float, float]],
    ) -> "_Fields":
        """Take the target's points within two spacings of a box, and the images of those behind mirrors."""
        room = 2 * setup.spacing
        position = np.asarray(snapshot["position"], dtype=float)
        near = np.isin(snapshot["body"], setup.wall.bodies if setup.wall else setup.targets)
        places, index = position[near], np.flatnonzero(near)
        if setup.is_axisymmetric:
            places = places[:, [0, 2]]
        else:
            for mirror in setup.mirrors:
                places, index = with_image(places, mirror), np.tile(index, 2)
            low, high = (np.array(ends) for ends in zip(*box, strict=True))
            inside = np.all((places > low - room) & (places < high + room), axis=1)
            places, index = places[inside], index[inside]
        values = {name: field[index] for name, field in fields.items()}
        return cls(cKDTree(places), values, setup.spacing, setup.is_axisymmetric)

    def at(self, vertices: Array) -> dict[str, Array]:
        """Return the fields at vertices (n, 3), m: means of the nearest points, weighted over about a spacing."""
        places = vertices
        if self.is_section:
            places = np.stack([np.hypot(vertices[:, 0], vertices[:, 1]), vertices[:, 2]], axis=1)
        count = min(2 ** places.shape[1], self.tree.n)  # as many as a cell has corners
        distance, nearest = (
            np.reshape(found, (len(places), count)) for found in self.tree.query(places, k=count)
        )
        least = distance.min(axis=1, keepdims=True)  # far from all points the nearest counts
        weight = np.exp(-0.5 * (distance**2 - least**2) / self.width**2)
        weight /= weight.sum(axis=1, keepdims=True)
        return {name: (values[nearest] * weight).sum(axis=1) for name, values in self.values.items()}
