"""A campaign: its cases, what is kept, what fails, what a user is told."""

import csv
import io
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from pockmark import PHYSICS, PockmarkError, __version__
from pockmark.run.pipeline import run_scene
from pockmark.study.campaign import cases, load
from pockmark.study.making import is_done
from pockmark.study.processes import Processes
from pockmark.study.runner import Outcome, line_of, place, run_study, summary, write_results

ROOT = Path(__file__).parents[2]
TEXT = """
title = "two speeds"
scene = "quick.toml"
set = { end_time = "2 ns", "output.snapshots" = "2 ns" }
quick = { end_time = "1 ns" }

[[group]]
name = "speeds"
figures = ["figure-1"]
sweep = { "impact.speed" = ["1 km/s", "2 km/s"] }

[[group]]
name = "again"
set = { "impact.angle" = "0 deg" }
sweep = { "impact.speed" = ["2 km/s"], "numerics.scheme" = ["usavg", "usl"] }
"""


@pytest.fixture
def folder(tmp_path):
    shutil.copy(ROOT / "examples" / "quick.toml", tmp_path)
    (tmp_path / "campaign.toml").write_text(TEXT)
    return tmp_path


def test_a_scene_that_two_groups_want_is_one_case(folder):
    found = cases(load(folder), folder, quick=False, only=[])
    print([(case.label, case.groups) for case in found])
    assert [case.groups for case in found] == [["speeds"], ["speeds", "again"], ["again"]]
    assert {case.scene.end_time for case in found} == {2e-9}
    part = cases(load(folder), folder, quick=False, only=["figure-1"])
    assert [case.groups for case in part] == [["speeds"], ["speeds", "again"]]
    assert {case.scene.end_time for case in cases(load(folder), folder, quick=True, only=[])} == {1e-9}


def test_what_is_done_is_kept_and_what_fails_stops_nothing(folder, tmp_path):
    console = Console(file=io.StringIO())
    found = cases(load(folder), folder, quick=False, only=[])
    out = tmp_path / "runs"
    # The first case cannot run.
    place(out, found[0]).parent.mkdir(parents=True)
    place(out, found[0]).write_text("a file where the run's folder should be")
    outcomes = run_study(found, out, pool=Processes(2), console=console)
    print([(o.case.label, o.fault, o.kept) for o in outcomes])
    assert [bool(o.fault) for o in outcomes] == [True, False, False]
    assert outcomes[1].result["run"]["steps"] > 0
    place(out, found[0]).unlink()
    again = run_study(found, out, pool=Processes(1), console=console)
    assert [o.kept for o in again] == [False, True, True]
    assert all(is_done(place(out, case)) for case in found)
    assert not any(o.fault for o in again)

    write_results(again, out, tmp_path / "results.csv")
    rows = list(csv.DictReader((tmp_path / "results.csv").open()))
    assert [row["impact.speed"] for row in rows] == ["1 km/s", "2 km/s", "2 km/s"]
    assert float(rows[1]["energy.residual_internal"]) == again[1].result["energy"]["residual_internal"]
    assert {(row["version"], row["physics"]) for row in rows} == {(__version__, str(PHYSICS))}
    assert summary(again, "t").row_count == 3


def test_a_campaign_changes_a_body_whose_name_has_a_dot(folder):
    scene = (folder / "quick.toml").read_text().replace('name = "projectile"', 'name = "a.b"')
    (folder / "quick.toml").write_text(scene)
    text = TEXT.replace("end_time =", """'body."a.b".spacing' = "1 um", end_time =""", 1)
    (folder / "campaign.toml").write_text(text)
    assert {case.scene.body[1].spacing for case in cases(load(folder), folder, quick=False, only=[])} == {
        1e-6
    }


def test_lists_of_a_result_are_json_in_the_table(folder, tmp_path):
    case, said = cases(load(folder), folder, quick=True, only=[])[0], ['a "b"', "c, d"]
    result = {
        "warnings": said,
        "doubts": [],
        "ejecta": {"momentum": [1e-9, None]},
        "group": {"each": [{"x": 1}]},
    }
    write_results([Outcome(case, result)], tmp_path, tmp_path / "results.csv")
    (row,) = csv.DictReader((tmp_path / "results.csv").open())
    assert (json.loads(row["warnings"]), json.loads(row["doubts"])) == (said, [])
    assert json.loads(row["ejecta.momentum"]) == [1e-9, None]
    assert "group.each" not in row


