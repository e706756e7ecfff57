"""The table of schemes in its quick form: it runs, is not run twice, and its page says what was measured."""

import csv
import json
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "studies" / "schemes"))
from schemes import TRILINEAR

from pockmark.scene.numerics import Numerics

ROOT = Path(__file__).parents[2]
NO_SCHEME = {"cfl", "strain_limit", "mass_cutoff", "precision"}  # the same for all


def table(out, *words):
    """Run the script on coarse cells, and return what it printed."""
    command = [sys.executable, ROOT / "studies" / "schemes" / "table.py", "--quick", "-o", out, *words]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_scheme_leaves_nothing_to_the_defaults():
    """So that its rows stay its own when a default changes."""
    assert {key.partition(".")[0] for key in TRILINEAR} == set(Numerics.model_fields) - NO_SCHEME


def test_the_quick_form_tells_the_schemes_apart(tmp_path):
    asked = ["--scheme", "trilinear", "--scheme", "cells"]
    said = table(tmp_path, *asked)
    assert "shock" in said
    assert table(tmp_path, *asked) == "", "what is there is not measured again"
    with (tmp_path / "table-quick.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert not [row for row in rows if row["fault"]]
    assert all(row["version"] and row["physics"] for row in rows)
    assert {row["column"] for row in rows} == {"shock", "disk", "bar", "crater"}

    found = {(row["scheme"], row["column"], row["condition"]): json.loads(row["values"]) for row in rows}
    in_frame = {key[0]: of["pressure"] for key, of in found.items() if "target" in key[2]}
    print(in_frame)
    # Points that cross cells lose momentum to noise; by cells nothing jumps where they cross.
    assert abs(in_frame["cells"] - 1) < 0.03
    assert in_frame["trilinear"] < 0.8
    crater = {key[0]: of for key, of in found.items() if key[1] == "crater"}
    assert crater["cells"]["within_MPa"] < 0.5 * crater["trilinear"]["within_MPa"]

    page = (tmp_path / "table-quick.md").read_text(encoding="utf-8")
    lines = [line.split(" | ") for line in page.splitlines() if line.startswith("| cells |")]
    assert len(lines) == 7, "settings, summary, two of the shock, one of each other column"
    assert f"{in_frame['cells']:.3g}".lstrip("0") in lines[1][1]


def test_a_measure_that_takes_too_long_is_stopped_and_taken_up_again(tmp_path):
    asked = ["--scheme", "trilinear", "--only", "disk"]
    assert "not finished in 0.001 s" in table(tmp_path, *asked, "--limit", "0.001")
    assert "stopped" in (tmp_path / "table-quick.md").read_text(encoding="utf-8")
    assert "angular_momentum_change" in table(tmp_path, *asked)
