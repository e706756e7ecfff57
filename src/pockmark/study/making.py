"""A run that was ordered, made.

`python -m pockmark.study.making THREADS` reads an order as a line of JSON, makes the run, and answers with JSON.
"""

import json
import os
import sys
import threading
from pathlib import Path

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError
from ..run.pipeline import can_resume, resume_run, run_scene
from ..run.store import RunFolder
from ..scene.scene import Scene
from .order import INTERRUPTED, Order, RefusedError


def is_done(folder: Path) -> bool:
    """Return whether a folder holds a finished run of this version and this physics."""
    try:
        manifest = RunFolder.open(folder).manifest()
    except PockmarkError:
        return False
    made_by = manifest.get("pockmark"), manifest.get("physics")
    return manifest["status"] == "finished" and made_by == (__version__, PHYSICS)


def make(order: Order, threads: int) -> str:
    """Make a run, from its checkpoint if it was stopped. Return why it failed, or an empty text.

    Raises RefusedError where this pockmark has another version or physics than the order.
    """
    wanted = order["pockmark"], order["physics"]
    if wanted != (__version__, PHYSICS):
        raise RefusedError(
            f"has pockmark {__version__} of physics {PHYSICS}, this campaign needs {wanted[0]} of physics {wanted[1]}"
        )
    folder, scene = order["folder"], Scene.from_dict(order["scene"])
    try:
        if is_done(Path(folder)):  # by a worker that was lost before it could say so
            return ""
        if can_resume(folder, scene):
            finished = resume_run(folder, threads=threads, progress=False).is_finished
        else:
            _, finished = run_scene(
                scene, folder, threads=threads, force=True, progress=False, coarse=order["coarse"]
            )
    except PockmarkError as error:
        return str(error).removeprefix(f"{folder}: ")
    return "" if finished else INTERRUPTED


def main() -> None:
    """Make the run of the order that standard input has, with the threads that the command line gives."""
    answer = os.dup(1)
    os.dup2(2, 1)  # what else is printed is no part of the answer
    with open(0, encoding="utf-8", closefd=False) as lines:
        order: Order = json.loads(lines.readline())
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        told = {"fault": make(order, int(sys.argv[1]))}
    except RefusedError as error:
        told = {"refused": str(error)}
    os.write(answer, json.dumps(told).encode())


def _end_with_parent() -> None:
    """Wait for the process that asked to end, however that happens, and end this one with it."""
    os.read(0, 1)  # not by a buffered reader, whose lock Python wants as it ends
    os._exit(1)


if __name__ == "__main__":
    main()
