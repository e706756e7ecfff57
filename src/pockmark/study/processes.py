"""Runs in processes of their own, a few at a time.

A process that dies takes nothing with it. None outlives the process that asked for it.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import wait
from typing import IO

from .order import Order, RefusedError

POLL = 0.2  # s between questions whether to stop
PATIENCE = 60.0  # s that a process has to keep what there is before it is killed
Process = subprocess.Popen[bytes]


class Processes:
    """A pool of this machine's: so many runs at a time, which share the cores."""

    def __init__(self, jobs: int) -> None:
        """Keep how many runs there are at a time."""
        self._jobs = jobs

    def finished(self, orders: Sequence[Order], between: Callable[[], None]) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) for each order n, as the runs are over."""
        return run_apart(orders, self._jobs, share_of_cores(self._jobs), between)


def share_of_cores(runs: int) -> int:
    """Return how many threads each of so many runs at a time takes of the cores that this process may use."""
    return max(1, len(os.sched_getaffinity(0)) // runs)


def run_apart(
    orders: Sequence[Order], jobs: int, threads: int, between: Callable[[], None]
) -> Iterator[tuple[int, str]]:
    """Give (n, why it failed) as the runs of orders are over, `jobs` at a time, on so many threads each.

    For a process that died the text says why. What `between` raises comes through when every process has ended, and so
    does the RefusedError of a process that is of another pockmark.
    """
    waiting = list(enumerate(orders))[::-1]
    running: dict[int, Process] = {}
    try:
        while waiting or running:
            between()
            while waiting and len(running) < jobs:
                n, order = waiting.pop()
                running[n] = _start(order, threads)
            over = wait([_answers(process).fileno() for process in running.values()], POLL)
            for n in [n for n, process in running.items() if _answers(process).fileno() in over]:
                yield n, _answer(running.pop(n))
    finally:
        _end([*running.values()])


def _answers(process: Process) -> IO[bytes]:
    """Return where the answer of a process comes out."""
    assert process.stdout
    return process.stdout


def _start(order: Order, threads: int) -> Process:
    """Start a process that makes a run."""
    # It finds the modules that this process finds, and no others: not a json.py where the user stands.
    found = os.pathsep.join(path or os.getcwd() for path in sys.path)
    # Ctrl-C in a terminal reaches every process of it: those started here leave it to this one, from their first moment.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "pockmark.study.making", str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": found},
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    assert process.stdin
    with suppress(BrokenPipeError):  # its answer says what has become of it
        process.stdin.write(json.dumps(order).encode() + b"\n")
        process.stdin.flush()  # it stays open: its end says that this process has ended
    return process


def _answer(process: Process) -> str:
    """Return what a process that has ended says of its run, or why it says nothing. Raises RefusedError."""
    said = _answers(process).read()
    code = process.wait()
    _close(process)
    if not said:
        return _fate(code)
    answer: dict[str, str] = json.loads(said)
    if refused := answer.get("refused"):
        raise RefusedError(refused)
    return answer["fault"]


def _close(process: Process) -> None:
    """Close the pipes of a process that has ended."""
    for pipe in (process.stdin, process.stdout):
        with suppress(BrokenPipeError):
            assert pipe
            pipe.close()


def _fate(code: int) -> str:
    """Return why a process ended without an answer, from its exit code."""
    if code >= 0:
        return f"its process failed with exit code {code}"
    name = signal.Signals(-code).name
    return f"its process was ended by {name}" + (" (out of memory?)" if name == "SIGKILL" else "")


def _end(processes: Sequence[Process]) -> None:
    """Ask processes to stop, and kill those that do not stop in time."""
    for process in processes:
        process.terminate()
    deadline = time.monotonic() + PATIENCE
    for process in processes:
        try:
            process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        _close(process)
