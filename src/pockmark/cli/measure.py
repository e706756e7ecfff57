"""`pockmark measure`: the table of a run, for a reader or a program."""

from typing import Annotated

import typer

from ..base.json import to_json
from ..run.measured import measure_run
from ..view.report import report
from .common import CONSOLE, RunDir


def measure(
    folder: RunDir,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON with stable keys, SI.")] = False,
) -> None:
    """Measure crater, energies and counters of a run. What a counter counts is said beside it (docs/output.md)."""
    result = measure_run(folder)
    if as_json:
        print(to_json(result))
    else:
        CONSOLE.print(report(result))
