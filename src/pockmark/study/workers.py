"""Work in processes of its own, a few at a time.

A process that dies takes nothing with it. None outlives the process that asked for it.
"""

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

POLL = 0.2  # s between questions whether to stop
PATIENCE = 60.0  # s that a worker has to keep what there is before it is killed


def run_apart(
    work: Callable[..., str], orders: Sequence[tuple[Any, ...]], jobs: int, stop_if_asked: Callable[[], None]
) -> Iterator[tuple[int, str]]:
    """Give (n, work(*orders[n])) as the orders are done, `jobs` at a time.

    For a process that died the text says why. What `stop_if_asked` raises comes through when every worker has ended.
    """
    waiting = list(enumerate(orders))[::-1]
    running: dict[int, tuple[SpawnProcess, Connection]] = {}
    try:
        while waiting or running:
            stop_if_asked()
            while waiting and len(running) < jobs:
                n, order = waiting.pop()
                running[n] = _start(work, order)
            wait([process.sentinel for process, _ in running.values()], POLL)
            for n in [n for n, (process, _) in running.items() if not process.is_alive()]:
                yield n, _answer(*running.pop(n))
    finally:
        _end([process for process, _ in running.values()])


def _start(work: Callable[..., str], order: tuple[Any, ...]) -> tuple[SpawnProcess, Connection]:
    # Not forked: a process with threads of OpenMP must not be.
    """Start a process that works on an order. Return it, and where its answer comes out."""
    context = get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(sender, work, order))
    # Ctrl-C in a terminal reaches every process of it: the workers leave it to this one, from their first moment on.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    sender.close()
    return process, receiver


def _work(sender: Connection, work: Callable[..., str], order: tuple[Any, ...]) -> None:
    """Do the work in its own process, and send the answer."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    sender.send(work(*order))


def _end_with_parent() -> None:
    """Wait for the process that asked to end, however that happens, and end this one with it."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _answer(process: SpawnProcess, receiver: Connection) -> str:
    """Return what a process that has ended has sent, or why it has sent nothing."""
    process.join()
    try:
        return str(receiver.recv()) if receiver.poll() else _fate(process.exitcode or 0)
    except EOFError:
        return _fate(process.exitcode or 0)
    finally:
        receiver.close()


def _fate(code: int) -> str:
    """Return why a process ended without an answer, from its exit code."""
    if code >= 0:
        return f"its process failed with exit code {code}"
    name = signal.Signals(-code).name
    return f"its process was ended by {name}" + (" (out of memory?)" if name == "SIGKILL" else "")


def _end(processes: Sequence[SpawnProcess]) -> None:
    """Ask workers to stop, and kill those that do not stop in time."""
    for process in processes:
        process.terminate()
    deadline = time.monotonic() + PATIENCE
    for process in processes:
        process.join(max(0.0, deadline - time.monotonic()))
        if process.is_alive():
            process.kill()
            process.join()
