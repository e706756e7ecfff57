"""Where the runs of a campaign are made: the options of `pockmark study` for it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..base.errors import PockmarkError
from ..study.cluster import connected
from ..study.pool import Pool
from ..study.processes import Processes
from ..study.slurm import Slurm, started
from .common import CONSOLE


@contextmanager
def pool_of(jobs: int | None, scheduler: str | None, slurm: Slurm | None, logs: Path) -> Iterator[Pool]:
    """Give the pool that the options ask for: processes, without a scheduler and without Slurm's table.

    Slurm's jobs write their `logs` into a folder. Raises PockmarkError for options that exclude each other.
    """
    if scheduler is not None and slurm:
        raise PockmarkError("--slurm: starts a scheduler of its own, --scheduler excludes it")
    if scheduler is not None and jobs is not None:
        raise PockmarkError("--jobs: --scheduler excludes it, for the scheduler has its workers already")
    if scheduler is not None:
        with connected(scheduler) as pool:
            waits = "" if pool.workers else ", runs wait for one"
            CONSOLE.print(f"the scheduler's workers: {pool.workers}{waits}")
            yield pool
    elif slurm:
        with started(slurm, jobs or 1, logs) as pool:
            CONSOLE.print(f"jobs that Slurm is asked for: {jobs or 1}, runs begin as they do")
            yield pool
    else:
        yield Processes(jobs or 1)
