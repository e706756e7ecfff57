"""What a convergence study says: of clean values, of none, of runs that failed; and the command, to its end and stopped."""

import csv
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import typer
from rich.console import Console

from pockmark import Scene, __version__
from pockmark.cli.converge import _draw, _leave
from pockmark.study.convergence import QUANTITIES, cases_of, findings, order_told, panels, sentence
from pockmark.study.convergence_table import table_of, write_files
from pockmark.study.levels import plan_of
from pockmark.study.runner import Outcome, is_done

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
# Cells of 5, 3.8 and 2.9 um in 3D, a quarter of a second each.
SHORT = ["--set", "end_time='4 ns'", "--in-3d", "--budget", "0.2 s", "--levels", "3"]


@pytest.fixture(scope="module")
def plan():
    """Cells of 5, 2.5, 1.25 and .625 um."""
    return plan_of(Scene.load(QUICK), most=4, budget=240.0, threads=2)


def outcomes(plan, depths, *, readings=None, doubts=None, faults=None, energy=0.9):
    """Return what runs would come to; None for a depth is a run without a crater."""
    found = []
    for n, (case, depth) in enumerate(zip(cases_of(plan), depths, strict=True)):
        crater = {
            "depth": depth,
            "uncertainty": None if depth is None else {"depth": (readings or [0.0] * 9)[n]},
        }
        result = {
            "crater": crater,
            "energy": {"residual_internal": energy},
            "doubts": (doubts or {}).get(n, []),
        }
        fault = (faults or {}).get(n, "")
        found.append(Outcome(case, None if fault else result, fault))
    return found


def depth_of(plan, *args, **kwargs):
    finding = findings(plan, outcomes(plan, *args, **kwargs))[0]
    assert finding.quantity.name == "C_p"
    print(sentence(finding), "|", finding.limit and order_told(finding.limit), "|", finding.missing)
    return finding


def test_first_order_gives_the_limit_and_the_error_of_the_cell(plan):
    finding = depth_of(plan, [20e-6 * (1 - 0.3 * level.cell / 5e-6) for level in plan.levels])
    assert finding.limit.value == pytest.approx(20e-6, rel=1e-6)
    assert (
        sentence(finding) == "C_p = 20.00 +- 0.94 um at the limit; your cell of 5 um has -30.0 +- 4.7 % error"
    )
    assert order_told(finding.limit) == "1.00"
    assert finding.error(finding.on(5e-6))[0] == pytest.approx(-0.3, rel=1e-5)


def test_the_reading_of_a_depth_is_in_the_interval(plan):
    depths = [20e-6 * (1 - 0.2 * level.cell / 5e-6) for level in plan.levels]
    sharp, blurred = (depth_of(plan, depths, readings=[u] * 4).limit.uncertainty for u in (0.0, 1e-6))
    assert blurred > sharp
    assert blurred > 2e-6


@pytest.mark.parametrize(
    ("depths", "words"),
    [
        (
            [14.6e-6, 17.4e-6, 20.2e-6, 23.1e-6],
            "does not converge on these cells, where it is 14.6 to 23.1 um",
        ),
        ([14.6e-6, None, None, None], "its limit is not known, for fewer than two cells have a value"),
        (
            [15e-6] * 4,
            "C_p = 15.0000 +- 0.0000 um at the limit; your cell of 5 um has +0.0000 +- 0.0000 % error",
        ),
        (
            [None, 16e-6, 17e-6, 17.5e-6],
            "C_p = 18.00 +- 0.63 um at the limit; your cell of 5 um has no value",
        ),
    ],
)
def test_other_values_are_told_as_they_are(depths, words, plan):
    assert words in sentence(depth_of(plan, depths))


@pytest.mark.parametrize(
    ("depths", "words"),
    [
        ([10e-6, 14e-6, 15e-6, 15.2e-6], "2, for 2"),
        ([10e-6, 11e-6, 11.8e-6, 12.5e-6], "0.5, for 0.2"),
        ([10e-6, 12e-6, 11e-6, 11.5e-6], "and the values rise and fall"),
        ([15e-6, 16e-6, None, None], "1, assumed: there are two cells"),
        ([15e-6] * 4, "none: the values are the same"),
        ([10e-6, 11e-6, 13e-6, 17e-6], "none, the fitted one is -1"),
    ],
)
def test_how_the_limit_is_known_is_told(depths, words, plan):
    assert words in order_told(depth_of(plan, depths).limit)


def test_what_failed_or_is_doubtful_is_left_out_and_told(plan):
    finding = depth_of(
        plan, [1.0, 16e-6, 17e-6, 99.0], doubts={0: ["energies are off"]}, faults={3: "no memory"}
    )
    assert finding.values == (16e-6, 17e-6)
    assert finding.missing == ("5 um: the run is doubtful", "0.625 um: no memory")
    energy = findings(plan, outcomes(plan, [None] * 4))
    assert [f.quantity.name for f in energy] == ["E_i^r"]  # of what no run has, nothing is said
    assert not energy[0].missing


