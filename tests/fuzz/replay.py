"""Do cases of the fuzzer again: `python tests/fuzz/replay.py scenes 1234`, or FIRST and LAST; a line of JSON a case.

The files of the last case stay in the folder given with --keep.
"""

import argparse
import faulthandler
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from cases import FolderCases, campaign_case, run_case, scene_case
from judge import Verdict

KINDS: dict[str, Callable[[], Callable[[int], Verdict]]] = {
    "scenes": lambda: scene_case,
    "campaigns": lambda: campaign_case,
    "folders": FolderCases,
    "runs": lambda: run_case,
}
# Of the processor; a campaign checks the scenes of all its runs, some ten milliseconds each.
SECONDS = {"scenes": 10, "campaigns": 60, "folders": 10, "runs": 60}
MEMORY = {"scenes": 2**29, "campaigns": 2**29, "folders": 2**31, "runs": 2**32}  # bytes beyond the modules'


def main() -> None:
    """Run the cases that the arguments name."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int, nargs="?")
    parser.add_argument("--keep", type=Path, help="a new folder")
    arguments = parser.parse_args()
    faulthandler.enable()
    _limit_memory(MEMORY[arguments.kind])
    place = arguments.keep or Path(tempfile.mkdtemp(prefix="fuzz-"))
    place.mkdir(exist_ok=True)
    os.chdir(place)
    try:
        case = KINDS[arguments.kind]()
        print("ready", flush=True)
        last = arguments.first if arguments.last is None else arguments.last
        for seed in range(arguments.first, last + 1):
            signal.setitimer(signal.ITIMER_PROF, SECONDS[arguments.kind])  # it ends the process
            _replay(case, seed)
    finally:
        if not arguments.keep:
            shutil.rmtree(place)


def _replay(case: Callable[[int], Verdict], seed: int) -> None:
    """Judge the case in a folder of its own and print the verdict."""
    folder = Path("case").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    os.chdir(folder)
    start = time.perf_counter()
    verdict = case(seed)
    seconds = round(time.perf_counter() - start, 3)
    os.chdir(folder.parent)
    print(json.dumps({"seed": seed, "seconds": seconds, **vars(verdict)}), flush=True)


def _limit_memory(more: int) -> None:
    """Let this process have so many bytes more than it has."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    limit = pages * resource.getpagesize() + more
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


if __name__ == "__main__":
    sys.exit(main())
