"""Which checkpoints a run folder keeps, and when one is written."""

import re
import time
from collections.abc import Sequence
from pathlib import Path

from ..base.errors import PockmarkError
from .checkpoint import Checkpoint, ForeignError, read_checkpoint, write_checkpoint
from .simulation import Simulation
from .store import RunFolder
from .tasks import KeptTask

FILE = re.compile(r"checkpoint-(\d{1,9})\.h5")
KEPT = 2


class Keeper:
    """Writes checkpoints of a run as it goes: every so often by the clock on the wall, and at its end; the last two stay."""

    def __init__(
        self, folder: RunFolder, tasks: Sequence[KeptTask], interval: float, *, step: int = -1
    ) -> None:
        """Begin to wait; `interval` in seconds of wall time, 0 for no checkpoint at all. `step` is that of the checkpoint begun from."""
        self._folder, self._tasks, self._interval = folder, tasks, interval
        self._last, self._step = time.monotonic(), step

    def watch(self, simulation: Simulation) -> None:
        """Write a checkpoint if it is time for one."""
        is_over = simulation.time >= simulation.end_time
        if is_over or time.monotonic() - self._last >= self._interval:
            self.keep(simulation)

    def keep(self, simulation: Simulation) -> None:
        """Write a checkpoint, unless there is one of this step. Raises PockmarkError; those before stay."""
        if not self._interval or simulation.steps == self._step:
            return
        found = checkpoints(self._folder.path)
        number = 1 + (_number(found[-1]) or 0) if found else 0
        state = Checkpoint(
            step=simulation.steps,
            time=simulation.time,
            course=simulation.scene.course,
            acted=simulation.acted,
            tasks=[task.state() for task in self._tasks],
            files=self._folder.extent(),
            parts=simulation.save(),
        )
        write_checkpoint(self._folder.path / f"checkpoint-{number:04d}.h5", state)
        for path in checkpoints(self._folder.path)[:-KEPT]:
            path.unlink(missing_ok=True)
        self._last, self._step = time.monotonic(), simulation.steps

    def finish(self) -> None:
        """Leave only the newest checkpoint: a run that has ended goes on from there, if at all."""
        for path in checkpoints(self._folder.path)[:-1]:
            path.unlink(missing_ok=True)


def checkpoints(folder: Path) -> list[Path]:
    """Return the checkpoint files of a run folder, the newest last."""
    numbered = {path: n for path in folder.iterdir() if (n := _number(path)) is not None}
    return sorted(numbered, key=lambda path: numbered[path])


def newest_good(folder: Path, course: str) -> tuple[Checkpoint | None, dict[Path, str]]:
    """Return the newest checkpoint that is whole, None without one, and what is wrong with each that is newer.

    Raises ForeignError where that checkpoint is of another course, format or physics.
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


def _number(path: Path) -> int | None:
    """Return the number of a checkpoint's file, None for another file."""
    name = FILE.fullmatch(path.name)
    return int(name[1]) if name else None
