"""Kill runs without warning at random moments, resume them, and hold them against runs that nobody stopped.

`python tests/run/kills.py 50 > tests/run/kills.csv` makes the table of docs/reliability.md.
"""

import csv
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pockmark import measure
from pockmark.cli.common import DOUBTFUL
from pockmark.run.keeper import checkpoints
from pockmark.run.store import RunFolder

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
# A checkpoint after every look at the clock: a good part of the time is spent in writing them.
COMMON = ("end_time='40 ns'", "output.snapshots='10 ns'", "output.checkpoints='1 ms'")
VARIANTS = {
    "double": (),
    "single": ("numerics.precision='single'",),
    "quadratic": ("numerics.shape_functions='quadratic'",),
    "contact": ("contact.friction=0.2",),
    "single, quadratic, contact": (
        "numerics.precision='single'",
        "numerics.shape_functions='quadratic'",
        "contact.friction=0.2",
    ),
    "usf": ("numerics.scheme='usf'",),
    "paper": ("numerics.scheme='paper'",),
    "axisymmetric": ("grid.geometry='axisymmetric'",),
}
FINISHED = (0, DOUBTFUL)  # exit codes; USF on cells so coarse gains energy, which is doubtful
TOLD = ("run", "doubts", "warnings")  # of a measured table, what tells of the run and not of the crater


def pockmark(*words):
    """Start `pockmark WORDS`."""
    command = [sys.executable, "-m", "pockmark", *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def run(folder, variant, threads):
    """Start a run of a variant."""
    changes = [word for change in (*COMMON, *VARIANTS[variant]) for word in ("--set", change)]
    return pockmark("run", QUICK, "-o", folder, "--quiet", "--threads", threads, *changes)


def begins(process, folder):
    """Wait until a run, or one that goes on, has its folder. Returns the moment."""
    deadline = time.monotonic() + 120
    while process.poll() is None and not is_begun(process, folder):
        assert time.monotonic() < deadline
        time.sleep(0.002)
    return time.monotonic()


def is_begun(process, folder):
    """Return whether a process has locked a folder that holds its scene."""
    try:
        return (folder / "scene.toml").exists() and f"process {process.pid} " in (
            folder / "run.lock"
        ).read_text()
    except OSError:
        return False


def killed(process, folder, after):
    """Kill a process so many seconds after it has begun. Returns whether it was writing a file then, None if it had ended before."""
    begun = begins(process, folder)
    time.sleep(max(0.0, begun + after - time.monotonic()))
    process.kill()
    process.communicate()
    if process.returncode != -9 or RunFolder(folder).status() != "killed":
        return None
    return any(folder.glob(f"*.{process.pid}.part"))


def whole(folder, variant):
    """Make the run that nobody stops. Returns the seconds that it takes from its folder to its end."""
    process = run(folder, variant, 1)
    begun = begins(process, folder)
    while RunFolder(folder).status() != "finished":
        assert process.poll() in (None, *FINISHED)
        time.sleep(0.01)
    seconds = time.monotonic() - begun
    said, _ = process.communicate()
    assert process.returncode in FINISHED, said
    return seconds


def resumed_to_the_end(folder, threads):
    """Resume a run, and check that it finishes."""
    process = pockmark("resume", folder, "--quiet", "--threads", threads)
    said, _ = process.communicate()
    assert process.returncode in FINISHED, said


def differences(one, other):
    """Return what differs between two runs: history, fields of snapshots, the measured table."""
    found = []
    if (one / "history.csv").read_bytes() != (other / "history.csv").read_bytes():
        found.append("history.csv")
    mine, others = RunFolder(one).snapshots(), RunFolder(other).snapshots()
    if [path.name for path in mine] != [path.name for path in others]:
        return [*found, "names of snapshots"]
    for a, b in zip(mine, others, strict=True):
        left, right = RunFolder(one).snapshot(a), RunFolder(other).snapshot(b)
        found += [f"{a.name}: {name}" for name in left if not np.array_equal(left[name], right[name])]
    left, right = (measure(folder) for folder in (one, other))
    found += [name for name in left if name not in TOLD and left[name] != right[name]]
    found += [name for name in ("steps", "time", "points") if left["run"][name] != right["run"][name]]
    return found


def trial(whole_run, seconds, folder, variant, rng):
    """Kill a run, and what goes on with it, a few times; resume it to its end. Returns a row of the table, None if it was too fast."""
    threads, kills, writing = rng.choice((1, 2)), 0, 0
    process = run(folder, variant, threads)
    for more in range(rng.choice((1, 1, 2, 3))):
        if more:
            process = pockmark("resume", folder, "--quiet", "--threads", rng.choice((1, 2)))
        was_writing = killed(process, folder, rng.uniform(0.0, seconds))
        if was_writing is None:
            break
        kills, writing = kills + 1, writing + was_writing
    if not kills:
        return None
    left = checkpoints(folder)
    if RunFolder(folder).status() != "finished":
        resumed_to_the_end(folder, rng.choice((1, 2)))
    return {
        "variant": variant,
        "kills": kills,
        "of_them_while_writing": writing,
        "checkpoints_left": len(left),
        "differences": "; ".join(differences(whole_run, folder)) or "none",
    }


def main(count):
    """Print the table of `count` kills or a few more."""
    rng = random.Random(15)
    writer, done = None, 0
    with tempfile.TemporaryDirectory() as place:
        wholes = {}
        for n in range(10 * count):
            variant = list(VARIANTS)[n % len(VARIANTS)]
            if variant not in wholes:
                path = Path(place) / f"whole-{n}"
                wholes[variant] = (path, whole(path, variant))
            row = trial(*wholes[variant], Path(place) / f"run-{n}", variant, rng)
            if row is None:
                continue
            writer = writer or csv.DictWriter(sys.stdout, list(row), lineterminator="\n")
            if not done:
                writer.writeheader()
            writer.writerow(row)
            sys.stdout.flush()
            done += row["kills"]
            if done >= count:
                return


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "2")
    main(int(sys.argv[1]))