@pytest.mark.parametrize(
    ("depths", "unit", "column", "lines"),
    [
        ((14.6e-6, 9.5e-6), "um", ["14.6", "9.5"], ["C_p 14.6 um, D_c 29.2 um", "C_p 9.5 um, D_c 19 um"]),
        ((0.01, 14.6e-6), "mm", ["10", "0.0146"], ["C_p 10 mm, D_c 20 mm", "C_p 14.6 um, D_c 29.2 um"]),
        ((5e-9, None), "nm", ["5", "-"], ["C_p 5 nm, D_c 10 nm", "C_p -, D_c -"]),
        ((None, None), "um", ["-", "-"], ["C_p -, D_c -"] * 2),
    ],
)
def test_lengths_of_a_study_are_in_a_unit_that_suits_them(depths, unit, column, lines, folder):
    case = cases(load(folder), folder, quick=True, only=[])[0]
    craters = [{"depth": depth, "diameter": depth and 2 * depth} for depth in depths]
    outcomes = [Outcome(case, {"crater": crater}) for crater in craters]
    table = summary(outcomes, "t")
    print([str(c.header) for c in table.columns], [list(c.cells) for c in table.columns])
    assert [c.header for c in table.columns[1:3]] == [f"C_p ({unit})", f"D_c ({unit})"]
    assert list(table.columns[1].cells) == column
    assert [str(line_of(outcome)) for outcome in outcomes] == [f"{case.label}: {line}" for line in lines]


@pytest.mark.parametrize("allowed_by", ["", "an option", "the campaign"])
def test_a_coarse_run_of_a_campaign_is_refused_unless_allowed(allowed_by, folder, tmp_path):
    text = TEXT.replace('end_time = "2 ns"', 'end_time = "1 ns", "body.1.radius" = "7.5 um"')
    if allowed_by == "the campaign":
        text = text.replace("title", "coarse = true\ntitle", 1)
    (folder / "campaign.toml").write_text(text)
    words = ["study", folder, "--only", "again", "-o", tmp_path / "out"]
    done = command(*words, *(["--coarse"] if allowed_by == "an option" else []))
    rows = [*csv.DictReader((folder / "results.csv").open())]
    assert len(rows) == 2
    if allowed_by:
        assert done.returncode == 0
        assert done.stdout.count("warning") == 4
        assert all("3 cells across the projectile" in row["warnings"] for row in rows)
        return
    assert done.returncode == 1
    assert done.stdout.count("2 of 2 runs failed") == 1
    for row in rows:
        assert "puts 3 cells across the projectile, at least 4 are needed; --coarse" in row["fault"]


def test_a_part_of_a_campaign_keeps_the_rows_of_the_others(folder, tmp_path):
    out, table = tmp_path / "runs", tmp_path / "results.csv"
    every = cases(load(folder), folder, quick=False, only=[])

    def rows(*wanted):
        outcomes = run_study(wanted, out, pool=Processes(1), console=Console(file=io.StringIO()))
        write_results(outcomes, out, table, every)
        return list(csv.DictReader(table.open()))

    last = rows(every[1])[0]
    found = rows(every[0])
    assert [row["scene"] for row in found] == [case.scene.hash for case in every[:2]]
    assert {key: value for key, value in found[1].items() if value} == {k: v for k, v in last.items() if v}
    # Of another version, or of no run of the campaign any more.
    table.write_text(table.read_text().replace(__version__, "0.0.1").replace(every[0].scene.hash, "gone"))
    assert [row["scene"] for row in rows(every[2])] == [every[2].scene.hash]
    # Of another physics.
    text = table.read_text().replace(f",{__version__},{PHYSICS},", f",{__version__},{PHYSICS - 1},")
    assert text != table.read_text()
    table.write_text(text)
    outcomes = run_study([every[0]], out, pool=Processes(1), console=Console(file=io.StringIO()))
    assert write_results(outcomes, out, table, every) == 1
    assert [row["scene"] for row in csv.DictReader(table.open())] == [every[0].scene.hash]


