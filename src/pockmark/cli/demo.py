"""`pockmark demo`: a crater in seconds, and what to do next."""

from pathlib import Path
from typing import Annotated

import typer

from ..base.shipped import example
from .common import CONSOLE, Threads
from .run import run

EXAMPLE = "rings"
NEXT = """
That was the example {name}: the table is of the crater in it, {folder} has its pictures, its history and snapshots for ParaView. Next:
  pockmark new my-impact.toml        a scene with comments to start from; --list names others
  pockmark check my-impact.toml      what it will take, and what to know of it before it runs
  pockmark run my-impact.toml        runs it: as here
  pockmark converge my-impact.toml   how far off the cells put the crater
  pockmark explain, materials        what each key means; which materials there are
"""


def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Run folder.")] = Path("runs/demo"),
    threads: Threads = 0,
    force: Annotated[bool, typer.Option(help="Replace a run that is there.")] = False,
    quiet: Annotated[bool, typer.Option(help="No progress bar.")] = False,
) -> None:
    """Run an impact that takes seconds; measure and draw its crater, and say what to do next."""
    run(example(EXAMPLE), output, threads=threads, force=force, quiet=quiet)
    CONSOLE.print(NEXT.format(name=EXAMPLE, folder=output), soft_wrap=True, highlight=False)
