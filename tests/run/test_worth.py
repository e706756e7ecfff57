"""What a result is worth stands in the result: what `check` knew of it before, why there is no crater, what is not measured."""

import csv
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from pockmark import Scene, measure
from pockmark.base.geometry import Setup, Wall
from pockmark.cli import app
from pockmark.metrology.cautions import of_nothing, of_other_walls, of_resolution
from pockmark.metrology.crater import Crater
from pockmark.metrology.results import EJECTA
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder
from pockmark.scene import warnings as scene_warnings
from pockmark.scene.warnings import lasting_warnings, warnings
from pockmark.study.campaign import Case
from pockmark.study.runner import Outcome, write_results
from pockmark.view.report import report

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
QUIET = ("numerics.shape_functions=quadratic", "body.projectile.rounded=false", "end_time='70 ns'")
UM = 1e-6


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ((), None),
        (("impact.speed='7.5 km/s'",), "its laws are meant for up to 7 km/s"),
        (("body.target.spacing='4 um'",), "1.3 points a cell along an axis; 2 is the usual least"),
        (("body.projectile.rounded=true",), "it has 1.01 times the mass of the written size"),
        (("end_time='20 ns'",), "end_time: 20 ns; the crater is settled after about 64.6 ns"),
        (("impact.speed=0",), "impact.speed is 0: nothing moves"),
        (("body.projectile.projectile=false",), "no body is marked projectile = true: nothing moves"),
        (
            ("numerics.scheme=paper", "numerics.shape_functions=trilinear"),
            "make a plane shock depend on the frame",
        ),
        (("body.projectile.spacing='10 um'",), "fewer than 4 points across the sphere"),
    ],
)
def test_what_makes_a_result_worth_less_lasts(changes, expected):
    scene = Scene.load(QUICK, [*QUIET, *changes])
    found = lasting_warnings(scene)
    print(found)
    assert any(expected in sentence for sentence in found) if expected else found == []
    assert set(found) <= set(warnings(scene))
    assert len(set(warnings(scene))) == len(warnings(scene))


def test_the_result_says_what_check_said(tmp_path, capsys):
    """In the table, in JSON and in a campaign's table, with --quiet too, and each sentence once."""
    folder, changes = tmp_path / "run", ["end_time='4 ns'", "impact.speed='7.5 km/s'"]
    words = ["run", str(QUICK), "-o", str(folder), "--quiet", "--threads", "1"]
    app([*words, *(word for change in changes for word in ("--set", change))], standalone_mode=False)
    table = " ".join(capsys.readouterr().out.replace("│", " ").split())
    scene = Scene.load(QUICK, changes)
    expected, result = lasting_warnings(scene), measure(folder)
    write_results([Outcome(Case(scene, {}, ["g"]), result)], tmp_path, tmp_path / "results.csv")
    (row,) = csv.DictReader((tmp_path / "results.csv").open())
    for sentence in expected:
        assert result["warnings"].count(sentence) == 1
        assert table.count(sentence) == 1
        assert json.loads(row["warnings"]).count(sentence) == 1
    assert len(expected) == 3
    assert result["warnings"] == list(dict.fromkeys(result["warnings"]))


def crater(depth):
    return Crater(depth, (0.0, 0.0), 0.0, None, None, None, None, None)


def test_a_depth_that_may_not_have_settled_says_so():
    """The live depth may be missing where there is a C_p."""
    known, unknown = Setup(UM, settled=65e-9), Setup(UM)
    (said,) = of_resolution(unknown, crater(UM), None)
    assert said.startswith("whether the depth has settled is not known: in the last tenth of the run")
    assert "should have" not in said
    (said,) = of_resolution(known, crater(UM), None)
    assert said.endswith("(it should have after about 65 ns)")
    assert not [*of_resolution(known, None, None)]
    assert not [*of_resolution(known, crater(UM), 0.01)]
    (said,) = of_resolution(known, crater(UM), 0.03)
    assert "has not settled" in said


@pytest.mark.parametrize(("cells", "few"), [(None, False), (10 * (1 - 1e-15), False), (9.99, True)])
def test_check_and_result_call_the_same_cells_few(cells, few, monkeypatch):
    monkeypatch.setattr(scene_warnings, "cells_across", lambda _: cells)
    before = [w for w in warnings(Scene.load(QUICK)) if "cells across the projectile, fewer than 10" in w]
    after = [*of_resolution(Setup(UM, cells_across=cells), None, None)]
    assert (len(before), len(after)) == (few, few)


