"""A real dask scheduler and its workers, in processes of their own on this machine, for the tests of this folder."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

SCHEDULER = "import sys; from distributed.cli.dask_scheduler import main; main(sys.argv[1:])"
WORKER = "import sys; from distributed.cli.dask_worker import main; main(sys.argv[1:])"
NO_PAGES = ("--no-dashboard",)


class Crew:
    """A scheduler, and workers that take one run at a time."""

    def __init__(self, logs):
        """Start the scheduler."""
        self.logs, self.workers, self._processes = logs, {}, []
        log, self.scheduler = self._start("scheduler", SCHEDULER, "--host", "127.0.0.1", "--port", "0")
        self.address = told(log, r"Scheduler at:\s+(tcp://\S+)")

    def add(self, name, path=None):
        """Start a worker, which finds modules in the folder `path` first. It has no nanny, so that it dies for good."""
        words = ("--no-nanny", "--nthreads", "1", "--name", name, "--local-directory", self.logs)
        log, process = self._start(name, WORKER, self.address, *words, path=path)
        self.workers[name] = process
        told(log, r"Registered to:\s+(tcp://\S+)")
        return told(log, r"Start worker at:\s+(tcp://\S+)")

    def _start(self, name, code, *words, path=None):
        """Start a process of dask's on one core, as a batch system would. Return its log, and the process."""
        log, environment = self.logs / f"{name}.log", dict(os.environ)
        if path:
            environment["PYTHONPATH"] = os.pathsep.join([str(path), *sys.path])
        core = sorted(os.sched_getaffinity(0))[-1]
        with log.open("w") as file:
            process = subprocess.Popen(
                [sys.executable, "-c", code, *map(str, words), *NO_PAGES],
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
        for process in self._processes[::-1]:
            process.terminate()
        for process in self._processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def told(log, pattern, seconds=40.0):
    """Return what a log says by and by."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if found := re.search(pattern, log.read_text()):
            return found[1]
        time.sleep(0.05)
    raise AssertionError(log.read_text())
