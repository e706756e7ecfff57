"""A pool of dask workers, on this machine or on others, which share a file system with it.

This is the study's side; the worker's is `follow`. A run whose worker is lost goes on elsewhere.
"""

import logging
import re
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError, found
from ..base.files import make_folder, told
from ..run.keeper import checkpoints
from ..run.lock import Lock
from .follow import Answer, follow
from .order import Order
from .pace import PACE, every
from .processes import PATIENCE, POLL

CONNECT = 5.0  # s that a scheduler has to answer
ADDRESS = re.compile(r"(tcp|tls|wss?)://[^\s/]+:[0-9]{1,5}")
LOST = "the scheduler is lost: what is done is kept, the same command goes on"


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
        # Of each future the order's number, and the newest checkpoint when it was sent.
        self._sent: dict[Any, tuple[int, Path | None]] = {}
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
            raise PockmarkError(LOST)
        try:
            self._count_room()
        except OSError:  # the client has not seen it yet
            raise PockmarkError(LOST) from None
        while self._waiting and len(self._sent) < self._room:
            n = self._waiting.pop()
            order = self._orders[n]
            newest = _newest(order)
            future = self._client.submit(follow, order, str(study), self._threads, pure=False)
            self._sent[future] = n, newest

    def _over(self) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) of the runs that are over now."""
        for future in [future for future in self._sent if future.done()]:
            answer = _answer(future)
            if answer is None:
                continue
            n, began = self._sent.pop(future)
            if "lost" in answer and _newest(self._orders[n]) != began:
                self._waiting.append(n)  # it has gone on since it was sent, so it will end
            else:
                yield n, answer["fault"]

    def _end(self) -> None:
        """Wait for the workers to keep what there is: they see that the study's lock is gone."""
        with suppress(OSError):  # the scheduler may be gone
            busy = {key for keys in self._client.processing().values() for key in keys}
            running = [future for future in self._sent if future.key in busy]
            self._client.cancel([future for future in self._sent if future not in running])
            deadline = time.monotonic() + PATIENCE
            while time.monotonic() < deadline and not all(future.done() for future in running):
                time.sleep(POLL)


def _answer(future: Any) -> Answer | None:
    """Return the answer of a worker, None if it is to be had later. Raises PockmarkError for one that can do nothing."""
    distributed = dask("distributed")
    try:
        answer: Answer = future.result(timeout=CONNECT)
    except TimeoutError:  # its worker was lost with it: the scheduler asks another one
        return None
    except (CancelledError, OSError):  # not by us: its scheduler has been started anew, or does not answer
        raise PockmarkError(LOST) from None
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


@contextmanager
def _study_lock(runs: Path) -> Iterator[Path]:
    """Give a folder among the runs, with a lock that is held while the study goes on."""
    make_folder(runs)
    with told(runs):
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
    if not ADDRESS.fullmatch(address):  # dask would leave half a client behind
        raise PockmarkError(f"--scheduler: {found(address)}, expected an address such as tcp://node1:8786")
    if address.startswith(("tls", "wss")) and not _has_certificate():
        raise PockmarkError(
            f"--scheduler: {address} needs a certificate, of which dask's own configuration (distributed.comm.tls) has none"
        )
    with client_of(
        address, f"--scheduler: no dask scheduler answers at {address} within {CONNECT:g} s"
    ) as client:
        yield Cluster(client)


def _has_certificate() -> bool:
    """Return whether dask is set up for TLS. Raises PockmarkError without dask."""
    arguments = dask("distributed").Security().get_connection_args("client")
    return arguments.get("ssl_context") is not None


@contextmanager
def client_of(address: Any, fault: str) -> Iterator[Any]:
    """Give a client of a scheduler, by its address or as dask has it. Raises PockmarkError with `fault`."""
    distributed = dask("distributed")
    for name in ("distributed", "distributed.client"):  # what they would say, a sentence of ours says
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = distributed.Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, ValueError):
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
