"""Workers that are jobs of Slurm's: the table `[slurm]` of a campaign, and the jobs."""

import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from ..base.errors import PockmarkError, found
from ..base.files import told
from ..scene.model import Model
from .cluster import Cluster, client_of, dask


def _walltime(text: str) -> str:
    """Return a walltime. Raises ValueError for what Slurm would not understand."""
    if not re.fullmatch(r"(\d{1,3}-)?\d{1,3}:[0-5]\d:[0-5]\d", text):
        raise ValueError(f"{found(text)}, expected hours, minutes and seconds such as '12:00:00'")
    return text


def _memory(text: str) -> str:
    """Return a size of memory. Raises ValueError for what dask and Slurm would not understand."""
    if not re.fullmatch(r"[1-9]\d{0,6} ?(MB|GB|TB)", text):
        raise ValueError(f"{found(text)}, expected a whole number of MB, GB or TB such as '16 GB'")
    return text


def _queue(text: str) -> str:
    """Return the name of a queue. Raises ValueError for what would be more than one word of a script."""
    if not re.fullmatch(r"[\w.,+-]{1,100}", text):
        raise ValueError(f"{found(text)}, expected the name of a queue (Slurm's partition)")
    return text


class Slurm(Model):
    """What each job asks for. A job is a worker: it makes one run at a time, on all its cores."""

    queue: Annotated[str, AfterValidator(_queue)]
    walltime: Annotated[str, AfterValidator(_walltime)]
    cores: Annotated[int, Field(strict=True, ge=1, le=1024)]
    memory: Annotated[str, AfterValidator(_memory)]


@contextmanager
def started(slurm: Slurm, jobs: int, logs: Path) -> Iterator[Cluster]:
    """Give the pool of so many jobs, which end with it. They write what they say into the folder `logs`.

    Raises PockmarkError where Slurm or dask is missing.
    """
    dask("dask_jobqueue")
    if shutil.which("sbatch") is None:
        raise PockmarkError(
            "--slurm: there is no sbatch here: start the study on a machine that submits to Slurm"
        )
    with told(logs), batch_of(slurm, logs) as batch:
        batch.adapt(
            minimum_jobs=jobs, maximum_jobs=jobs
        )  # in place of one whose walltime is over, another one
        with client_of(batch, "--slurm: the scheduler of the study's jobs does not answer") as client:
            yield Cluster(client, slurm.cores)


def batch_of(slurm: Slurm, logs: Path) -> Any:
    """Return dask's scheduler for jobs of Slurm's, none of which is submitted yet.

    What else a site wants (account, network) stands in dask's own jobqueue.yaml.
    """
    return dask("dask_jobqueue").SLURMCluster(
        queue=slurm.queue,
        walltime=slurm.walltime,
        memory=slurm.memory,
        cores=1,  # dask's are runs at a time
        processes=1,
        job_cpu=slurm.cores,
        log_directory=str(logs.absolute()),
    )
