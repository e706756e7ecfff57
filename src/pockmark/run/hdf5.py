"""Datasets with check sums in HDF5 files, read with distrust.

What is read must be as pockmark writes it: numbers that lie in the file itself, plain or in compressed pieces. So no link,
no external or virtual storage and no other filter is followed, and a declared shape cannot ask for more memory than the file's
bytes can hold.
"""

import io
import math
import os
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ..base.errors import PockmarkError
from ..base.files import open_regular, reason, replaced

VERSION = "v108"  # the first of HDF5's formats in which its own tables have check sums
SUM = "crc32"
PIECE = 2**18  # bytes that are compressed as one: many for all cores, each of a size that compresses well
LEVEL = 1  # of deflate: higher ones take twice the time for a twentieth of the size
MOST_DEFLATED = 1032  # bytes that deflate can make of one


@contextmanager
def written(path: Path) -> Iterator[h5py.File]:
    """Give an empty HDF5 file that takes the place of `path` at the end, when it is on the disk.

    Raises PockmarkError where it cannot be written; then what was there stays whole.
    """
    with replaced(path) as descriptor:
        disk = _Disk(descriptor)
        with h5py.File(disk, "w", libver=(VERSION, VERSION)) as file:
            yield file
        if disk.fault is None:
            os.fsync(descriptor)
        else:
            raise PockmarkError(f"{path}: cannot be written ({reason(disk.fault)})")


class _Disk(io.FileIO):
    """A file that keeps its first failure to itself.

    HDF5 crashes the process some time after it has seen one.
    """

    fault: OSError | None = None

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor, "r+", closefd=False)

    def write(self, content: Any) -> int:
        """Write all of the content; nothing after a failure."""
        left = memoryview(content).cast("B")
        size = len(left)
        try:
            while left and self.fault is None:
                left = left[super().write(left) or 0 :]
        except OSError as error:
            self.fault = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Give the file the length that is asked; leave it as it is after a failure."""
        try:
            return self.tell() if self.fault else super().truncate(size)
        except OSError as error:
            self.fault = error
            return self.tell()


@contextmanager
def opened(path: Path, damaged: str, lead: str = "") -> Iterator[tuple[h5py.File, int]]:
    """Give a file to read, and its size in bytes.

    Whatever fails inside is raised as a PockmarkError that names the file: `damaged` says what a file is where HDF5 finds
    a fault, `lead` comes before a sentence of pockmark's own.
    """
    descriptor = open_regular(path, os.O_RDONLY)
    try:
        # By the descriptor: the name may stand for another file by now.
        with h5py.File(f"/proc/self/fd/{descriptor}", "r") as file:
            yield file, os.fstat(descriptor).st_size
    except PockmarkError as error:
        raise type(error)(f"{path}: {lead}{error}") from None
    except Exception as error:  # of a damaged file HDF5 raises any kind
        raise PockmarkError(f"{path}: {damaged} ({reason(error)[:150]})") from None
    finally:
        os.close(descriptor)


def put(group: h5py.Group, name: str, values: NDArray[Any], unit: str = "", *, packed: bool = False) -> None:
    """Write a dataset with the check sum of its bytes, and with its unit if it has one; `packed`: compressed."""
    dataset = put_packed(group, name, values) if packed else group.create_dataset(name, data=values)
    attributes = dataset.attrs
    attributes[SUM] = np.uint32(sum_of(values))
    if unit:
        attributes["units"] = unit


def put_packed(group: h5py.Group, name: str, values: NDArray[Any]) -> h5py.Dataset:
    """Write a dataset by HDF5's filters shuffle and deflate, which every reader has; the cores share the work."""
    if not values.size:
        return group.create_dataset(name, data=values)
    rows = min(len(values), max(1, PIECE // values[:1].nbytes))
    dataset = group.create_dataset(
        name,
        shape=values.shape,
        dtype=values.dtype,
        chunks=(rows, *values.shape[1:]),
        shuffle=True,
        compression=LEVEL,
    )
    starts = range(0, len(values), rows)
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        pieces = pool.map(lambda start: _packed(values[start : start + rows], rows), starts)
        for start, piece in zip(starts, pieces, strict=True):
            dataset.id.write_direct_chunk((start, *[0] * (values.ndim - 1)), piece)
    return dataset


def _packed(values: NDArray[Any], rows: int) -> bytes:
    """Return a piece of so many rows as HDF5 keeps it: the first bytes of all numbers, then the second ones, deflated."""
    piece = np.zeros((rows, *values.shape[1:]), values.dtype)
    piece[: len(values)] = values
    by_number = piece.view(np.uint8).reshape(-1, values.dtype.itemsize)
    return zlib.compress(by_number.T.tobytes(), LEVEL)


def sum_of(values: NDArray[Any]) -> int:
    """Return the check sum of an array's bytes."""
    return zlib.crc32(np.ascontiguousarray(values).data.cast("B")) if values.size else 0


def group_in(parent: h5py.Group, name: str) -> h5py.Group:
    """Return a group that lies in the file itself. Raises PockmarkError if there is none."""
    if isinstance(found := _own(parent, name), h5py.Group):
        return found
    raise PockmarkError(f"{name} is missing or no group")


def dataset_in(root: h5py.Group, place: str, size: int) -> h5py.Dataset:
    """Return a dataset whose bytes all lie in the file itself, as put() has written them.

    `size` is that of the file, bytes. Raises PockmarkError.
    """
    *groups, name = place.split("/")
    for group in groups:
        root = group_in(root, group)
    found = _own(root, name)
    if not isinstance(found, h5py.Dataset) or found.shape is None:
        raise PockmarkError(f"{place} is missing or no dataset")
    layout, needed = found.id.get_create_plist(), math.prod(found.shape) * found.dtype.itemsize
    filters = [layout.get_filter(n)[0] for n in range(layout.get_nfilters())]
    if layout.get_layout() == h5py.h5d.CONTIGUOUS and not layout.get_external_count():
        start = found.id.get_offset()
        is_whole = not needed or (start is not None and start + needed <= size)
    elif layout.get_layout() == h5py.h5d.CHUNKED and filters == [
        h5py.h5z.FILTER_SHUFFLE,
        h5py.h5z.FILTER_DEFLATE,
    ]:
        is_whole = needed <= MOST_DEFLATED * min(found.id.get_storage_size(), size)
    else:
        raise PockmarkError(f"{place} is not stored as pockmark stores it")
    if not is_whole:
        raise PockmarkError(f"{place} is cut off")
    return found


def checked(root: h5py.Group, place: str, size: int) -> NDArray[Any]:
    """Return a dataset's values. Raises PockmarkError unless its check sum is that of its values."""
    return values_of(dataset_in(root, place, size), place)


def values_of(dataset: h5py.Dataset, place: str) -> NDArray[Any]:
    """Return the values of a dataset that lies at `place`. Raises PockmarkError unless its check sum is theirs."""
    values, expected = np.asarray(dataset[...]), dataset.attrs.get(SUM)
    if expected is None or sum_of(values) != int(expected):
        raise PockmarkError(f"{place} is not what was written (its check sum differs)")
    return values


def _own(parent: h5py.Group, name: str) -> Any:
    """Return what a group itself holds under a name; None for nothing and for a link to elsewhere."""
    return parent[name] if isinstance(parent.get(name, getlink=True), h5py.HardLink) else None
