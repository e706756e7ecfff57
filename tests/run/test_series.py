"""A run's snapshots are one data set in time for PyVista, and each field says its unit."""

import json

import h5py
import numpy as np
import pytest
from rings import small_rings

from pockmark import RunFolder, run_scene
from pockmark.base.units import to_si
from pockmark.run.extent import NOTHING, cut_back, extent_of
from pockmark.run.series import SERIES
from pockmark.run.snapshot import UNITS, Snapshot

SCENE = small_rings("3 ns")


@pytest.fixture
def folder(tmp_path):
    return run_scene(SCENE, tmp_path / "run", threads=1, progress=False)[0]


def times_in(folder):
    """The times of the series, by the names of its files."""
    table = json.loads((folder.path / SERIES).read_text())
    assert table["file-series-version"] == "1.0"
    return {file["name"]: file["time"] for file in table["files"]}


def test_pyvista_opens_all_snapshots_with_their_times(folder):
    pyvista = pytest.importorskip("pyvista", minversion="0.47")
    reader = pyvista.get_reader(folder.path / SERIES)
    assert reader.time_values == pytest.approx([0, 3e-9, 6e-9, 8e-9], rel=1e-12)
    for time, path in zip(reader.time_values, folder.snapshots(), strict=True):
        reader.set_active_time_value(time)
        grid, ours = reader.read(), Snapshot(path)
        assert ours["time"][0] == time
        np.testing.assert_array_equal(grid.points, ours["position"])
        np.testing.assert_array_equal(grid["pressure"], ours["pressure"])


def test_each_field_says_its_unit(folder):
    with h5py.File(folder.snapshots()[-1]) as file:
        points = file["VTKHDF/PointData"]
        told = {name: field.attrs["units"] for name, field in points.items()}
        assert file["VTKHDF/Points"].attrs["units"] == "m"
        assert file["VTKHDF/FieldData/time"].attrs["units"] == "s"
    assert told.keys() >= UNITS.keys() - {"position"}
    assert told["effective_stress"] == told["pressure"] == "Pa"
    for unit in set(told.values()) - {"1"}:
        assert to_si(f"2 {unit}", unit) == 2  # a unit that our own door knows


def test_the_series_follows_the_snapshots_back(folder):
    before = times_in(folder)
    assert list(before) == [path.name for path in folder.snapshots()]
    cut_back(RunFolder.open(folder.path), extent_of(folder) | {"snapshots": [0, 1]})
    assert times_in(folder) == {name: before[name] for name in list(before)[:2]}
    cut_back(RunFolder.open(folder.path), NOTHING)
    assert not (folder.path / SERIES).exists()


def test_a_snapshot_that_cannot_be_read_is_left_out(folder):
    before = times_in(folder)
    folder.snapshots()[1].write_bytes(b"torn")
    (folder.path / SERIES).write_text("not a series")
    RunFolder.open(folder.path).series.write()
    assert times_in(folder) == {name: time for name, time in before.items() if name != "snapshot-0001.vtkhdf"}


def test_a_replaced_run_has_its_own_series(folder):
    run_scene(SCENE.with_("output.snapshots", "8 ns"), folder.path, threads=1, progress=False, force=True)
    assert list(times_in(folder).values()) == pytest.approx([0, 8e-9])
