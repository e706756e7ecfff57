"""Campaigns whose runs are made by dask workers: nothing is lost, nothing is run twice, a mistake is one sentence."""

import io
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import distributed
import pytest
from crew import Crew
from kills import differences
from rich.console import Console
from rings import small_rings

import pockmark
from pockmark import PHYSICS, PockmarkError, __version__
from pockmark.run.keeper import newest_good
from pockmark.run.lock import Lock, holder
from pockmark.run.store import RunFolder
from pockmark.study import cluster, follow
from pockmark.study.campaign import cases, load
from pockmark.study.cluster import CONNECT, connected
from pockmark.study.follow import why_not_shared
from pockmark.study.making import make
from pockmark.study.order import RefusedError, order_for
from pockmark.study.processes import Processes
from pockmark.study.runner import place, run_study

CAMPAIGN = """
scene = "rings.toml"
coarse = true
set = { end_time = "END", "output.checkpoints" = "1 ms" }

[[group]]
name = "speeds"
sweep = { "impact.speed" = ["2 km/s", "3 km/s", "4 km/s"] }
"""


@pytest.fixture(scope="module")
def crew(tmp_path_factory):
    """Three workers."""
    crew = Crew(tmp_path_factory.mktemp("crew"))
    try:
        for name in ("one", "two", "three"):
            crew.add(name)
        yield crew
    finally:
        crew.end()


def campaign(folder, end):
    """Write a campaign of rings there, and return its cases."""
    small_rings("4 ns").save(folder / "rings.toml")
    (folder / "campaign.toml").write_text(CAMPAIGN.replace("END", end))
    return cases(load(folder), folder, quick=False, only=[])


