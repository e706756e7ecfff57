"""What the commands share: arguments, options, the console."""

from pathlib import Path
from typing import Annotated

import typer

from ..base.errors import shown
from ..base.terminal import make_console

CONSOLE = make_console()
MAX_PATH = 4096  # characters of a path that are printed
DOUBTFUL = 3  # exit code of a finished run that is doubtful

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene in TOML.")]
RunDir = Annotated[Path, typer.Argument(metavar="DIR", help="A run folder.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change a key: impact.speed='4 km/s', body.projectile.radius='5 um' (by name, or counted from 0).",
    ),
]
Coarse = Annotated[
    bool, typer.Option("--coarse", help="Run with fewer than four cells across the projectile.")
]
Threads = Annotated[int, typer.Option(help="Threads; 0 takes every core.")]


def say_written(path: Path, more: str = "") -> None:
    """Say that a file was written: its path is in one piece, however long, to be copied."""
    CONSOLE.print(f"wrote {shown(path, MAX_PATH)}{more}", soft_wrap=True)
