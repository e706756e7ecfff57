"""Ctrl-C, SIGTERM and SIGHUP: what was computed is kept, whenever they come."""

import signal
import subprocess
import sys
import time

import pytest
from processes import QUICK, short_run

from pockmark import Scene, measure
from pockmark.run.pipeline import run_scene
from pockmark.run.stop import heard_between_steps
from pockmark.run.store import RunFolder


def _hear_stops():
    """In a process that is started: where tests run in the background or under nohup, they may be ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def _python_that_hears_ctrl_c(code, *arguments):
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=_hear_stops,
    )


@pytest.mark.parametrize(
    "signals", [[signal.SIGINT], [signal.SIGTERM], [signal.SIGHUP], [signal.SIGINT] * 3], ids=str
)
def test_a_signal_stops_the_run_and_keeps_what_there_is(signals, tmp_path):
    folder = tmp_path / "run"
    run = short_run(
        folder,
        "--set",
        "end_time='10 us'",
        preexec_fn=_hear_stops,
    )
    deadline = time.monotonic() + 60
    while not list(folder.glob("snapshot-0001.vtkhdf")) and time.monotonic() < deadline:
        time.sleep(0.1)
    for number in signals:
        run.send_signal(number)
        time.sleep(0.01)
    out, said = run.communicate(timeout=60)
    print(out, said)
    assert run.returncode == 130
    assert said == ""
    assert RunFolder.open(folder).manifest()["status"] == "interrupted"
    assert 0 < measure(folder)["run"]["time"] < 10e-6


PRESSES_CTRL_C_ALL_THE_WAY = """
import os, signal
from pockmark.run import simulation
from pockmark.cli import ending as cli
from pockmark.__main__ import main
def interrupting(name):
    function = getattr(cli, name)
    def interrupt(*args, **kwargs):
        os.kill(os.getpid(), signal.SIGINT)
        return function(*args, **kwargs)
    setattr(cli, name, interrupt)
interrupting("measure_run")
interrupting("plot_run")
run = simulation.Simulation.run
def interrupt(self, tasks, watch, **more):
    def watch_and_interrupt(simulation):
        if simulation.steps > 4:
            os.kill(os.getpid(), signal.SIGINT)
        watch(simulation)
    run(self, tasks, watch=watch_and_interrupt, **more)
simulation.Simulation.run = interrupt
main()
"""


def test_ctrl_c_while_an_interrupted_run_is_measured_and_drawn_loses_nothing(tmp_path):
    folder = tmp_path / "run"
    run = _python_that_hears_ctrl_c(PRESSES_CTRL_C_ALL_THE_WAY, "run", QUICK, "-o", folder, "--quiet")
    assert run.stderr == ""
    assert run.returncode == 130
    assert "interrupted: what was computed is kept" in run.stdout
    assert {"crater.png", "history.png"} <= {p.name for p in folder.iterdir()}


PRESSES_CTRL_C_WHILE_THE_POINTS_ARE_LAID = """
import os, signal
from pockmark.run import pipeline as run
from pockmark.__main__ import main
made = run.Simulation
def interrupt(*args):
    os.kill(os.getpid(), signal.SIGINT)
    return made(*args)
run.Simulation = interrupt
main()
"""


def test_ctrl_c_before_the_first_step_keeps_the_run_that_force_would_replace(tmp_path):
    kept, _ = run_scene(Scene.load(QUICK, ["end_time='4 ns'"]), tmp_path / "run", threads=1, progress=False)
    run = _python_that_hears_ctrl_c(
        PRESSES_CTRL_C_WHILE_THE_POINTS_ARE_LAID, "run", QUICK, "-o", kept.path, "--force", "--quiet"
    )
    assert (run.returncode, run.stderr) == (130, "")
    assert kept.manifest()["status"] == "finished"


def test_sigterm_before_the_first_step_is_heard_where_ctrl_c_is_ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as under nohup
    try:
        with heard_between_steps():
            signal.raise_signal(signal.SIGTERM)
            with heard_between_steps() as stop_if_asked, pytest.raises(KeyboardInterrupt):
                stop_if_asked()
    finally:
        signal.signal(signal.SIGINT, before)


PRESSES_CTRL_C_WHILE_NUMPY_IS_IMPORTED = """
import os, signal, sys
class Finder:
    def find_spec(self, name, *rest):
        if name == "numpy":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Finder())
from pockmark.__main__ import main
main()
"""


def test_ctrl_c_during_the_imports_says_nothing():
    run = _python_that_hears_ctrl_c(PRESSES_CTRL_C_WHILE_NUMPY_IS_IMPORTED)
    assert run.returncode == -signal.SIGINT
    assert run.stderr == ""
