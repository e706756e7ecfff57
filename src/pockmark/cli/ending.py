"""The end of `pockmark run` and `resume`: what they show, and their exit code."""

import typer

from ..run.keeper import checkpoints
from ..run.measured import measure_run
from ..run.pictures import plot_run
from ..run.store import RunFolder
from ..view.report import report
from .common import CONSOLE, DOUBTFUL, say_written


def measured_and_drawn(folder: RunFolder) -> bool:
    """Print the table of a run and draw its pictures. Return whether the run is doubtful."""
    result = measure_run(folder.path)
    CONSOLE.print(report(result))
    for picture in plot_run(folder.path):
        say_written(picture)
    return bool(result["doubts"])


def end(folder: RunFolder, *, finished: bool, doubtful: bool) -> None:
    """Leave with the exit code of a run, and say what the code stands for.

    A run that is finished and not doubtful has no code: the function then returns.
    """
    if not finished:
        how = "; pockmark resume goes on" if checkpoints(folder.path) else ""
        CONSOLE.print(f"interrupted: what was computed is kept{how}", style="yellow")
        raise typer.Exit(130)
    if doubtful:
        CONSOLE.print(
            "doubtful: what the table says of it first makes its other numbers worth little", style="bold red"
        )
        raise typer.Exit(DOUBTFUL)
