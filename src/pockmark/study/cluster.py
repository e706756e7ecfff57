"""A pool of dask workers, on this machine or on others, which share a file system with it.

A worker makes a run as `--jobs 1` does, in a process of its own, and writes into the same folder. A run whose worker is
lost goes on elsewhere. The scheduler and the workers import this, too.
"""

import logging
import platform
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError
from ..base.files import told
from ..run.keeper import checkpoints
from ..run.lock import Lock, holder
from ..run.simulation import thread_count
from .order import INTERRUPTED, Order, RefusedError
from .progress import every
from .workers import PATIENCE, POLL, run_apart

CONNECT = 8.0  # s that a scheduler has to answer
PACE = 1.0  # s between questions to the scheduler or to the file system
# Of a run that is over: "fault": why it failed, or an empty text; with "lost" if only its worker is at fault. Else
# "refused": why no run of the campaign can be made there.
Answer = dict[str, str]


class Cluster:
    """A pool of the workers that a dask scheduler has, or will have."""

    def __init__(self, client: Any, threads: int = 0) -> None:
        """Keep a connected client. A run takes so many threads; 0: its share of its worker's cores."""
        self._client, self._threads = client, threads

    @property
    def workers(self) -> int:
        """Return how many workers there are now."""
        return len(self._client.nthreads())

    def finished(self, orders: Sequence[Order], between: Callable[[], None]) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) for each order n, as the runs are over.

        Raises PockmarkError where a worker is of another pockmark or sees other files, and where the scheduler is lost.
        """
        if orders:
            yield from _Followed(self._client, self._threads, orders).finished(between)


class _Followed:
    """Orders that workers follow: as many at a time as the workers have threads, so that none waits behind another."""

    def __init__(self, client: Any, threads: int, orders: Sequence[Order]) -> None:
        """Let all orders wait."""
        self._client, self._threads, self._orders = client, threads, orders
        self._waiting = [*range(len(orders))][::-1]
        self._sent: dict[
            Any, tuple[int, Path | None]
        ] = {}  # future: the order's number, its run's checkpoint then
        self._room = 0
        self._count_room = every(PACE, self._ask_for_room)

    def finished(self, between: Callable[[], None]) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) as the runs are over."""
        try:
            with _study_lock(Path(self._orders[0]["folder"]).parent) as study:
                while self._waiting or self._sent:
                    between()
                    self._send(study)
                    time.sleep(POLL)
                    yield from self._over()
        finally:
            self._end()

    def _ask_for_room(self) -> None:
        """Ask the scheduler how many runs its workers take at a time."""
        self._room = sum(self._client.nthreads().values())

    def _send(self, study: Path) -> None:
        """Send orders that wait to the scheduler, as far as there is room. Raises PockmarkError if it is lost."""
        if self._client.status != "running":
            raise PockmarkError("the scheduler is lost: what is done is kept, the same command goes on")
        self._count_room()
        while self._waiting and len(self._sent) < self._room:
            n = self._waiting.pop()
            order = self._orders[n]
            future = self._client.submit(follow, order, str(study), self._threads, pure=False)
            self._sent[future] = n, _newest(order)

    def _over(self) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) of the runs that are over now."""
        for future in [future for future in self._sent if future.done()]:
            answer = _answer(future)
            if answer is None:
                continue
            n, began = self._sent.pop(future)
            if "lost" in answer and _newest(self._orders[n]) != began:
                self._waiting.append(n)  # it has gone on with each of the lost workers, so it will end
            else:
                yield n, answer["fault"]

    def _end(self) -> None:
        """Wait for the workers to keep what there is: they see that the study's lock is gone."""
        with suppress(OSError, TimeoutError):  # the scheduler may be gone
            busy = {key for keys in self._client.processing().values() for key in keys}
            running = [future for future in self._sent if future.key in busy]
            self._client.cancel([future for future in self._sent if future not in running])
            deadline = time.monotonic() + PATIENCE
            while time.monotonic() < deadline and not all(future.done() for future in running):
                time.sleep(POLL)


