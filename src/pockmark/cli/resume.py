"""`pockmark resume`: go on with a run that was stopped, or past its end."""

from typing import Annotated

import typer

from ..base.errors import PockmarkError
from ..base.terminal import literal
from ..base.units import to_si
from ..run.pipeline import resume_run
from ..run.simulation import thread_count
from ..run.stop import heard_between_steps
from .common import CONSOLE, RunDir, Threads
from .ending import end, measured_and_drawn


def resume(
    folder: RunDir,
    end_time: Annotated[
        str | None, typer.Option("--end-time", metavar="TIME", help="Go on to a later end, as '1 us'.")
    ] = None,
    threads: Threads = 0,
    quiet: Annotated[bool, typer.Option(help="No progress bar.")] = False,
) -> None:
    """Go on with a run from its newest good checkpoint, to the last bit as if it had never stopped."""
    with heard_between_steps():
        resumed = resume_run(
            folder,
            end_time=None if end_time is None else _time(end_time),
            threads=thread_count(threads),
            progress=not quiet,
        )
        for sentence in resumed.told:
            CONSOLE.print(literal("note:", "yellow"), literal(sentence))
        begun = resumed.begun
        CONSOLE.print(
            f"went on from step {begun.step:,}, {begun.time * 1e9:.4g} ns"
            if begun
            else "began anew: it was killed before its first checkpoint"
        )
        doubtful = measured_and_drawn(resumed.folder)
    end(resumed.folder, finished=resumed.is_finished, doubtful=doubtful)


def _time(text: str) -> float:
    """Return the time that --end-time gives, s. Raises PockmarkError."""
    try:
        return to_si(text, "s")
    except ValueError as error:
        raise PockmarkError(f"--end-time: {error}") from None