def study(folder, *words):
    """Start `pockmark study . WORDS` in a folder, with relative paths, so that it hears Ctrl-C."""
    return subprocess.Popen(
        [sys.executable, "-m", "pockmark", "study", ".", *map(str, words)],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def ended(process, seconds=150):
    """Return the exit code of a command, what it printed, and its mistakes."""
    try:
        said, mistakes = process.communicate(timeout=seconds)
    finally:
        process.kill()
    print(said, mistakes)
    return process.returncode, said, mistakes


def soon(true, seconds=120.0):
    """Wait for something to become true, and return it."""
    deadline = time.monotonic() + seconds
    while not (found := true()):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return found


def runner_of(folder):
    """Return the number of the process that runs in a folder, 0 if none does."""
    found = re.match(r"process (\d+) on ", holder(folder) or "")
    return int(found[1]) if found else 0


def worker_over(pid):
    """Return the number of the process that started another one."""
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def test_of_a_killed_worker_nothing_is_lost_and_nothing_runs_twice(crew, tmp_path):
    found, out = campaign(tmp_path, "24 ns"), tmp_path / "runs"
    first = place(out, found[0])
    process = study(tmp_path, "-o", "runs", "--scheduler", crew.address)
    try:
        soon(lambda: runner_of(first) and len(list(first.glob("checkpoint-*.h5"))) == 2)
        kept = newest_good(first, found[0].scene.course)[0]
        killed = worker_over(runner_of(first))
        assert killed in {worker.pid for worker in crew.workers.values()}
        os.kill(killed, signal.SIGKILL)
        assert RunFolder(first).manifest()["status"] == "running"  # it was killed in the midst of the run
    finally:
        code, said, mistakes = ended(process)
    assert (code in (0, 3), mistakes) == (True, "")
    assert "the scheduler's workers: 3" in said

    run_study(found, tmp_path / "plain", pool=Processes(1), console=Console(file=io.StringIO()), coarse=True)
    for case in found:
        assert differences(place(tmp_path / "plain", case), place(out, case)) == []
    resumed = [RunFolder(place(out, case)).manifest().get("resumed", []) for case in found]
    print(f"killed after step {kept.step}, resumed: {resumed}")
    assert [len(times) for times in resumed] == [1, 0, 0]
    assert resumed[0][0]["step"] >= kept.step > 0
    assert len(crew.starts.read_text().splitlines()) == len(found) + 1  # the killed one's second half
    assert {path.name for path in out.iterdir()} == {case.scene.hash for case in found}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_study_that_ends_leaves_no_run_behind(number, crew, tmp_path):
    """Of Ctrl-C, the runs have kept what they had when the command is over. After a kill, they do so by themselves."""
    folders = [place(tmp_path / "runs", case) for case in campaign(tmp_path, "1 ms")]
    process = study(tmp_path, "-o", "runs", "--scheduler", crew.address)
    try:
        soon(lambda: sum(runner_of(folder) > 0 for folder in folders) == 2)
        process.send_signal(number)
    finally:
        code, said, mistakes = ended(process)
    begun = [folder for folder in folders if folder.exists()]
    assert (code, mistakes) == (130 if number == signal.SIGINT else -9, "")
    if number == signal.SIGKILL:
        soon(lambda: not any(map(runner_of, begun)))
    else:
        assert "interrupted: what is done is kept" in said
    assert {RunFolder(folder).status() for folder in begun} == {"interrupted"}


def other_physics(folder):
    """Write a pockmark there that counts one more change of the physics, and is as this one in all else."""
    ours, other = Path(pockmark.__file__).parent, folder / "pockmark"
    other.mkdir()
    for path in ours.iterdir():
        if path.name != "__init__.py":
            (other / path.name).symlink_to(path)
    libraries = ours.parent / "pockmark.libs"  # what a wheel brings: the cores look for it beside the package
    if libraries.exists():
        (folder / libraries.name).symlink_to(libraries)
    text = (ours / "__init__.py").read_text()
    (other / "__init__.py").write_text(text.replace(f"PHYSICS = {PHYSICS}", f"PHYSICS = {PHYSICS + 1}"))


def test_a_worker_of_another_physics_is_refused(tmp_path):
    campaign(tmp_path, "8 ns")
    other = tmp_path / "other"
    other.mkdir()
    other_physics(other)
    crew = Crew(other)
    try:
        address = crew.add("other", path=other)
        code, _, mistakes = ended(study(tmp_path, "-o", "runs", "--scheduler", crew.address))
    finally:
        crew.end()
    assert code == 2
    assert mistakes.startswith(f"pockmark: worker {address} on ")
    assert f"has pockmark {__version__} of physics {PHYSICS + 1}" in mistakes
    assert mistakes.endswith(f"this campaign needs {__version__} of physics {PHYSICS}\n")
    assert list((tmp_path / "runs").iterdir()) == []


def test_an_order_of_another_version_is_refused(tmp_path):
    order = order_for(small_rings("4 ns").to_dict(), tmp_path / "run", coarse=True)
    for change in ({"pockmark": "0.0.1"}, {"physics": PHYSICS - 1}):
        with pytest.raises(RefusedError, match="this campaign needs"):
            make(order | change, 1)
    assert not (tmp_path / "run").exists()


def test_a_worker_that_sees_other_files_or_no_locks_is_refused(tmp_path):
    folder = tmp_path / "study"
    assert "does not see" in why_not_shared(folder)
    assert "must be on a file system that all workers share" in why_not_shared(folder)
    folder.mkdir()
    lock = Lock(folder)
    assert why_not_shared(folder) == ""
    lock.release()
    assert "must keep locks between machines" in why_not_shared(folder)


def test_no_scheduler_is_told_within_ten_seconds():
    began = time.monotonic()
    with (
        pytest.raises(PockmarkError, match=r"no dask scheduler answers at tcp://127\.0\.0\.1:1 within 5 s"),
        connected("tcp://127.0.0.1:1"),
    ):
        pass
    seconds = time.monotonic() - began
    print(f"{seconds:.1f} s")
    assert CONNECT <= seconds < 10


@pytest.mark.parametrize(
    "address", ["", "node1", "8786", "tcp://node1", "tcp://:8786", "tcp://node1:port", "foo://node1:1"]
)
def test_what_is_no_address_is_told(address):
    with (
        pytest.raises(PockmarkError, match=f"found '{address}', expected an address such as tcp://"),
        connected(address),
    ):
        pass


def test_tls_without_a_certificate_is_told():
    with pytest.raises(PockmarkError, match="needs a certificate"), connected("tls://127.0.0.1:8786"):
        pass


def test_without_dask_a_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(
            PockmarkError, match=r"need dask, which is not here: pip install 'pockmark\[cluster\]'"
        ),
        connected("tcp://127.0.0.1:1"),
    ):
        pass


