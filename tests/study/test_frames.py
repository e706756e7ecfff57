"""Tables for pandas: numbers in SI with their units, nothing lost."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, RunFolder, Scene, example, history_frame, run_scene, study_frame
from pockmark.base.ledger import LEDGER, unit_of

ROOT = Path(__file__).parents[2]
TABLES = sorted((ROOT / "studies").glob("*/results.csv"))
SMALL = {
    "grid.cell": "5 um",
    "body.wall.spacing": "2.5 um",
    "body.ball.spacing": "1.25 um",
    "end_time": "4 ns",
}


def test_a_history_is_that_of_the_folder(tmp_path):
    folder, _ = run_scene(
        Scene.load(example("rings")).with_(SMALL), tmp_path / "run", threads=1, progress=False
    )
    frame, columns = history_frame(folder), RunFolder.open(folder).history()
    assert list(frame) == list(columns)
    for name, values in columns.items():
        np.testing.assert_array_equal(frame[name], values)
    units = frame.attrs["units"]
    assert (units["time"], units["depth"], units["kinetic"], units["mass"], units["failed_points"]) == (
        "s",
        "m",
        "J",
        "kg",
        "1",
    )
    assert frame["failed_points"].dtype == frame["step"].dtype == np.int64


def test_a_unit_of_the_ledger_is_what_its_words_say():
    for key, words in LEDGER.items():
        assert f", {unit_of(key)}" in words, key


@pytest.mark.parametrize("path", TABLES, ids=lambda path: path.parent.name)
def test_the_committed_tables_are_numbers(path):
    frame = study_frame(path.parent)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(frame) == len(rows)
    for name, unit in frame.attrs["units"].items():
        assert frame[name].dtype == np.float64, name
        for number, row in zip(frame[name], rows, strict=True):
            assert row[name] == "" or np.isfinite(number), (name, row[name], unit)
    depth = [float(row["crater.depth"]) if row["crater.depth"] else np.nan for row in rows]
    np.testing.assert_array_equal(frame["crater.depth"], depth)
    assert all(isinstance(told, list) for told in frame.get("warnings", []))


def test_what_is_no_quantity_stays_as_it_is_written(tmp_path):
    corners = "['-50 um', '0 um', '-50 um']"
    (tmp_path / "results.csv").write_text(
        f'impact.speed,grid.lower,numerics.scheme,groups\n2 km/s,"{corners}",usf,a\n,,,b\n'
    )
    frame = study_frame(tmp_path)
    assert frame.attrs["units"] == {"impact.speed": "m/s"}
    assert frame["impact.speed"].tolist()[0] == 2000
    assert np.isnan(frame["impact.speed"].tolist()[1])
    assert frame["grid.lower"][0] == corners
    assert frame["numerics.scheme"][0] == "usf"


def test_a_swept_speed_is_in_metres_a_second():
    frame = study_frame(ROOT / "studies" / "single-particle" / "results.csv")
    assert frame.attrs["units"]["impact.speed"] == "m/s"
    assert 500 < frame["impact.speed"].min() < frame["impact.speed"].max() < 10_000
    assert 0.2 < frame["impact.angle"].max() < 1.6  # rad


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (None, "results.csv: cannot be read as a table"),
        ("", "cannot be read as a table"),
        ("a,b\n1,2\n", "lacks the column groups"),
    ],
)
def test_what_is_no_table_is_one_sentence(text, sentence, tmp_path):
    if text is not None:
        (tmp_path / "results.csv").write_text(text)
    with pytest.raises(PockmarkError, match=sentence):
        study_frame(tmp_path)


def test_without_pandas_it_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(PockmarkError, match=r"pandas is not installed: pip install 'pockmark\[pandas\]'"):
        study_frame(TABLES[0])
