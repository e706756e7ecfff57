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
PATIENCE = 60.0  # s that a worker has to keep what there is before it is killed
Worker = subprocess.Popen[bytes]


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

    For a process that died the text says why. What `between` raises comes through when every worker has ended, and so
    does the RefusedError of a process that is of another pockmark.
    """
    waiting = list(enumerate(orders))[::-1]
    running: dict[int, Worker] = {}
    try:
        while waiting or running:
            between()
            while waiting and len(running) < jobs:
                n, order = waiting.pop()
                running[n] = _start(order, threads)
            over = wait([_answers(worker).fileno() for worker in running.values()], POLL)
            for n in [n for n, worker in running.items() if _answers(worker).fileno() in over]:
                yield n, _answer(running.pop(n))
    finally:
        _end([*running.values()])


def _answers(worker: Worker) -> IO[bytes]:
    """Return where the answer of a worker comes out."""
    assert worker.stdout
    return worker.stdout


def _start(order: Order, threads: int) -> Worker:
    """Start a process that makes a run."""
    # The modules that this process finds, and no others: a file beside the user that is called json.py is none of them.
    found = os.pathsep.join(path or os.getcwd() for path in sys.path)
    # Ctrl-C in a terminal reaches every process of it: the workers leave it to this one, from their first moment on.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        worker = subprocess.Popen(
            [sys.executable, "-P", "-m", "pockmark.study.making", str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": found},
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    assert worker.stdin
    with suppress(BrokenPipeError):  # its answer says what has become of it
        worker.stdin.write(json.dumps(order).encode() + b"\n")
        worker.stdin.flush()  # it stays open: its end tells the worker that this process has ended
    return worker


def _answer(worker: Worker) -> str:
    """Return what a worker that has ended says of its run, or why it says nothing. Raises RefusedError."""
    said = _answers(worker).read()
    code = worker.wait()
    _close(worker)
    if not said:
        return _fate(code)
    answer: dict[str, str] = json.loads(said)
    if refused := answer.get("refused"):
        raise RefusedError(refused)
    return answer["fault"]


def _close(worker: Worker) -> None:
    """Close the pipes of a worker that has ended."""
    for pipe in (worker.stdin, worker.stdout):
        with suppress(BrokenPipeError):
            assert pipe
            pipe.close()


def _fate(code: int) -> str:
    """Return why a process ended without an answer, from its exit code."""
    if code >= 0:
        return f"its process failed with exit code {code}"
    name = signal.Signals(-code).name
    return f"its process was ended by {name}" + (" (out of memory?)" if name == "SIGKILL" else "")


def _end(workers: Sequence[Worker]) -> None:
    """Ask workers to stop, and kill those that do not stop in time."""
    for worker in workers:
        worker.terminate()
    deadline = time.monotonic() + PATIENCE
    for worker in workers:
        try:
            worker.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            worker.kill()
            worker.wait()
        _close(worker)
