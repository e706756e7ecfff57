"""`pockmark plot`: the pictures of a run."""

from pathlib import Path
from typing import Annotated

import typer

from ..base.terminal import literal
from ..run.measured import standing_of
from ..run.pictures import plot_run
from .common import CONSOLE, RunDir, say_written


def plot(
    folder: RunDir,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Folder for the pictures.")] = None,
) -> None:
    """Draw the slice through the crater and the history."""
    for picture in plot_run(folder, output):
        say_written(picture)
    if said := standing_of(folder):
        CONSOLE.print(literal(f"the run is {said}", "yellow"))
