"""The command line. Each command has a file."""

import os
import sys
from io import TextIOWrapper
from typing import Annotated

import typer

from .. import __version__
from ..base.errors import PockmarkError, shown
from . import (
    bench,
    check,
    converge,
    demo,
    explain,
    materials,
    measure,
    new,
    plot,
    report,
    resume,
    run,
    study,
    view,
)
from .common import MAX_PATH

app = typer.Typer(
    help="Craters of micron-sized particles at kilometres per second, by the material point method.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (
    *(run.run, resume.resume, check.check, measure.measure, plot.plot, view.view, report.report, bench.bench),
    *(study.study, converge.converge, materials.materials, explain.explain, new.new, demo.demo),
):
    app.command()(command)


def _version(value: bool) -> None:
    """Print the version and leave, if it was asked for."""
    if value:
        print(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Declare the options of the program itself."""


def main() -> None:
    """Run the command line. A user's mistake is one sentence and exit code 2."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a name need not fit the terminal's encoding
    try:
        app()
    except PockmarkError as error:
        print(f"pockmark: {error}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # the reader of our output has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        where, what = error.filename or "output", error.strerror or error
        print(f"pockmark: {shown(where, MAX_PATH)}: {shown(what)}", file=sys.stderr)
        sys.exit(2)
    except MemoryError:
        print("pockmark: there is not enough memory for this scene (see pockmark check)", file=sys.stderr)
        sys.exit(2)
