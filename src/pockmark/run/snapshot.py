"""A snapshot: all fields of all points in a VTKHDF file, written with check sums and read with distrust."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..base.errors import PockmarkError
from ..metrology.stress import effective_stress
from .hdf5 import SUM, dataset_in, group_in, opened, put, put_packed, values_of, written

FILE = re.compile(r"snapshot-(\d{1,9})\.vtkhdf")
COMPONENTS = {str(field["name"]): int(field["components"]) for field in _core.fields()}
UNITS = {str(field["name"]): str(field["unit"]) for field in _core.fields()} | {"body": "1", "id": "1"}
# The fields of which measures and pictures are made. A file without one of them is no snapshot.
NEEDED = ("position", "velocity", "mass", "volume", "deviator", "pressure", "body", "time")
DERIVED = {
    "deviator": ("effective_stress", "Pa", effective_stress)
}  # what follows from a field and is written beside it
# Kept in single precision: what is looked at, and of which no sum is taken that must close.
ROUNDED = (
    "deviator",
    "effective_stress",
    "pressure",
    "viscosity",
    "temperature",
    "plastic_strain",
    "damage",
)
NO_SNAPSHOT = "is not a snapshot of pockmark's"
HASH = "scene_hash"  # attribute: the hash of the points' scene


class Snapshot(Mapping[str, NDArray[Any]]):
    """The fields of a snapshot's file. Each is read when it is first asked for.

    `time` is an array of one, s. `scene_hash` is None in files of before it was written.
    """

    def __init__(self, path: Path) -> None:
        """Look at the shapes of all fields. Raises PockmarkError if the file is not a whole snapshot."""
        self.path = path
        self._read: dict[str, NDArray[Any]] = {}
        self._places = {"position": "Points", "time": "FieldData/time"}
        with self._root() as (root, size):
            self.scene_hash = _hash(root)
            self._places |= {name: f"PointData/{name}" for name in group_in(root, "PointData")}
            if missing := [name for name in NEEDED if name not in self._places]:
                raise PockmarkError(f"lacks the field {missing[0]}")
            self._points = len(dataset_in(root, "Points", size))
            for name in self._places:
                self._dataset(root, name, size)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a field by its name. Raises PockmarkError if its check sum is not that of what was written."""
        if name not in self._read:
            with self._root() as (root, size):
                self._read[name] = values_of(self._dataset(root, name, size), self._places[name])
        return self._read[name]

    def __contains__(self, name: object) -> bool:
        """Return whether there is a field of a name, without reading it."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """Return the names of the fields."""
        return iter(self._places)

    def __len__(self) -> int:
        """Return the number of fields."""
        return len(self._places)

    def _dataset(self, root: h5py.Group, name: str, size: int) -> h5py.Dataset:
        """Return a field's dataset. Raises PockmarkError unless it has the shape and the type of the field."""
        place = self._places[name]
        dataset = dataset_in(root, place, size)
        components = COMPONENTS.get(name, 1)
        shape = (1,) if name == "time" else (self._points, components)[: 1 + (components > 1)]
        if dataset.shape != shape:
            raise PockmarkError(f"{place} has the shape {dataset.shape}, expected {shape}")
        if dataset.dtype.kind not in ("u" if name in ("body", "id") else "f"):
            raise PockmarkError(
                f"{place} is of the type {dataset.dtype}, which pockmark does not write there"
            )
        if SUM not in dataset.attrs:
            raise PockmarkError(f"{place} has no check sum: another program has written it")
        return dataset

    @contextmanager
    def _root(self) -> Iterator[tuple[h5py.Group, int]]:
        """Give the group of the points, and the file's size in bytes."""
        with opened(self.path, NO_SNAPSHOT, f"{NO_SNAPSHOT}: ") as (file, size):
            yield group_in(file, "VTKHDF"), size


def write_snapshot(
    path: Path, fields: Mapping[str, NDArray[Any]], time_s: float, step: int, scene_hash: str
) -> None:
    """Write all fields of all points of a scene into a new file. Raises PockmarkError, and then there is no file."""
    with written(path) as file:
        _write_vtkhdf(file, fields, time_s, step)
        file["VTKHDF"].attrs[HASH] = np.bytes_(scene_hash.encode())


def _write_vtkhdf(file: h5py.File, fields: Mapping[str, NDArray[Any]], time_s: float, step: int) -> None:
    """Write the points as an unstructured grid of vertices (VTKHDF 2.2)."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = (2, 2)
    root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
    n = len(fields["position"])
    for name, count in (("NumberOfPoints", n), ("NumberOfCells", n), ("NumberOfConnectivityIds", n)):
        root.create_dataset(name, data=np.array([count], dtype=np.int64))
    put(root, "Points", fields["position"], UNITS["position"], packed=True)
    put_packed(root, "Connectivity", np.arange(n, dtype=np.int64))
    put_packed(root, "Offsets", np.arange(n + 1, dtype=np.int64))
    put_packed(root, "Types", np.full(n, 1, dtype=np.uint8))
    data = root.create_group("PointData")
    for name in fields:
        if name == "position":
            continue
        values = fields[name]  # asked for once: a simulation copies a field each time
        put(data, name, _enough(name, values), UNITS[name], packed=True)
        if name in DERIVED:
            derived, unit, compute = DERIVED[name]
            put(data, derived, _enough(derived, compute(values)), unit, packed=True)
    extra = root.create_group("FieldData")
    put(extra, "time", np.array([time_s]), "s")
    put(extra, "step", np.array([step], dtype=np.int64), "1")


def _enough(name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Return a field in the precision that it is kept in."""
    return values.astype(np.float32) if name in ROUNDED else values


def _hash(root: h5py.Group) -> str | None:
    """Return the hash of the scene of a snapshot; None if the file has none."""
    found = root.attrs.get(HASH)
    return None if found is None else bytes(found).decode(errors="replace")
