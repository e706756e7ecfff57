"""A seeded fuzzer: whatever is written, run or left in a folder, the answer is a result or one clear sentence.

The short form runs with the other tests, the long one by `python -m pytest tests/fuzz --fuzz-long`, which writes summary.csv
here. A case is made from its kind and seed alone: replay.py does one again.
"""

import csv
from pathlib import Path

import pytest
import watch as watch_module
from watch import table, watch

from pockmark import __version__

SUMMARY = Path(__file__).with_name("summary.csv")
# Kind: cases of the short form, of the long one, and the least share that must end well, so that the fuzzer tries something.
FORMS = {
    "scenes": (300, 20_000, 0.1),
    "campaigns": (60, 2000, 0.05),
    "folders": (30, 300, 0.15),
    "runs": (6, 300, 0.8),
}


@pytest.mark.parametrize("kind", FORMS)
def test_nothing_is_wrong_without_a_word(kind, request):
    short, many, least = FORMS[kind]
    is_long = request.config.getoption("--fuzz-long")
    cases = []
    for case in watch(kind, range(many if is_long else short)):
        cases.append(case)
        for fault in case.faults:
            print(f"{kind} {case.seed}: {fault}")
    rows = table(kind, cases)
    for row in rows:
        print(*row, sep="\t")
    if is_long:
        _write(kind, rows)
    assert not [case for case in cases if case.faults]
    assert sum(case.outcome not in ("refused", "traceback") for case in cases) >= least * len(cases)


def _write(kind: str, rows: list[tuple[str, str, int, str]]) -> None:
    """Put the rows of a kind in the place of its old ones in the summary."""
    old: list[list[str]] = []
    if SUMMARY.exists():
        with SUMMARY.open(newline="", encoding="utf-8") as file:
            old = [
                row for row in csv.reader(file) if row and row[0] not in (kind, "kind") and row[0][0] != "#"
            ]
    with SUMMARY.open("w", newline="", encoding="utf-8") as file:
        file.write(f"# pockmark {__version__}: python -m pytest tests/fuzz --fuzz-long\n")
        csv.writer(file, lineterminator="\n").writerows([("kind", "what", "cases", "seeds"), *old, *rows])


SCRIPT = """
import json, os, signal, sys, time
print("ready", flush=True)
for seed in range(int(sys.argv[2]), int(sys.argv[3]) + 1):
    if seed == 1: time.sleep(60)
    if seed == 2: os.abort()
    if seed == 3: os.kill(os.getpid(), signal.SIGPROF)
    faults = ["traceback: so", "traceback: too"] if seed == 4 else []
    print(json.dumps({"seed": seed, "seconds": 0.1, "outcome": "accepted", "faults": faults}), flush=True)
"""


def test_a_hang_and_a_crash_are_faults_and_end_nothing(tmp_path, monkeypatch):
    (tmp_path / "replay.py").write_text(SCRIPT)
    monkeypatch.setattr(watch_module, "REPLAY", tmp_path / "replay.py")
    monkeypatch.setattr(watch_module, "PATIENCE", 0.5)
    cases = list(watch("scenes", range(6)))
    assert [(case.seed, case.outcome) for case in cases] == [
        *((0, "accepted"), (1, "hang"), (2, "crash"), (3, "hang"), (4, "accepted"), (5, "accepted"))
    ]
    assert table("scenes", cases) == [
        ("scenes", "FAULT crash", 1, "2"),
        ("scenes", "FAULT hang", 2, "1 3"),
        ("scenes", "FAULT traceback", 1, "4"),
        ("scenes", "outcome accepted", 3, "0 4 5"),
        ("scenes", "outcome crash", 1, "2"),
        ("scenes", "outcome hang", 2, "1 3"),
    ]
