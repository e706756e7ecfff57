"""A run in a state that cannot be is doubtful: where it was, how often, and everybody who looks at the run is told."""

import csv
import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pockmark import measure
from pockmark.base.counters import COUNTERS, DOUBTFUL
from pockmark.run.doubts import LEDGER_LIMIT, Doubts, Place, doubts
from pockmark.run.store import RunFolder

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
# Every node's force is scaled down, and so three quarters of the energy come from nowhere.
NONSENSE = {"numerics.mass_cutoff": "1.0", "end_time": "'20 ns'"}
SAID = "the energies do not add up: off by 0."


class Still:
    """What Doubts asks of a simulation: the time, and the points that are in an impossible state now."""

    def __init__(self, time, **found):
        self.time, self._found = time, found

    def impossible(self):
        return self._found


def row(error=0.0, initial=1.0, **counted):
    return dict.fromkeys(COUNTERS, 0.0) | {"error": error, "initial": initial} | counted


def command(*words):
    """`pockmark WORDS`."""
    line = [sys.executable, "-m", "pockmark", *map(str, words)]
    done = subprocess.run(line, capture_output=True, text=True, timeout=120, check=False)
    print(done.stdout, done.stderr)
    return done


def test_these_counters_make_a_run_doubtful():
    assert set(DOUBTFUL) == {
        *("lost_points", "eos_caps", "return_failures", "eos_failures"),
        *("negative_energies", "negative_volumes", "negative_temperatures"),
    }


@pytest.mark.parametrize("name", COUNTERS)
def test_each_doubtful_counter_has_a_sentence_and_no_other(name):
    told = doubts(dict.fromkeys(COUNTERS, 0) | {name: 1234}, 0.0, 0.0)
    expected = [f"points {COUNTERS[name].doubt}: 1,234 times in all ({name})"] if name in DOUBTFUL else []
    assert told == expected


def test_a_sentence_says_how_many_points_when_and_where():
    place = Place(7, 3e-9, [-1e-6, 0.0, -2.5e-6], [4e-6, 5e-6, 0.0])
    (told,) = doubts({"negative_volumes": 1234}, 0.0, 0.0, {"negative_volumes": place})
    box = "within x -1 to 4, y 0 to 5, z -2.5 to 0 um"
    assert (
        told == f"points had no volume left: 7 points at 3 ns, {box}; 1,234 times in all (negative_volumes)"
    )


def test_a_place_of_centimetres_is_said_in_millimetres():
    place = Place(7, 3e-9, [-0.01, 0.0, -0.025], [0.04, 0.05, 0.0])
    (told,) = doubts({"negative_volumes": 1}, 0.0, 0.0, {"negative_volumes": place})
    assert "within x -10 to 40, y 0 to 50, z -25 to 0 mm; " in told


@pytest.mark.parametrize(
    ("error", "is_doubtful"),
    [(0.0, False), (LEDGER_LIMIT, False), (1.01 * LEDGER_LIMIT, True), (math.inf, True), (math.nan, True)],
)
def test_a_ledger_that_does_not_add_up_is_doubtful(error, is_doubtful):
    told = doubts({}, error, 2e-9)
    expected = f"the energies do not add up: off by {error:.3g} of the initial one at 2 ns"
    assert told == ([expected] if is_doubtful else [])


def test_the_worst_row_and_the_largest_place_are_kept():
    kept, corner = Doubts(), ([0.0] * 3, [1e-6] * 3)
    kept.note(Still(1e-9), row(error=-0.3))
    kept.note(Still(2e-9, negative_energies=(5, *corner)), row(error=0.2, negative_energies=5.0))
    kept.note(Still(3e-9, negative_energies=(2, *corner)), row(negative_energies=7.0))
    state, ledger = kept.sentences()
    assert "5 points at 2 ns, within x 0 to 1" in state
    assert "7 times in all" in state
    assert "off by 0.3 of the initial one at 1 ns" in ledger


@pytest.mark.parametrize("wrong", [{"error": math.nan}, {"initial": math.nan}])
def test_what_is_no_number_once_is_not_forgotten(wrong):
    kept = Doubts()
    for time, said in ((1e-9, {}), (2e-9, wrong), (3e-9, {"error": 0.5})):
        kept.note(Still(time), row(**said))
    assert kept.sentences() == ["the energies do not add up: off by nan of the initial one at 2 ns"]


def test_nothing_is_doubted_without_a_reason():
    kept = Doubts()
    kept.note(Still(0.0), row(initial=0.0))
    kept.note(Still(1e-9), row(error=0.009, left_points=9.0, failed_points=9.0))
    assert kept.sentences() == []


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A doubtful run by the command, and what it said."""
    folder = tmp_path_factory.mktemp("doubtful") / "run"
    changes = [word for key, value in NONSENSE.items() for word in ("--set", f"{key}={value}")]
    return folder, command("run", QUICK, "-o", folder, "--quiet", "--threads", 1, *changes)


def test_a_doubtful_run_ends_with_exit_code_3_and_says_why(run):
    folder, done = run
    assert done.returncode == 3
    assert done.stderr == ""
    assert "│ doubtful" in done.stdout
    assert "doubtful: what the table says of it first makes its other numbers worth little" in done.stdout
    assert RunFolder.open(folder).manifest()["doubts"] == measure(folder)["doubts"]


@pytest.mark.parametrize("lacks", ["", "doubts"])
def test_a_doubtful_run_is_measured_as_such(lacks, run, tmp_path):
    """An older manifest, or one of a run that was killed, has no doubts: they are found in the history."""
    folder = RunFolder(shutil.copytree(run[0], tmp_path / "run"))
    folder.write_manifest({key: value for key, value in folder.manifest().items() if key != lacks})
    result = json.loads(command("measure", folder.path, "--json").stdout)
    (sentence,) = result["doubts"]
    assert sentence.startswith(SAID)
    assert sentence.endswith("of the initial one at 20 ns")
    assert result["run"]["doubtful"] is True
    assert "│ doubtful" in command("measure", folder.path).stdout


def test_a_study_says_which_runs_are_doubtful(tmp_path):
    shutil.copy(QUICK, tmp_path)
    changes = ", ".join(f'"{key}" = {value}' for key, value in NONSENSE.items() if key == "end_time")
    sweep = '"numerics.mass_cutoff" = [1.0, 0.0]'
    (tmp_path / "campaign.toml").write_text(
        f'scene = "quick.toml"\nset = {{ {changes} }}\n[[group]]\nname = "g"\nsweep = {{ {sweep} }}\n'
    )
    out = tmp_path / "out"
    for is_kept in (False, True):
        done = command("study", tmp_path, "-o", out)
        assert done.returncode == 3
        assert "1 of 2 runs are doubtful: their numbers are worth little" in done.stdout
        summed = [line for line in done.stdout.splitlines() if "│" in line]
        assert sum("doubtful" in line for line in summed) == 1
        assert done.stdout.count("was there, doubtful") == is_kept
        said = re.search(rf"um, doubtful, \d+ warnings, {SAID}", " ".join(done.stdout.split()))
        assert bool(said) != is_kept
        rows = [*csv.DictReader((tmp_path / "results.csv").open())]
        assert [row["run.doubtful"] for row in rows] == ["True", "False"]
        assert [len(json.loads(row["doubts"])) for row in rows] == [1, 0]
    # What fails is worse than what is doubtful.
    broken = next(path for path in out.iterdir() if not measure(path)["doubts"])
    shutil.rmtree(broken)
    broken.write_text("mine")
    assert command("study", tmp_path, "-o", out).returncode == 1