def test_what_is_finished_is_not_made_again(tmp_path):
    """A worker that is lost with its answer has left its run."""
    order = order_for(small_rings("4 ns").to_dict(), tmp_path / "run", coarse=True)
    assert make(order, 1) == ""
    made = (tmp_path / "run" / "manifest.json").read_bytes()
    assert make(order, 1) == ""
    assert (tmp_path / "run" / "manifest.json").read_bytes() == made


def test_a_worker_waits_for_one_that_is_lost_but_still_runs(tmp_path, monkeypatch):
    locks = []
    for name in ("study", "run"):
        (tmp_path / name).mkdir()
        locks.append(Lock(tmp_path / name))
    study, lost = locks
    began, order = [], order_for({}, tmp_path / "run", coarse=True)
    monkeypatch.setattr(follow, "run_apart", lambda *how: began.append(how) or [(0, "")])
    worker = threading.Thread(target=follow._make, args=(order, tmp_path / "study", 1))
    worker.start()
    time.sleep(3 * follow.POLL)
    assert began == []
    lost.release()
    worker.join(10)
    assert len(began) == 1
    study.release()
    again = Lock(tmp_path / "run")
    with pytest.raises(KeyboardInterrupt):  # once the study is over, nobody waits
        follow._make(order, tmp_path / "study", 1)
    again.release()


class Future:
    """What a worker has said already, or an error of dask's."""

    key = "run"

    def __init__(self, said):
        self.said = said

    def done(self):
        return True

    def result(self, timeout):
        if isinstance(self.said, Exception):
            raise self.said
        return self.said


class Client:
    """A client whose workers say one thing after another."""

    status = "running"

    def __init__(self, said):
        self.said, self.sent = iter(said), 0

    def submit(self, function, order, study, threads, pure):
        self.sent += 1
        return Future(next(self.said))

    def nthreads(self):
        return {"tcp://node1:1": 1}

    def processing(self):
        return {}

    def cancel(self, futures):
        pass


@pytest.mark.parametrize("how", ["killed", "interrupted"])
def test_a_run_that_goes_on_is_sent_again_however_many_workers_are_lost(how, tmp_path, monkeypatch):
    """A campaign whose jobs end by their walltime ends nevertheless; a run that kills its workers does not go round."""
    last = type("Worker", (), {"address": "tcp://node7:1"})()
    lost = distributed.KilledWorker("run", last, 3)
    if how == "interrupted":
        lost = {"fault": "interrupted", "lost": ""}
    order = order_for({}, tmp_path / "runs" / "run", coarse=True)
    steps = iter([0, 1, 1, 2, 2, 2])  # the newest checkpoint at each sending, and at each loss
    monkeypatch.setattr(cluster, "_newest", lambda order: next(steps))
    client = Client([lost] * 3)
    ((n, fault),) = cluster.Cluster(client).finished([order], lambda: None)
    print(fault)
    assert (n, client.sent) == (0, 3)
    expected = "4 workers were lost with it, tcp://node7:1 the last (out of memory?)"
    assert fault == ("interrupted" if how == "interrupted" else expected)


def gone():
    """What dask's client does where nobody answers."""
    raise OSError("closed")


@pytest.mark.parametrize("how", ["seen", "not seen yet", "started anew"])
def test_a_scheduler_that_is_lost_is_told(how, tmp_path, monkeypatch):
    client = Client([distributed.client.FutureCancelledError("run", "scheduler-restart")])
    if how == "seen":
        client.status = "connecting"
    elif how == "not seen yet":
        monkeypatch.setattr(client, "nthreads", gone)
    order = order_for({}, tmp_path / "runs" / "run", coarse=True)
    with pytest.raises(PockmarkError, match="the scheduler is lost: what is done is kept, the same command"):
        next(cluster.Cluster(client).finished([order], lambda: None))
    assert list((tmp_path / "runs").iterdir()) == []