def _answer(future: Any) -> Answer | None:
    """Return the answer of a worker, None if it is to be had later. Raises PockmarkError for one that can do nothing."""
    distributed = dask("distributed")
    if future.cancelled():
        return None  # the scheduler is lost: _send says so
    try:
        answer: Answer = future.result(timeout=CONNECT)
    except TimeoutError:  # its worker was lost with it: the scheduler asks another one
        return None
    except distributed.KilledWorker as error:
        last, times = error.last_worker.address, error.allowed_failures + 1
        lost = f"{times} workers were lost with it, {last} the last (out of memory?)"
        return {"fault": lost, "lost": ""}
    except Exception as error:  # a worker or the scheduler could not even read the order
        raise PockmarkError(
            f"a worker cannot take a run, for it needs pockmark {__version__} of physics {PHYSICS} ({error})"
        ) from None
    if refused := answer.get("refused"):
        raise PockmarkError(refused)
    return answer


def follow(order: Order, study: str, threads: int) -> Answer:
    """Follow an order in a dask worker, as long as the study's lock is held, and return what came of it.

    `threads` 0 is the share of a run in the cores of the worker.
    """
    worker = dask("distributed").get_worker()
    name = f"worker {worker.address} on {platform.node()}"
    threads = threads or max(1, thread_count(0) // worker.state.nthreads)
    try:
        if why := why_not_shared(Path(study)):
            return {"refused": f"{name}: {why}"}
        fault = _make(order, Path(study), threads)
    except RefusedError as error:
        return {"refused": f"{name}: {error}"}
    except PockmarkError as error:
        return {"fault": str(error)}
    except KeyboardInterrupt:
        return {"fault": INTERRUPTED}
    # Not by us: a batch system ends the worker, and with it the run.
    return {"fault": fault} | ({"lost": ""} if fault == INTERRUPTED else {})


def why_not_shared(study: Path) -> str:
    """Return why a worker cannot write into the study's folder of runs; empty if it can."""
    if not study.exists():
        return (
            f"does not see {study.parent}: the runs' folder must be on a file system that all workers share"
        )
    if holder(study) is None:
        return f"does not see who holds a lock in {study.parent}: that file system must keep locks between machines"
    return ""


def _make(order: Order, study: Path, threads: int) -> str:
    """Make a run in a process of its own. Return why it failed, or an empty text.

    Raises KeyboardInterrupt once the study's lock is held no more, however that happened.
    """

    def stop_if_over() -> None:
        if holder(study) is None:
            raise KeyboardInterrupt

    between = every(PACE, stop_if_over)
    while (
        holder(Path(order["folder"])) is not None
    ):  # by a worker that is lost to the scheduler, but still runs
        between()
        time.sleep(POLL)
    ((_, fault),) = run_apart([order], 1, threads, between)
    return fault


@contextmanager
def _study_lock(runs: Path) -> Iterator[Path]:
    """Give a folder among the runs, with a lock that is held while the study goes on."""
    with told(runs):
        runs.mkdir(parents=True, exist_ok=True)
        study = Path(tempfile.mkdtemp(prefix=".study-", dir=runs))
    lock = Lock(study)
    try:
        yield study
    finally:
        lock.release()
        with told(study):
            study.rmdir()


def _newest(order: Order) -> Path | None:
    """Return the newest checkpoint of an order's run, None if there is none."""
    folder = Path(order["folder"])
    return max(checkpoints(folder), default=None) if folder.is_dir() else None


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """Give the pool of a scheduler's workers. Raises PockmarkError if none answers at the address."""
    if "://" not in address:
        raise PockmarkError(f"--scheduler: found '{address}', expected an address such as tcp://node1:8786")
    with client_of(
        address, f"--scheduler: no dask scheduler answers at {address} within {CONNECT:g} s"
    ) as client:
        yield Cluster(client)


@contextmanager
def client_of(address: Any, fault: str) -> Iterator[Any]:
    """Give a client of a scheduler, by its address or as dask has it. Raises PockmarkError with `fault`."""
    distributed = dask("distributed")
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what it would say, a sentence of ours says
    try:
        client = distributed.Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError, TimeoutError):
        raise PockmarkError(fault) from None
    try:
        yield client
    finally:
        client.close()


def dask(module: str) -> ModuleType:
    """Return a module of dask's. Raises PockmarkError if it is not installed."""
    try:
        return import_module(module)
    except ImportError:
        raise PockmarkError(
            "--scheduler and --slurm need dask, which is not here: pip install 'pockmark[cluster]'"
        ) from None