def test_a_result_without_a_crater_says_why():
    wall = Wall((0,), (-9 * UM, 0.0, -20 * UM), (9 * UM, 9 * UM, 0.0), 2 * UM)
    setup = Setup(UM, wall=wall, arrival=10e-9)
    (early,) = of_nothing(None, None, setup, 4e-9)
    assert (
        early
        == "there is no crater yet: the run came to 4 ns, and the first projectile is at z = 0 after 10 ns"
    )
    for late, time in ((setup, 11e-9), (Setup(UM, wall=wall), 0.0)):
        (whole,) = of_nothing(None, None, late, time)
        assert whole.endswith(
            "the target's surface is whole, with nothing open deeper than half a point spacing, 1 um"
        )
    assert not [*of_nothing(crater(UM), None, setup, 0.0)]


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            ("body.projectile.center=['0 um', '0 um', '19 um']",),
            "the first projectile is at z = 0 after 4.091 ns",
        ),
        (("impact.speed='1 m/s'",), "the target's surface is whole"),
        (("impact.speed=0",), "nothing moves"),
    ],
)
def test_a_run_without_a_crater_says_why_and_has_no_beta(changes, expected, tmp_path):
    run_scene(Scene.load(QUICK, ["end_time='3 ns'", *changes]), tmp_path / "run", threads=1, progress=False)
    result = measure(tmp_path / "run")
    print(result["warnings"])
    assert result["crater"]["depth"] is None
    assert any(expected in sentence for sentence in result["warnings"])
    assert result["ejecta"]["beta"] is None
    assert None not in [result["ejecta"][key] for key in EJECTA if key != "beta"]


def test_a_wall_behind_the_first_is_named():
    wall = Wall((1, 2), (-UM, 0.0, -UM), (UM, UM, 0.0), UM)
    setup = Setup(UM, names=("rear", "back", "front"), wall=wall, walls=((0,), (1, 2)))
    (said,) = of_other_walls(setup)
    assert said == "only the first wall is measured: what the impact does to 'rear' is not in this table"
    assert not [*of_other_walls(Setup(UM, names=("a", "b"), wall=wall, walls=((1, 2),)))]


def test_a_last_snapshot_of_another_time_is_told(tmp_path):
    run_scene(
        Scene.load(QUICK, ["end_time='8 ns'", "output.snapshots='4 ns'"]),
        tmp_path / "run",
        threads=1,
        progress=False,
    )
    assert not any("different times" in sentence for sentence in measure(tmp_path / "run")["warnings"])
    RunFolder(tmp_path / "run").snapshots()[-1].unlink()
    first = measure(tmp_path / "run")["warnings"][0]
    assert first.startswith("the last snapshot is of 4 ns, but the run ended at 8 ns")


@pytest.mark.parametrize(
    ("metres", "spread", "expected"),
    [
        (14e-9, 3e-9, "14.00 +- 3.00 nm"),
        (0.1e-6, 0.0, "0.10 +- 0.00 um"),
        (17.42e-6, 0.5e-6, "17.42 +- 0.50 um"),
        (9999e-6, 1e-6, "9999.00 +- 1.00 um"),
        (0.0146, 1e-4, "14.60 +- 0.10 mm"),
        (14.635959, 0.1, "14.64 +- 0.10 m"),
        (1e-12, 0.3e-6, "0.00 +- 0.30 um"),
        (0.0, 0.0, "0.00 +- 0.00 um"),
    ],
)
def test_lengths_keep_their_digits(metres, spread, expected, shown_result):
    text = shown_result({"depth": metres, "uncertainty": {"depth": spread}})
    assert f"│ {expected} " in text


@pytest.mark.parametrize(
    ("volume", "expected"),
    [
        (1.5e-24, "1500 nm^3"),
        (1.4e-14, "14000 um^3"),
        (2.5e-6, "2500 mm^3"),
        (1e-24 * math.pi, "3141.6 nm^3"),
    ],
)
def test_volumes_keep_their_digits(volume, expected, shown_result):
    assert f"│ {expected} " in shown_result({"volume": volume})


@pytest.fixture(scope="module")
def shown_result(tmp_path_factory):
    """The table of a result with some of its crater changed."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    run_scene(Scene.load(QUICK, ["end_time='4 ns'"]), folder, threads=1, progress=False)
    result = measure(folder)
    assert np.isfinite(result["crater"]["depth"])

    def shown(changes):
        console = Console(width=200, file=io.StringIO())
        console.print(report(result | {"crater": result["crater"] | changes}))
        return console.file.getvalue()

    return shown
