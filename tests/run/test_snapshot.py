"""Snapshots that were altered: one sentence or the same figures, never a traceback, a hang or another file's data."""

import os
import random
import zlib

import h5py
import numpy as np
import pytest
from altered import LAST, every_reader, refusal

from pockmark import PockmarkError, measure
from pockmark.run.store import RunFolder, Snapshot

FLIPS = 40  # seeded single bits, in the tables and in the numbers of a snapshot


def _in_file(change):
    def alter(path):
        with h5py.File(path, "r+") as file:
            change(file["VTKHDF"])

    return alter


def _instead(name, **made):
    """A dataset in place of another."""

    def change(root):
        del root[name]
        root.create_dataset(name, **made)

    return _in_file(change)


def _linked(link):
    def change(root):
        root.move("PointData/mass", "PointData/weight")
        root["PointData/mass"] = link

    return _in_file(change)


def _virtual(root):
    n = len(root["Points"])
    layout = h5py.VirtualLayout(shape=(n,), dtype="f8")
    layout[:] = h5py.VirtualSource("elsewhere.h5", "mass", shape=(n,))
    del root["PointData/mass"]
    root.create_virtual_dataset("PointData/mass", layout)


def _external(root):
    n = len(root["Points"])
    del root["PointData/mass"]
    root.create_dataset("PointData/mass", shape=(n,), dtype="f8", external=[("/etc/hostname", 0, n * 8)])


def _group_instead(root):
    del root["PointData/mass"]
    root.create_group("PointData/mass")


def _without(name):
    return _in_file(lambda root: root.__delitem__(name))


MASS, POINTS, HUGE = "PointData/mass", "Points", 2**40
SNAPSHOTS = {
    "another HDF5 file": lambda path: h5py.File(path, "w").close(),
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("snapshot"),
    "half": lambda path: os.truncate(path, path.stat().st_size // 2),
    "without its end": lambda path: os.truncate(path, path.stat().st_size - 100),
    "without mass": _without(MASS),
    "without positions": _without(POINTS),
    "without time": _without("FieldData/time"),
    "without fields": _without("PointData"),
    "shorter": _instead(MASS, data=np.ones(7)),
    "longer": _instead(MASS, data=np.ones(10**5)),
    "of another rank": _instead(MASS, data=np.ones((7, 7))),
    "flat positions": _instead(POINTS, data=np.ones(7)),
    "positions of 2": _instead(POINTS, data=np.ones((7, 2))),
    "other positions": _instead(POINTS, data=np.ones((7, 3))),
    "a scalar": _instead(MASS, data=1.0),
    "nothing": _instead(MASS, data=h5py.Empty("f8")),
    "of whole numbers": _instead(MASS, data=np.ones(7, dtype=int)),
    "complex": _instead(MASS, data=np.ones(7, dtype=complex)),
    "texts": _instead(MASS, data=["a"] * 7),
    "structures": _instead(MASS, data=np.zeros(7, dtype=[("a", "f8"), ("b", "f4")])),
    "huge": _instead(MASS, shape=(HUGE,), dtype="f8", chunks=(2**20,)),
    "huge positions": _instead(POINTS, shape=(HUGE, 3), dtype="f8", chunks=(2**20, 3)),
    "huge and never written": _instead(POINTS, shape=(2**30, 3), dtype="f8"),
    "compressed": _instead(MASS, data=np.ones(7), compression=9),
    "two times": _instead("FieldData/time", data=np.ones(2)),
    "a time in words": _instead("FieldData/time", data=["now"]),
    "bodies of floats": _instead("PointData/body", data=np.ones(7)),
    "a soft link": _linked(h5py.SoftLink("/VTKHDF/PointData/weight")),
    "a dangling link": _linked(h5py.SoftLink("/nowhere")),
    "an external link": _linked(h5py.ExternalLink("snapshot-0001.vtkhdf", "/VTKHDF/PointData/mass")),
    "virtual": _in_file(_virtual),
    "external storage": _in_file(_external),
    "a group": _in_file(_group_instead),
}


@pytest.mark.parametrize("change", SNAPSHOTS.values(), ids=SNAPSHOTS)
def test_a_snapshot_that_is_none_is_told(change, folder):
    change(folder / LAST)
    for reader in every_reader():
        assert LAST in refusal(reader, folder)
    refusal(Snapshot, folder / LAST)


def _edited(name, change):
    """A field changed with its check sum, as a careful forger may."""

    def alter(root):
        values = root[name][...]
        change(values)
        root[name][...] = values
        root[name].attrs["crc32"] = np.uint32(zlib.crc32(np.ascontiguousarray(values).tobytes()))

    return _in_file(alter)


def _put(index, value):
    def change(values):
        values[index] = value

    return change


def test_a_snapshot_without_a_check_sum_is_told(folder):
    _in_file(lambda root: root[MASS].attrs.__delitem__("crc32"))(folder / LAST)
    for reader in every_reader():
        assert "PointData/mass has no check sum" in refusal(reader, folder)


def test_a_snapshot_of_another_scene_is_told(folder, original):
    hashed = Snapshot(folder / LAST).scene_hash
    assert hashed == RunFolder(folder).manifest()["scene_hash"]
    _in_file(lambda root: root.attrs.__setitem__("scene_hash", np.bytes_(b"another")))(folder / LAST)
    for reader in every_reader():
        assert "is a snapshot of another scene" in refusal(reader, folder)
    # As in files of before the hash was written.
    _in_file(lambda root: root.attrs.__delitem__("scene_hash"))(folder / LAST)
    assert measure(folder) == original[1]


@pytest.mark.parametrize("value", [1, 1.5, [1, 2], "text", b"\xff", h5py.Empty("f8")], ids=repr)
def test_a_hash_that_is_none_is_told(value, folder):
    _in_file(lambda root: root.attrs.__setitem__("scene_hash", value))(folder / LAST)
    assert LAST in refusal(measure, folder)


EDITS = {
    "far away": (_edited(POINTS, _put(3, 1e300)), "outside of the grid"),
    "at infinity": (_edited(POINTS, _put(3, np.inf)), "outside of the grid"),
    "of no body": (_edited("PointData/body", _put(3, 200)), "body 200"),
}


@pytest.mark.parametrize(("change", "sentence"), EDITS.values(), ids=EDITS)
def test_a_point_that_cannot_be_is_told(change, sentence, folder):
    change(folder / LAST)
    for reader in every_reader():
        assert sentence in refusal(reader, folder)


def test_a_flipped_bit_is_told_or_changes_nothing(original, folder):
    path, rng = folder / LAST, random.Random(14)
    whole, expected, told = path.read_bytes(), dict(Snapshot(original[0] / LAST)), []
    tables = [rng.randrange(8 * 2000) for _ in range(FLIPS)]
    for bit in [*tables, *(rng.randrange(8 * len(whole)) for _ in range(FLIPS))]:
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        try:
            fields = dict(Snapshot(path))
        except PockmarkError as error:
            told.append(str(error))
            continue
        # The bytes of the cells, which nothing here reads, and gaps.
        assert all(np.array_equal(fields[name], expected[name]) for name in expected), bit
    print(f"{len(told)} of {2 * FLIPS} told")
    assert len(told) > FLIPS
    assert all(LAST in sentence and "\n" not in sentence for sentence in told)
