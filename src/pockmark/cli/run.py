"""`pockmark run`: a scene to a measured, drawn run folder."""

from pathlib import Path
from typing import Annotated

import typer

from ..base.terminal import literal
from ..run.pipeline import run_scene
from ..run.simulation import thread_count
from ..run.stop import heard_between_steps
from ..scene.forecast import forecast
from ..scene.scene import Scene
from .common import CONSOLE, Coarse, Overrides, SceneFile, Threads
from .ending import end, measured_and_drawn


def run(
    scene: SceneFile,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Run folder (runs/NAME).")] = None,
    overrides: Overrides = None,
    threads: Threads = 0,
    force: Annotated[bool, typer.Option(help="Replace a run that is there.")] = False,
    quiet: Annotated[bool, typer.Option(help="No progress bar.")] = False,
    coarse: Coarse = False,
) -> None:
    """Run a scene; measure and draw the crater."""
    loaded = Scene.load(scene, overrides or ())
    path = output or Path("runs") / scene.stem
    if not quiet:
        expected = forecast(loaded, thread_count(threads))
        CONSOLE.print(f"{expected.points:,} points, {expected.cells:,} cells, about {expected.steps:,} steps")
        if expected.cells_across is not None:
            CONSOLE.print(f"{expected.cells_across:.3g} cells across the projectile")
        for warning in expected.warnings:
            CONSOLE.print(literal("warning:", "yellow"), literal(warning))
    # What Ctrl-C leaves of the run is measured and drawn, however often Ctrl-C is pressed.
    with heard_between_steps():
        folder, finished = run_scene(
            loaded,
            path,
            threads=thread_count(threads),
            force=force,
            progress=not quiet,
            coarse=coarse,
        )
        doubtful = measured_and_drawn(folder)
    end(folder, finished=finished, doubtful=doubtful)
