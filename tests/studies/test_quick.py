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


def test_committed_tables_name_the_version_that_made_them():
    tables = sorted((ROOT / "studies").rglob("*.csv"))
    assert tables
    for table in tables:
        with table.open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                assert row["version"], f"{table}: {row['case']}"
                assert row["commit"], f"{table}: {row['case']}"
                assert not row["commit"].endswith("-dirty"), (
                    f"{table}: {row['case']} was made by an uncommitted tree"
                )
