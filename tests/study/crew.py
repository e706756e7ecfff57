"""A real dask scheduler and its workers, in processes of their own on this machine, for the tests of this folder."""

import itertools
import os
import re
import subprocess
import sys
import time

SCHEDULER = "import sys; from distributed.cli.dask_scheduler import main; main(sys.argv[1:])"
WORKER = "import sys; from distributed.cli.dask_worker import main; main(sys.argv[1:])"
# What each Python of a worker does first.
COUNTS = """
import os, sys
if "pockmark.study.making" in sys.orig_argv:
    with open(os.environ["STARTS"], "a") as file:
        file.write("a run\\n")
"""


class Crew:
    """A scheduler, and workers that take one run at a time."""

    def __init__(self, logs):
        """Start the scheduler."""
        self.logs, self.workers, self._processes = logs, {}, []
        self._cores = itertools.cycle(sorted(os.sched_getaffinity(0)))
        (logs / "sitecustomize.py").write_text(COUNTS)
        log, self.scheduler = self._start("scheduler", SCHEDULER, "--host", "127.0.0.1", "--port", "0")
        self.address = told(log, r"Scheduler at:\s+(tcp://\S+)")

    @property
    def starts(self):
        """The file with a line for each process in which a worker has begun or resumed a run."""
        return self.logs / "starts.txt"

    def add(self, name, path=None):
        """Start a worker, which finds modules in the folder `path` first. It has no nanny, so that it dies for good."""
        words = ("--no-nanny", "--nthreads", "1", "--name", name, "--local-directory", self.logs)
        log, process = self._start(name, WORKER, self.address, *words, path=path)
        self.workers[name] = process
        told(log, r"Registered to:\s+(tcp://\S+)")
        return told(log, r"Start worker at:\s+(tcp://\S+)")

    def _start(self, name, code, *words, path=None):
        """Start a process of dask's on one core, as a batch system would. Return its log, and the process."""
        log, core = self.logs / f"{name}.log", next(self._cores)
        found = os.pathsep.join([*([str(path)] if path else []), str(self.logs), *filter(None, sys.path)])
        environment = os.environ | {"PYTHONPATH": found, "STARTS": str(self.starts)}
        with log.open("w") as file:
            process = subprocess.Popen(
                [sys.executable, "-c", code, *map(str, words), "--no-dashboard"],
                stdout=file,
                stderr=file,
                env=environment,
                cwd="/",  # nothing of the study's is found from where a worker stands
                preexec_fn=lambda: os.sched_setaffinity(0, {core}),
            )
        self._processes.append(process)
        return log, process

    def end(self):
        """End all of them."""
        for process in self._processes:
            process.kill()
            process.wait()


def told(log, pattern, seconds=120.0):
    """Return what a log says by and by."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if found := re.search(pattern, log.read_text()):
            return found[1]
        time.sleep(0.05)
    raise AssertionError(log.read_text())