def test_the_table_and_the_files_have_every_value(plan, tmp_path):
    runs = outcomes(plan, [16e-6, 18e-6, 19e-6, 19.5e-6], faults={0: "it broke"})
    found = findings(plan, runs)
    table = table_of(plan, found, "a [title]")
    console = Console(width=200, record=True)
    console.print(table)
    text = console.export_text()
    assert "5 um *" in text
    assert [cell.split()[0] for cell in table.columns[1].cells][:4] == ["-", "18", "19", "19.5"]
    paths = write_files(plan, found, runs, tmp_path / "new")
    rows = list(csv.DictReader(paths[0].open()))
    assert [(row["quantity"], float(row["value"])) for row in rows] == [
        *(("C_p", depth) for depth in (18e-6, 19e-6, 19.5e-6)),
        *(("E_i^r", 0.9),) * 3,
    ]
    told = json.loads(paths[1].read_text())
    assert told["version"] == __version__
    assert told["quantities"]["depth"]["limit"] == found[0].limit.value
    assert told["quantities"]["depth"]["errors"] == [float(row["error"]) for row in rows[:3]]
    assert told["quantities"]["depth"]["missing"] == ["5 um: it broke"]
    assert [level["scene"] for level in told["levels"]] == [level.scene.hash for level in plan.levels]


@pytest.mark.parametrize(
    "depths", [[16e-6, 18e-6, 19e-6, 19.5e-6], [16e-6, None, None, None], [10e-6, 11e-6, 13e-6, 17e-6]]
)
def test_the_figure_is_drawn(depths, plan, tmp_path):
    found = findings(plan, outcomes(plan, depths))
    assert _draw(found, "a $title_", tmp_path).stat().st_size > 10_000
    first = next(panels(found))
    assert first.name == "$C_p$ (um)"
    assert [value / first.size for value in first.values] == pytest.approx([d * 1e6 for d in depths if d])


def test_every_quantity_is_a_key_of_a_result():
    for quantity in QUANTITIES:
        assert quantity.of({quantity.table: {quantity.key: 2.5}}) == 2.5
        assert quantity.of(None) is None


@pytest.mark.parametrize(
    ("kwargs", "code"), [({"faults": {1: "x"}}, 1), ({"doubts": {1: ["x"]}}, 3), ({}, None)]
)
def test_the_exit_code_says_what_failed(kwargs, code, plan):
    runs = outcomes(plan, [16e-6, 18e-6, 19e-6, 19.5e-6], **kwargs)
    if code is None:
        _leave(runs)
        return
    with pytest.raises(typer.Exit) as caught:
        _leave(runs)
    assert caught.value.exit_code == code


def command(folder, *words, start=False):
    """`pockmark converge` of the quick scene, in a folder."""
    line = [sys.executable, "-m", "pockmark", "converge", str(QUICK), *words, "-o", str(folder)]
    if start:
        return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    done = subprocess.run(line, capture_output=True, text=True, timeout=300, check=False)
    print(done.stdout, done.stderr)
    return done


def test_the_command_says_the_limit_and_keeps_its_runs(tmp_path):
    done = command(tmp_path, *SHORT)
    assert done.returncode == 0
    assert "5 um (your cell)" in done.stdout
    assert "C_p" in done.stdout
    assert {path.name for path in tmp_path.iterdir() if path.is_file()} == {
        "converge.csv",
        "converge.json",
        "converge.png",
    }
    told = json.loads((tmp_path / "converge.json").read_text())
    assert len(told["levels"]) == 3
    assert told["why_3d"] == "--in-3d forbids it"
    assert all(is_done(tmp_path / level["scene"]) for level in told["levels"])
    assert told["quantities"]["depth"]["sentence"].split()[0] == "C_p"
    again = command(tmp_path, *SHORT)
    assert "3 of 3 runs were there" in again.stdout
    assert json.loads((tmp_path / "converge.json").read_text()) == told


def test_a_normal_impact_is_axisymmetric(tmp_path):
    done = command(tmp_path, "--set", "end_time='4 ns'", "--budget", "1 s", "--levels", "2")
    assert done.returncode == 0
    assert "as an axisymmetric impact" in done.stdout
    assert "E_i^r = " in done.stdout


def test_a_stopped_study_goes_on(tmp_path):
    words = ["--in-3d", "--budget", "1.5 s", "--levels", "3"]
    running = command(tmp_path, *words, start=True)
    deadline = time.monotonic() + 120
    while not any(is_done(path) for path in tmp_path.glob("*")) and time.monotonic() < deadline:
        time.sleep(0.1)
    running.send_signal(signal.SIGTERM)
    out, said = running.communicate(timeout=120)
    print(out, said)
    assert running.returncode == 130
    assert "the same command goes on" in out
    assert not (tmp_path / "converge.json").exists()
    done = command(tmp_path, *words)
    assert done.returncode == 0
    assert (tmp_path / "converge.json").exists()
    assert done.stdout.count("converge, cell") < 3  # at least one run was there


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--budget", "4"], "--budget: found '4', its unit is missing: expected one in s"),
        (["--budget", "1 ms"], "--budget: found 0.001 s, but two cells, "),
        (["--set", "body.1.radius='5 um'"], "puts 2 cells across the projectile, at least 4 are needed"),
        (["--set", "grid.cel=1"], "unknown key"),
    ],
)
def test_a_slip_is_one_sentence(words, expected, tmp_path):
    done = command(tmp_path / "out", *words)
    assert done.returncode == 2
    assert expected in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
