"""`pockmark converge`: how far a scene's result is from that of infinitely small cells."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from ..base.errors import PockmarkError
from ..base.files import replaced
from ..base.lengths import in_metres
from ..base.terminal import literal
from ..base.units import to_si
from ..run.simulation import thread_count
from ..scene.scene import Scene
from ..study.convergence import Finding, cases_of, findings, order_told, panels, sentence
from ..study.convergence_table import table_of, write_files
from ..study.levels import Plan, plan_of
from ..study.processes import Processes
from ..study.runner import Outcome, run_study
from ..view.convergence import convergence_figure
from .common import CONSOLE, DOUBTFUL, Coarse, Overrides, SceneFile, say_written


def converge(
    scene: SceneFile,
    overrides: Overrides = None,
    levels: Annotated[int, typer.Option(min=2, max=8, help="Cells at most, the scene's own included.")] = 4,
    budget: Annotated[
        str, typer.Option(metavar="TIME", help="What all runs may take together, by forecast.")
    ] = "3 min",
    in_3d: Annotated[bool, typer.Option("--in-3d", help="Compute in 3D what could be axisymmetric.")] = False,
    jobs: Annotated[int, typer.Option(min=1, max=256, help="Runs at a time; they share the cores.")] = 1,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where the runs are kept (runs/converge/NAME).")
    ] = None,
    coarse: Coarse = False,
) -> None:
    """Run a scene on coarser and finer cells, and say what its crater tends to and how far off your cell is."""
    loaded = Scene.load(scene, overrides or ())
    plan = plan_of(
        loaded, most=levels, budget=_time(budget), threads=thread_count(0), coarse=coarse, in_3d=in_3d
    )
    _print_plan(plan)
    out = output or Path("runs") / "converge" / scene.stem
    try:
        outcomes = run_study(cases_of(plan), out, pool=Processes(jobs), console=CONSOLE, coarse=coarse)
    except KeyboardInterrupt:
        CONSOLE.print("interrupted: what is done is kept, the same command goes on", style="yellow")
        raise typer.Exit(130) from None
    found = findings(plan, outcomes)
    _print_found(plan, found, loaded.title or scene.stem)
    for path in [*write_files(plan, found, outcomes, out), _draw(found, loaded.title or scene.stem, out)]:
        say_written(path)
    _leave(outcomes)


def _print_plan(plan: Plan) -> None:
    """Print what will be run."""
    how = f"in 3D ({plan.why_3d})" if plan.why_3d else "as an axisymmetric impact"
    CONSOLE.print(literal(f"computed {how}, on cells at a ratio of about {plan.ratio:g}:"))
    for place, level in enumerate(plan.levels):
        expected = level.expected
        yours = " (your cell)" if place == plan.own else ""
        CONSOLE.print(
            f"  {in_metres(level.cell)}{yours}: {expected.points:,} points, {expected.cells_across or 0:.3g} cells across, "
            f"about {expected.seconds:,.0f} s"
        )
    CONSOLE.print(f"about {plan.seconds:,.0f} s together")


def _print_found(plan: Plan, found: Sequence[Finding], title: str) -> None:
    """Print the table, then a sentence for each quantity, and what is missing."""
    if not found:
        CONSOLE.print("no measure has a value on any cell", style="yellow")
        return
    CONSOLE.print(table_of(plan, found, title))
    for finding in found:
        for text in finding.missing:
            CONSOLE.print(literal("missing:", "yellow"), literal(f"{finding.quantity.name} on {text}"))
    for finding in found:
        limit = finding.limit
        order = f" (order {order_told(limit)})" if limit else ""
        style = "bold" if limit and limit.is_known else "yellow"
        CONSOLE.print(literal(sentence(finding), style), literal(order), sep="")


def _draw(found: Sequence[Finding], title: str, out: Path) -> Path:
    """Draw converge.png into a folder, and return its path. Raises PockmarkError."""
    path = out / "converge.png"
    with replaced(path) as descriptor, open(descriptor, "wb", closefd=False) as file:
        convergence_figure([*panels(found)], title).savefig(file, format="png", dpi=150)
    return path


def _leave(outcomes: Sequence[Outcome]) -> None:
    """Leave with an exit code where runs failed or are doubtful, and say so."""
    failed = sum(bool(outcome.fault) for outcome in outcomes)
    doubtful = sum(outcome.is_doubtful for outcome in outcomes)
    for count, what in ((failed, "failed"), (doubtful, "are doubtful")):
        if count:
            CONSOLE.print(f"{count} of {len(outcomes)} runs {what}: they are left out", style="bold red")
    if failed or doubtful:
        raise typer.Exit(1 if failed else DOUBTFUL)


def _time(text: str) -> float:
    """Return the time that --budget gives, s. Raises PockmarkError."""
    try:
        return to_si(text, "s", low=0.0)
    except ValueError as error:
        raise PockmarkError(f"--budget: {error}") from None
