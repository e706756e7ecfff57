"""`pockmark view`: a run in three dimensions."""

from pathlib import Path
from typing import Annotated

import typer

from ..base.terminal import literal
from ..run.measured import standing_of
from ..run.viewing import has_display, shells_of, write_views
from .common import CONSOLE, RunDir, say_written


def view(
    folder: RunDir,
    field: Annotated[
        str, typer.Option(help="What is shown in colours, as pressure or plastic_strain.")
    ] = "pressure",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Write into this folder, and open no window.")
    ] = None,
    off_screen: Annotated[
        bool, typer.Option("--off-screen", help="Write into the run folder, and open no window.")
    ] = False,
) -> None:
    """Open a run in three dimensions. Without a display, write view.png and an animation of the snapshots."""
    shells = shells_of(folder, field)
    if off_screen or output or not has_display():
        for picture in write_views(shells, output or folder):
            say_written(picture)
        if len(shells) == 1:
            CONSOLE.print("one snapshot: there is nothing to animate")
    else:
        shells.open()
    if said := standing_of(folder):
        CONSOLE.print(literal(f"the run is {said}", "yellow"))
