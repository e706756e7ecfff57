"""Cases in a process of their own, so that one that hangs or crashes is a fault like others, and the rest goes on."""

import json
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# Until a case that waits is ended: it ends itself after less time of the processor, however busy that is with others.
PATIENCE = 60.0  # s
START = 120.0  # s
REPLAY = Path(__file__).with_name("replay.py")


@dataclass(frozen=True)
class Case:
    """A case that was judged."""

    seed: int
    outcome: str
    faults: list[str]
    seconds: float


def watch(kind: str, seeds: range) -> Iterator[Case]:
    """Yield the verdict on each seed. A case beyond its time is ended and counted as a hang."""
    seed = seeds.start
    while seed < seeds.stop:
        for case in _one_process(kind, range(seed, seeds.stop)):
            yield case
            seed = case.seed + 1


def _one_process(kind: str, seeds: range) -> Iterator[Case]:
    """Yield verdicts until the process ends, with a last one on why if that was too early."""
    with tempfile.TemporaryDirectory() as place:
        command = [sys.executable, REPLAY, kind, str(seeds[0]), str(seeds[-1]), "--keep", place]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ) as process:
            try:
                yield from _cases(process, seeds)
            finally:
                process.kill()


def _cases(process: "subprocess.Popen[str]", seeds: range) -> Iterator[Case]:
    """Yield verdicts as the process prints them."""
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_read, args=(process.stdout, lines), daemon=True).start()
    if lines.get(timeout=START) != "ready\n":
        raise RuntimeError(f"{process.args} does not start")
    for seed in seeds:
        try:
            line = lines.get(timeout=PATIENCE)
        except queue.Empty:
            yield Case(seed, "hang", [f"hang: waits above {PATIENCE:g} s"], PATIENCE)
            return
        if not line:
            yield _ended(seed, process.wait(START))
            return
        yield Case(**json.loads(line))


def _ended(seed: int, code: int) -> Case:
    """Return the verdict on the case in which the process ended."""
    if code == -signal.SIGPROF:
        return Case(seed, "hang", ["hang: beyond its time of the processor"], 0.0)
    return Case(seed, "crash", [f"crash: the process ended with {code}"], 0.0)


def _read(stream: Any, lines: "queue.Queue[str]") -> None:
    """Put the lines of a stream into a queue, and an empty one at its end."""
    for line in stream:
        lines.put(line)
    lines.put("")


def table(kind: str, cases: Iterable[Case]) -> list[tuple[str, str, int, str]]:
    """Return a row an outcome and a kind of fault: kind, what, how many cases, the first seeds."""
    found: dict[str, list[int]] = defaultdict(list)
    for case in cases:
        found[f"outcome {case.outcome}"].append(case.seed)
        for what in {fault.partition(":")[0] for fault in case.faults}:
            found[f"FAULT {what}"].append(case.seed)
    return [(kind, what, len(seeds), " ".join(map(str, seeds[:3]))) for what, seeds in sorted(found.items())]
