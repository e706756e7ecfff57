"""The checkpoints of a run folder: when one is written, and which are kept."""

import re
import time
from collections.abc import Sequence
from pathlib import Path

from ..base.errors import PockmarkError
from ..base.files import numbered, remove
from .checkpoint import Checkpoint, ForeignError, read_checkpoint, write_checkpoint
from .extent import extent_of
from .simulation import Simulation, core_name
from .store import RunFolder
from .task import KeptTask

FILE = re.compile(r"checkpoint-(\d{1,9})\.h5")
KEPT = 2


class Keeper:
    """The writer of a run's checkpoints.

    It writes one every so often by wall time, and one at the end. The last two are kept.
    """

    def __init__(
        self, folder: RunFolder, tasks: Sequence[KeptTask], interval: float, *, step: int = -1
    ) -> None:
        """Begin to wait for `interval` seconds of wall time; 0 means no checkpoint at all.

        `step` is the step of the checkpoint from which the run goes on, -1 without one.
        """
        self._folder, self._tasks, self._interval = folder, tasks, interval
        self._last, self._step = time.monotonic(), step

    def watch(self, simulation: Simulation) -> None:
        """Write a checkpoint if it is time for one."""
        is_over = simulation.time >= simulation.end_time
        if is_over or time.monotonic() - self._last >= self._interval:
            self.keep(simulation)

    def keep(self, simulation: Simulation) -> None:
        """Write a checkpoint, unless there is one of this step. Raises PockmarkError; the older ones then stay."""
        if not self._interval or simulation.steps == self._step:
            return
        number = 1 + max(_numbered(self._folder.path).values(), default=-1)
        while (path := self._folder.path / f"checkpoint-{number:04d}.h5").is_dir():
            number += 1
        state = Checkpoint(
            step=simulation.steps,
            time=simulation.time,
            course=simulation.scene.course,
            acted=simulation.acted,
            tasks=[task.state() for task in self._tasks],
            files=extent_of(self._folder),
            core=core_name(),
            parts=simulation.save(),
        )
        write_checkpoint(path, state)
        for older in checkpoints(self._folder.path)[:-KEPT]:
            remove(older)
        self._last, self._step = time.monotonic(), simulation.steps

    def finish(self) -> None:
        """Remove all checkpoints but the newest: a run that has ended goes on from that one, if at all."""
        for path in checkpoints(self._folder.path)[:-1]:
            remove(path)


def checkpoints(folder: Path) -> list[Path]:
    """Return the checkpoint files of a run folder, the newest last."""
    return list(_numbered(folder))


def _numbered(folder: Path) -> dict[Path, int]:
    """Return the checkpoint files with their numbers. A folder of such a name is none."""
    found = numbered(folder, FILE)
    return {path: number for path, number in found.items() if path.is_symlink() or not path.is_dir()}


def newest_good(folder: Path, course: str) -> tuple[Checkpoint | None, dict[Path, str]]:
    """Return the newest checkpoint that is whole, and what is wrong with each newer one.

    The checkpoint is None if none is whole. Raises ForeignError if it is of another course, format or physics.
    """
    damaged: dict[Path, str] = {}
    for path in reversed(checkpoints(folder)):
        try:
            found = read_checkpoint(path)
        except ForeignError:
            raise
        except PockmarkError as error:
            damaged[path] = str(error)
            continue
        if found.course != course:
            raise ForeignError(f"{path}: is a checkpoint of another scene than this run's")
        return found, damaged
    return None, damaged