def test_a_run_of_an_older_physics_is_not_reused(folder, tmp_path):
    case = cases(load(folder), folder, quick=True, only=[])[0]
    run, path = place(tmp_path, case), place(tmp_path, case) / "manifest.json"
    run_scene(case.scene, run, threads=1, progress=False, coarse=True)
    assert is_done(run)
    made = path.read_text()
    for older in (f'"physics": {PHYSICS - 1},', ""):
        path.write_text(made.replace(f'"physics": {PHYSICS},', older))
        assert path.read_text() != made
        assert not is_done(run)


def test_the_physics_is_the_number_of_its_entries_in_the_changelog():
    entries, heading = 0, ""
    for line in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").splitlines():
        heading = line if line.startswith("#") else heading
        entries += heading == "### Physics" and line.startswith("- ")
    assert entries == PHYSICS


def test_a_title_is_no_part_of_what_a_run_is_kept_by(folder):
    scene = cases(load(folder), folder, quick=True, only=[])[0].scene
    titled = scene.model_copy(update={"title": "another"})
    assert titled.hash == scene.hash
    assert scene.model_copy(update={"end_time": 2e-9}).hash != scene.hash


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (TEXT.replace("sweep", "sweeps"), "unknown key"),
        (TEXT.replace('scene = "quick.toml"', ""), "scene: is missing"),
        (TEXT.replace('["1 km/s", "2 km/s"]', "[]"), "sweep"),
        ("title = [", "is not TOML"),
    ],
)
def test_a_slip_is_one_sentence(folder, text, expected):
    (folder / "campaign.toml").write_text(text)
    with pytest.raises(PockmarkError, match=expected) as caught:
        load(folder)
    assert str(folder / "campaign.toml") in str(caught.value)
    assert "\n" not in str(caught.value)


def based_on(folder, base="..", text=""):
    """The folder of a campaign that repeats the one in `folder`."""
    repeated = folder / "repeated"
    repeated.mkdir()
    (repeated / "campaign.toml").write_text(f'based_on = "{base}"\n{text}')
    return repeated


def test_a_campaign_repeats_another_one_with_changes_of_its_own(folder):
    repeated = based_on(folder, text='title = "slow"\nset = { "output.snapshots" = "1 ns" }')
    assert load(repeated).title == "slow"
    found = cases(load(repeated), repeated, quick=False, only=[])
    assert [case.groups for case in found] == [["speeds"], ["speeds", "again"], ["again"]]
    assert {(case.scene.end_time, case.scene.output.snapshots) for case in found} == {(2e-9, 1e-9)}


@pytest.mark.parametrize(
    ("base", "text", "expected"),
    [
        ("../nowhere", "", "nowhere"),
        (".", "", "expected a campaign that is not based on another one"),
        ("..", "set = 3", "set: found 3"),
        ("..", "sets = 3", "unknown key"),
    ],
)
def test_a_slip_of_a_repeated_campaign_is_one_sentence(folder, base, text, expected):
    with pytest.raises(PockmarkError, match=expected) as caught:
        load(based_on(folder, base, text))
    print(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_figure_is_refused(folder):
    with pytest.raises(PockmarkError, match="no such group or figure, allowed are again, figure-1, speeds"):
        cases(load(folder), folder, quick=False, only=["figure-9"])


def test_the_committed_campaigns_load():
    for path in sorted((ROOT / "studies").glob("*/campaign.toml")):
        for quick in (True, False):
            found = cases(load(path.parent), path.parent, quick=quick, only=[])
            print(f"{path.parent.name}: {len(found)} runs{' in the quick form' if quick else ''}")
            assert found
        # `found` is the whole campaign now: its table's rows are of its scenes, and say their physics.
        rows = list(csv.DictReader((path.parent / "results.csv").open()))
        assert {row["scene"] for row in rows} <= {case.scene.hash for case in found}
        assert all(0 < int(row["physics"]) <= PHYSICS for row in rows)


def command(*words):
    """`pockmark WORDS`."""
    line = [sys.executable, "-m", "pockmark", *map(str, words)]
    done = subprocess.run(line, capture_output=True, text=True, timeout=120, check=False)
    print(done.stdout, done.stderr)
    return done


def test_the_command_runs_a_campaign_and_says_where_its_table_is(folder, tmp_path):
    for there in (0, 2):
        done = command("study", folder, "--quick", "--only", "speeds", "-o", tmp_path / "out")
        assert done.returncode == 0
        assert done.stdout.count("was there") == there
        assert len(list(csv.DictReader((tmp_path / "out" / "results-quick.csv").open()))) == 2
