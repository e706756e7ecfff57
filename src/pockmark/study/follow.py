"""An order followed by a dask worker: as `--jobs 1` does it, in a process of its own.

The worker itself goes on to answer the scheduler, and imports nothing that makes a run. So does the scheduler.
"""

import os
import platform
import time
from importlib import import_module
from pathlib import Path

from ..base.errors import PockmarkError
from ..run.lock import holder
from .order import INTERRUPTED, Order, RefusedError
from .pace import PACE, every
from .processes import POLL, run_apart, share_of_cores

# Of a run that is over: "fault": why it failed, or an empty text; with "lost" if only its worker is at fault. Else
# "refused": why no run of the campaign can be made there.
Answer = dict[str, str]


def follow(order: Order, study: str, threads: int) -> Answer:
    """Follow an order in a dask worker, as long as the study's lock is held, and return what came of it.

    `threads` 0 is the share of a run in the cores of the worker.
    """
    worker = import_module("distributed").get_worker()
    name = f"worker {worker.address} on {platform.node()}"
    threads = threads or share_of_cores(worker.state.nthreads)
    try:
        if why := why_not_shared(Path(study)):
            return {"refused": f"{name}: {why}"}
        fault = _make(order, Path(study), threads)
    except RefusedError as error:
        return {"refused": f"{name}: {error}"}
    except (PockmarkError, OSError) as error:
        return {"fault": f"{name}: {error}"}
    except KeyboardInterrupt:
        return {"fault": INTERRUPTED}
    # Not by us: a batch system ends the worker, and with it the run.
    return {"fault": fault} | ({"lost": ""} if fault == INTERRUPTED else {})


def why_not_shared(study: Path) -> str:
    """Return why a worker cannot write into the study's folder of runs; empty if it can."""
    if not os.path.lexists(study):
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
    # The worker that had the run may be lost to the scheduler, and go on nevertheless.
    while holder(Path(order["folder"])) is not None:
        between()
        time.sleep(POLL)
    ((_, fault),) = run_apart([order], 1, threads, between)
    return fault
