"""The bars of a campaign: one for all of it, and one for each run that goes on now, wherever that is.

What a run has reached is read from its folder, so that nobody has to send it.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from ..base.errors import PockmarkError, shown
from ..run.store import RunFolder


@dataclass
class Watched:
    """A run that is to be made: its name, its folder, its end (s), and the time that it will take (s)."""

    label: str
    folder: Path
    end: float
    seconds: float
    reached: float = 0.0  # of its end, 0 to 1
    bar: TaskID | None = None  # while it goes on


class Bars:
    """The bars of the runs of a campaign that are to be made."""

    def __init__(self, progress: Progress, runs: Sequence[Watched], text: str) -> None:
        """Show the bar of the whole campaign."""
        self._progress, self._open = progress, dict(enumerate(runs))
        self._over = 0.0  # s of work
        total = sum(run.seconds for run in runs)
        self._all = progress.add_task(text, total=total or None)

    def look(self) -> None:
        """Show what each run has reached, and on which computer."""
        for run in self._open.values():
            self._show(run)
        reached = sum(run.seconds * run.reached for run in self._open.values())
        self._progress.update(self._all, completed=self._over + reached)

    def end(self, n: int, text: str) -> None:
        """Show that a run is over."""
        run = self._open.pop(n)
        self._over += run.seconds
        self._remove(run)
        self._progress.update(self._all, description=text)
        self.look()

    def clear(self) -> None:
        """Leave the bar of the whole campaign alone."""
        for run in self._open.values():
            self._remove(run)

    def _show(self, run: Watched) -> None:
        """Show the bar of a run, if it goes on now."""
        try:
            found = RunFolder(run.folder).live()
        except PockmarkError:  # its outcome will say so
            found = None
        if found is None:
            self._remove(run)
            return
        where, run.reached = found[0].partition(" since ")[0], min(1.0, found[1] / run.end)
        if run.bar is None:
            run.bar = self._progress.add_task("", total=1.0)
        self._progress.update(run.bar, description=shown(f"{run.label}: {where}"), completed=run.reached)

    def _remove(self, run: Watched) -> None:
        """Remove the bar of a run that does not go on now."""
        if run.bar is not None:
            self._progress.remove_task(run.bar)
            run.bar = None


@contextmanager
def bars_of(console: Console, runs: Sequence[Watched], text: str) -> Iterator[Bars]:
    """Give the bars of runs while they are shown. `text` stands before that of the whole campaign."""
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as progress:
        bars = Bars(progress, runs, text)
        try:
            yield bars
        finally:
            bars.clear()
