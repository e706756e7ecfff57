"""`pockmark study`: a campaign of runs, and its table."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from ..base.errors import PockmarkError, shown
from ..base.files import make_folder
from ..base.shipped import shipped
from ..base.terminal import literal
from ..study.campaign import FILE, Campaign, cases, load
from ..study.runner import Outcome, make_report, run_study, summary, write_results
from ..study.slurm import Slurm
from .common import CONSOLE, DOUBTFUL, Coarse, say_written
from .pools import pool_of


def study(
    name: Annotated[
        str,
        typer.Argument(
            help=f"A folder with a {FILE}, that file, or the name of a folder in ./studies or of those that pockmark has."
        ),
    ],
    quick: Annotated[bool, typer.Option(help="The coarse, short form.")] = False,
    only: Annotated[list[str] | None, typer.Option(help="A group or figure of the campaign.")] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            min=1, max=256, help="Runs at a time; they share the cores (1). With --slurm: jobs of Slurm's."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="A dask scheduler, whose workers make the runs: tcp://node1:8786."
        ),
    ] = None,
    slurm: Annotated[
        bool, typer.Option("--slurm", help=f"Make the runs in jobs of Slurm's, as [slurm] in {FILE} says.")
    ] = False,
    output: Annotated[Path, typer.Option("-o", "--output", help="Where the runs are kept.")] = Path(
        "runs/studies"
    ),
    coarse: Coarse = False,
) -> None:
    """Run a campaign: a scene with swept keys. What is there is not run again; what fails stops nothing."""
    folder, place = _folders(name, output, quick=quick)
    campaign = load(folder)
    wanted = cases(campaign, folder, quick=quick, only=only or [])
    asked = _table(campaign, folder) if slurm else None
    try:
        with pool_of(jobs, scheduler, asked, output / "slurm") as pool:
            outcomes = run_study(wanted, output, pool=pool, console=CONSOLE, coarse=coarse or campaign.coarse)
    except KeyboardInterrupt:
        CONSOLE.print("interrupted: what is done is kept, the same command goes on", style="yellow")
        raise typer.Exit(130) from None
    CONSOLE.print(summary(outcomes, campaign.title or name))
    make_folder(place)
    table = place / f"results{'-quick' if quick else ''}.csv"
    older = write_results(outcomes, output, table, cases(campaign, folder, quick=quick, only=[]))
    say_written(table)
    if older:
        CONSOLE.print(
            literal(
                f"{older} of its rows were of an older version or physics and are gone; the command without --only "
                "makes them again",
                "yellow",
            )
        )
    if campaign.report:
        make_report(folder / campaign.report, table, output)
    _leave(outcomes)


def _table(campaign: Campaign, folder: Path) -> Slurm:
    """Return what a campaign asks of Slurm. Raises PockmarkError if it does not say."""
    if campaign.slurm is None:
        raise PockmarkError(f"--slurm: {folder / FILE} has no table [slurm]: queue, walltime, cores, memory")
    return campaign.slurm


def _leave(outcomes: Sequence[Outcome]) -> None:
    """Leave with an exit code where runs failed or are doubtful, and say so."""
    if failed := sum(bool(o.fault) for o in outcomes):
        CONSOLE.print(f"{failed} of {len(outcomes)} runs failed", style="red")
    if doubtful := sum(outcome.is_doubtful for outcome in outcomes):
        CONSOLE.print(
            f"{doubtful} of {len(outcomes)} runs are doubtful: their numbers are worth little",
            style="bold red",
        )
    if failed or doubtful:
        raise typer.Exit(1 if failed else DOUBTFUL)


def _folders(name: str, output: Path, *, quick: bool) -> tuple[Path, Path]:
    """Return the folder of a campaign, and the folder for its table.

    The table lies beside the campaign, but for that of the quick form and of a campaign that came with the package.
    Raises PockmarkError for what is no campaign.
    """
    path = Path(name)
    if path.is_file():
        if path.name != FILE:
            raise PockmarkError(f"{path}: is a file, expected a folder with a {FILE}, or that file")
        return path.parent, output if quick else path.parent
    for folder in (path, Path("studies") / name):
        if (folder / FILE).exists():
            return folder, output if quick else folder
    ours = shipped("studies")
    if (ours / name / FILE).exists():
        return ours / name, output / name
    if path.is_dir():  # load() says what is wrong with what it holds
        return path, path
    known = ", ".join(sorted(file.parent.name for file in ours.glob(f"*/{FILE}")))
    raise PockmarkError(f"{shown(name, 60)}: is no folder with a {FILE}, nor one of pockmark's: {known}")
