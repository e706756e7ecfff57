"""The bars of a campaign: what each run has reached, read from its folder, and who makes it."""

import io
import os

import pytest
from rich.console import Console

from pockmark import PockmarkError
from pockmark.run.history import append_row, last_time
from pockmark.run.lock import Lock
from pockmark.study.progress import Watched, bars_of

END = 8e-9  # s


def told(bars):
    """What stands beside each bar, and how much of it is filled."""
    return [(task.description, task.percentage) for task in bars._progress.tasks]


def test_a_bar_shows_what_a_run_has_reached_and_who_makes_it(tmp_path):
    runs = [Watched(f"speed {n}", tmp_path / str(n), END, 10.0 + 20.0 * n) for n in range(2)]
    for run in runs:
        run.folder.mkdir()
    with bars_of(Console(file=io.StringIO()), runs, "0 of 2 runs") as bars:
        bars.look()
        assert told(bars) == [("0 of 2 runs", 0.0)]
        lock = Lock(runs[1].folder)
        append_row(runs[1].folder / "history.csv", {"time": 0.25 * END, "step": 7})
        bars.look()
        (_, whole), (text, part) = told(bars)
        print(whole, text, part)
        assert text.startswith(f"speed 1: process {os.getpid()} on ")
        assert (whole, part) == (pytest.approx(100 * 0.25 * 30 / 40), pytest.approx(25))
        lock.release()  # killed: nobody makes it now, and what it has reached is kept
        bars.look()
        assert told(bars) == [("0 of 2 runs", pytest.approx(18.75))]
        bars.end(0, "1 of 2 runs")
        assert told(bars) == [("1 of 2 runs", pytest.approx(18.75 + 25))]
        bars.end(1, "2 of 2 runs")
        assert told(bars) == [("2 of 2 runs", pytest.approx(100))]


def test_the_last_time_is_that_of_the_last_whole_row(tmp_path):
    path = tmp_path / "history.csv"
    assert last_time(path) == 0.0
    path.write_bytes(b"")
    assert last_time(path) == 0.0
    for time in (0.0, 1e-9, 2.5e-9):
        append_row(path, {"time": time, "step": 3})
    assert last_time(path) == 2.5e-9
    with path.open("ab") as file:
        file.write(b"3e-9,4")  # torn
    assert last_time(path) == 2.5e-9
    path.write_text("time,step\n" + "1e-9,2\n" * 20_000)  # longer than what is read of it
    assert last_time(path) == 1e-9
    path.unlink()
    path.symlink_to("/dev/zero")
    with pytest.raises(PockmarkError, match="is no regular file"):
        last_time(path)
