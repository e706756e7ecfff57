"""Runs and studies that are stopped, killed, or started twice: nothing is mixed, nothing is left behind."""

import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from rich.console import Console

from pockmark import PockmarkError, Scene, measure
from pockmark.run.measured import standing_of
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder
from pockmark.study.campaign import cases, load
from pockmark.study.processes import Processes
from pockmark.study.runner import place, run_study

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
SMALL = ["grid.cell='10 um'", "body.target.spacing='5 um'", "body.projectile.spacing='2.5 um'"]
LONG = [*SMALL, "end_time='1 ms'", "output.snapshots='100 us'", "output.history='2 us'"]


def hear_stops(hangup=signal.SIG_DFL):
    """In a process that is started: where tests run in the background or under nohup, they may be ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, hangup)


def start(*words, hangup=signal.SIG_DFL):
    """`pockmark WORDS` in a process of its own that hears what stops it, but for a hangup where that is to be ignored."""
    return subprocess.Popen(
        [sys.executable, "-m", "pockmark", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: hear_stops(hangup),
    )


def start_run(folder, **how):
    """A run that takes minutes."""
    changes = [word for change in LONG for word in ("--set", change)]
    return start("run", QUICK, "-o", folder, "--quiet", "--coarse", "--threads", 1, *changes, **how)


def wait_until(true, seconds=60.0):
    """Wait for something to become true."""
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def rows(folder):
    """How many rows the history has now."""
    path = folder / "history.csv"
    return path.read_bytes().count(b"\n") - 1 if path.exists() else 0


def lives(pid):
    """Whether a process is there and no zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """A run that was measured and attacked while it ran, and then killed."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    run = start_run(folder)
    try:
        wait_until(lambda: rows(folder) > 3)
        told = {"status": measure(folder)["run"]["status"], "standing": standing_of(folder)}
        for force in (False, True):
            with pytest.raises(PockmarkError) as caught:
                run_scene(
                    Scene.load(QUICK, SMALL), folder, threads=1, force=force, progress=False, coarse=True
                )
            told[force] = str(caught.value)
        told["pid"] = run.pid
        assert run.poll() is None
    finally:
        run.kill()
        run.communicate()
    return folder, told


def test_a_live_run_is_measured_and_said_to_run(killed):
    _, told = killed
    print(told)
    assert told["status"] == "running"
    assert re.fullmatch(r"running at [\d.e+]+ ns; the last snapshot is of 0 ns", told["standing"])


def test_a_live_run_is_not_replaced_by_force(killed):
    folder, told = killed
    for force in (False, True):
        assert told[force].startswith(f"{folder}: process {told['pid']} on ")
        assert told[force].endswith("runs in it now")


def test_a_killed_run_reads_as_killed_and_is_measured_and_drawn(killed, tmp_path):
    folder = Path(shutil.copytree(killed[0], tmp_path / "run"))
    assert json.loads((folder / "manifest.json").read_text())["status"] == "running"
    result, last = measure(folder), RunFolder.open(folder).rows().last
    assert (result["run"]["status"], result["run"]["torn_rows"]) == ("killed", 0)
    assert (result["run"]["time"], result["run"]["steps"]) == (last["time"], last["step"])
    assert result["energy"]["kinetic"] == last["kinetic"] / last["initial"]
    assert result["counters"]["failed_points"] == last["failed_points"]
    with (folder / "history.csv").open("a") as file:
        file.write("1e-6,17,")
    torn = measure(folder)
    assert torn["run"].pop("torn_rows") == 1
    assert torn["run"] == {key: value for key, value in result["run"].items() if key != "torn_rows"}
    done = start("measure", folder)
    said, _ = done.communicate(timeout=60)
    said = " ".join(re.sub("[│┃|]", " ", said).split())
    assert f"killed at {last['time'] * 1e9:.4g} ns; the last snapshot is of 0 ns" in said
    assert "a torn last row of its history is left out" in said
    assert {path.name for path in plot_run(folder)} == {"crater.png", "fields.png", "top.png", "history.png"}
    assert standing_of(folder).startswith("killed at ")


def test_a_killed_run_with_a_torn_snapshot_is_measured_at_the_last_whole_one(killed, tmp_path):
    folder = Path(shutil.copytree(killed[0], tmp_path / "run"))
    whole = folder / "snapshot-0000.vtkhdf"
    (folder / "snapshot-0001.vtkhdf").write_bytes(whole.read_bytes()[:5000])
    assert measure(folder)["crater"]["time"] == 0.0


def test_the_lock_of_a_killed_run_blocks_nobody(killed, tmp_path):
    folder = Path(shutil.copytree(killed[0], tmp_path / "run"))
    assert (folder / "run.lock").exists()
    scene = Scene.load(QUICK, [*SMALL, "end_time='1 ns'"])
    run_scene(scene, folder, threads=1, force=True, progress=False, coarse=True)
    assert RunFolder.open(folder).status() == "finished"
    assert not (folder / "run.lock").exists()


def test_of_two_runs_at_once_one_wins(tmp_path, monkeypatch):
    """Both have found the folder empty before either writes to it."""
    meet, free = threading.Barrier(2), RunFolder.require_free

    def require_free(self, *, force):
        free(self, force=force)
        if not self._lock:
            meet.wait(10)

    monkeypatch.setattr(RunFolder, "require_free", require_free)
    scene, won, told = Scene.load(QUICK, SMALL), [], []

    def create():
        try:
            won.append(RunFolder.create(tmp_path / "run", scene))
        except PockmarkError as error:
            told.append(str(error))

    both = [threading.Thread(target=create) for _ in range(2)]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    print(told)
    assert (len(won), len(told)) == (1, 1)
    assert f"process {os.getpid()} on " in told[0]
    won[0].release()
    with pytest.raises(PockmarkError, match="holds a run"):
        free(won[0], force=False)


def test_a_hangup_is_ignored_where_it_was(tmp_path):
    """As under nohup."""
    folder = tmp_path / "run"
    run = start_run(folder, hangup=signal.SIG_IGN)
    wait_until(lambda: rows(folder) > 2)
    run.send_signal(signal.SIGHUP)
    seen = rows(folder)
    wait_until(lambda: rows(folder) > seen + 2)
    run.terminate()
    run.communicate(timeout=60)
    assert run.returncode == 130


CAMPAIGN = f"""
scene = "quick.toml"
coarse = true
set = {{ {", ".join(f'"{key}" = {value}' for key, _, value in (change.partition("=") for change in LONG))} }}

