"""The studies' quick forms: the commands of studies/README.md run, and their tables say what ran."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def study(name, out, *words):
    """`pockmark study NAME --quick`."""
    command = [sys.executable, "-m", "pockmark", "study", name, "--quick", "--jobs", "2", "-o", out, *words]
    done = subprocess.run([*map(str, command)], cwd=ROOT, check=False, timeout=600)
    rows = table(Path(out) / "results-quick.csv")
    # Some campaigns show what a scheme does that gains energy: such runs are doubtful, and the exit code says so.
    assert done.returncode == (3 if any(json.loads(row["doubts"]) for row in rows) else 0)


def table(path):
    """The rows of a CSV table."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(("name", "of"), [("convergence", "table-2"), ("group-convergence", "table-3")])
def test_the_quick_form_of_a_convergence_study_fills_its_tables(name, of, tmp_path):
    study(name, tmp_path, "--only", of, "--only", "short-steps")
    models = table(tmp_path / f"{of}.csv")
    assert {row["model"] for row in models} >= {"1", "2", "3"}
    # The paper's and ours; Table 3 has the paper's alone, for we have no model 4 of it.
    assert len(table(tmp_path / f"{of}-order.csv")) == {"table-2": 4, "table-3": 2}[of]
    rows = table(tmp_path / "results-quick.csv")
    assert any("short-steps" in row["groups"] for row in rows)
    # A row for every run that a group other than the models' wants.
    others = [name for row in rows if (name := re.sub(rf"{of}-model-\d", "", row["groups"]).strip())]
    assert len(table(tmp_path / "variants.csv")) == len(others)
    for row in rows:
        print(row["groups"], row["run.scheme"], row["energy.ledger_error"])
        bound = 1e-5 if row["run.precision"] == "double" else 1e-4
        # USAVG closes its ledger to round-off from the first step on; USF does not.
        assert (abs(float(row["energy.ledger_error"])) < bound) == (row["run.scheme"] == "usavg")


# Of the statements of a campaign's report, those that its quick form's coarse cells are enough for.
HOLD = {
    "single-particle": [
        "C_p/D_c rises with the speed",
        "C_p/D_c ends at about 1/2",
        "C_p/d_p is below Eq. 22 up to 1.5 km/s",
        "C_p/d_p comes closer to Eq. 22 with the speed",
        "C_p rises with the speed",
        "D_max rises with the speed",
        "D_min rises with the speed",
        "C_p is smaller at a larger angle",
        "C_p/D_max is smaller at a larger angle",
        "friction .05 to .9 and sticky contact leave C_p within a cell",
    ]
}


@pytest.mark.parametrize("name", HOLD)
def test_a_quick_campaign_shows_what_the_paper_says(name, tmp_path):
    study(name, tmp_path)
    found = {row["statement"]: row["holds"] for row in table(tmp_path / "trends.csv")}
    missing = [text for text in HOLD[name] if found.get(text) != "yes"]
    assert not missing
    assert {path.stem for path in tmp_path.glob("figure-*.png")} >= {f"figure-{n}" for n in range(4, 13)}


def test_the_quick_form_of_the_group_finds_the_papers_modes_at_high_speed(tmp_path):
    """At 700 m/s small balls leave less than half a point spacing in its coarse target."""
    study("particle-group", tmp_path)
    rows = [row for row in table(tmp_path / "table-4.csv") if row["speed_m/s"] == "4500"]
    found = {(row["angle_deg"], row["flux_mg/cm2"]): (row["paper"], row["ours"]) for row in rows}
    print(found)
    assert found["0", "1"] == ("c", "c")
    assert found["30", "1"] == ("f", "f")
    assert all(abs(ord(paper) - ord(ours)) <= 1 for paper, ours in found.values())
    assert (tmp_path / "figure-17c.png").exists()


def test_committed_tables_name_the_version_that_made_them():
    tables = sorted((ROOT / "studies").rglob("*.csv"))
    assert tables
    for path in tables:
        for row in table(path):
            if "version" not in row:  # what a table says of others that name theirs
                continue
            assert row["version"], f"{path}: {row}"
            assert row["commit"], f"{path}: {row}"
            assert not row["commit"].endswith("-dirty"), f"{path}: {row} was made by an uncommitted tree"
