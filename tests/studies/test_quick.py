"""The studies' quick forms: the commands of studies/README.md run, and their tables say what ran."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
QUICK = {
    "convergence": ["model-1", "treatment-inactive"],
    "robustness": ["group-4500-usavg", "single-5000-usavg", "single-5000-usf"],
}


@pytest.mark.parametrize("study", QUICK)
def test_quick_form_keeps_a_finished_row_a_case(study, tmp_path):
    only = [word for case in QUICK[study] for word in ("--only", case)]
    command = [sys.executable, f"studies/{study}/run.py", "--quick", "--out", str(tmp_path), *only]
    subprocess.run(command, cwd=ROOT, check=True, timeout=600)
    rows = {}
    for table in tmp_path.glob("*.csv"):
        with table.open(newline="", encoding="utf-8") as file:
            rows |= {row["case"]: row for row in csv.DictReader(file)}
    assert sorted(rows) == sorted(QUICK[study])
    for case, row in rows.items():
        print(case, row["E_in_grid"], row["kinetic"], row["ledger_error"])
        assert row["outcome"] == "finished"
        # USAVG closes its ledger to round-off from the first step on; USF does not.
        assert (abs(float(row["ledger_error"])) < 1e-5) == (row["scheme"] == "usavg")


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


@pytest.mark.parametrize("study", HOLD)
def test_a_quick_campaign_shows_what_the_paper_says(study, tmp_path):
    command = [
        sys.executable,
        "-m",
        "pockmark",
        "study",
        study,
        "--quick",
        "--jobs",
        "2",
        "-o",
        str(tmp_path),
    ]
    subprocess.run(command, cwd=ROOT, check=True, timeout=600)
    with (tmp_path / "trends.csv").open(newline="", encoding="utf-8") as file:
        found = {row["statement"]: row["holds"] for row in csv.DictReader(file)}
    missing = [text for text in HOLD[study] if found.get(text) != "yes"]
    assert not missing
    assert {path.stem for path in tmp_path.glob("figure-*.png")} >= {f"figure-{n}" for n in range(4, 13)}


def test_the_quick_form_of_the_group_finds_the_papers_modes_at_high_speed(tmp_path):
    """At 700 m/s small balls leave less than half a point spacing in its coarse target."""
    command = [
        sys.executable,
        "-m",
        "pockmark",
        "study",
        "particle-group",
        "--quick",
        "--jobs",
        "2",
        "-o",
        tmp_path,
    ]
    subprocess.run([*map(str, command)], cwd=ROOT, check=True, timeout=600)
    with (tmp_path / "table-4.csv").open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["speed_m/s"] == "4500"]
    found = {(row["angle_deg"], row["flux_mg/cm2"]): (row["paper"], row["ours"]) for row in rows}
    print(found)
    assert found["0", "1"] == ("c", "c")
    assert found["30", "1"] == ("f", "f")
    assert all(abs(ord(paper) - ord(ours)) <= 1 for paper, ours in found.values())
    assert (tmp_path / "figure-17c.png").exists()


def test_committed_tables_name_the_version_that_made_them():
    tables = sorted((ROOT / "studies").rglob("*.csv"))
    assert tables
    for table in tables:
        with table.open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if "version" not in row:  # what a table says of others that name theirs
                    continue
                assert row["version"], f"{table}: {row}"
                assert row["commit"], f"{table}: {row}"
                assert not row["commit"].endswith("-dirty"), f"{table}: {row} was made by an uncommitted tree"