[[group]]
name = "speeds"
sweep = {{ "impact.speed" = ["1 km/s", "2 km/s", "3 km/s"] }}
"""


@pytest.fixture
def campaign(tmp_path):
    """Three runs that take minutes each."""
    shutil.copy(QUICK, tmp_path)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    return tmp_path


def workers(out):
    """The processes that have a lock in one of the runs' folders."""
    notes = [path.read_text() for path in out.glob("*/run.lock")]
    return [int(found[1]) for note in notes if (found := re.match(r"process (\d+) on ", note))]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_study_that_ends_leaves_no_worker_behind(number, campaign):
    out = campaign / "runs"
    study = start("study", campaign, "-o", out, "--jobs", 2)
    try:
        wait_until(lambda: len(workers(out)) == 2 and all(rows(path) > 0 for path in out.iterdir()))
        found = workers(out)
        study.send_signal(number)
        said, errors = study.communicate(timeout=60)
    finally:
        study.kill()
    print(said, errors)
    wait_until(lambda: not any(map(lives, found)), 20)
    assert study.returncode == (-9 if number == signal.SIGKILL else 130)
    assert errors == ""
    if number != signal.SIGKILL:
        assert "interrupted: what is done is kept" in said
    stands = {RunFolder.open(path).status() for path in out.iterdir()}
    assert stands == {"killed" if number == signal.SIGKILL else "interrupted"}


def test_a_worker_that_is_killed_stops_no_other_run(campaign):
    text = (campaign / "campaign.toml").read_text().replace("1 ms", "2 us")
    (campaign / "campaign.toml").write_text(text)
    found, out = cases(load(campaign), campaign, quick=False, only=[]), campaign / "runs"
    first = place(out, found[0])

    def kill_the_first():
        wait_until(lambda: RunFolder(first).is_run())
        os.kill(workers(out)[0], signal.SIGKILL)

    killer = threading.Thread(target=kill_the_first)
    killer.start()
    outcomes = run_study(found, out, pool=Processes(1), console=Console(file=io.StringIO()), coarse=True)
    killer.join()
    print([outcome.fault for outcome in outcomes])
    assert [bool(outcome.fault) for outcome in outcomes] == [True, False, False]
    assert outcomes[0].fault == "its process was ended by SIGKILL (out of memory?)"
    assert RunFolder.open(first).status() == "killed"
