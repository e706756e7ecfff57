"""The command line: run, check, measure, plot, bench, study."""

import os
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from . import __version__
from .bench import bench as run_bench
from .bench import bench_scene
from .campaign import FILE, cases, load
from .errors import PockmarkError, shown
from .forecast import forecast
from .report import report
from .run import measure_run, plot_run, run_scene, standing_of
from .scene import Scene
from .simulation import thread_count
from .stop import heard_between_steps
from .store import to_json
from .study import make_report, run_study, summary, write_results
from .terminal import literal, make_console

app = typer.Typer(
    help="Craters of micron-sized particles at kilometres per second, by the material point method.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
console = make_console()

DOUBTFUL = 3  # exit code of a run that finished in a state that cannot be
MAX_PATH = 4096  # characters of a path that are printed

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
Threads = Annotated[int, typer.Option(help="Threads; 0 takes every core.")]


@app.command()
def run(
    scene: SceneFile,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Run folder (runs/NAME).")] = None,
    overrides: Overrides = None,
    threads: Threads = 0,
    force: Annotated[bool, typer.Option(help="Replace a run that is there.")] = False,
    quiet: Annotated[bool, typer.Option(help="No progress bar.")] = False,
    coarse: Annotated[
        bool, typer.Option("--coarse", help="Run with fewer than four cells across the projectile.")
    ] = False,
) -> None:
    """Run a scene; measure and draw the crater."""
    loaded = Scene.load(scene, overrides or ())
    path = output or Path("runs") / scene.stem
    if not quiet:
        expected = forecast(loaded, thread_count(threads))
        console.print(f"{expected.points:,} points, {expected.cells:,} cells, about {expected.steps:,} steps")
        if expected.cells_across is not None:
            console.print(f"{expected.cells_across:.3g} cells across the projectile")
        for warning in expected.warnings:
            console.print(literal("warning:", "yellow"), literal(warning))
    # What Ctrl-C leaves of the run is measured and drawn, however often it is pressed.
    with heard_between_steps():
        folder, finished = run_scene(
            loaded,
            path,
            threads=thread_count(threads),
            force=force,
            progress=not quiet,
            coarse=coarse,
        )
        result = measure_run(folder.path)
        console.print(report(result))
        for picture in plot_run(folder.path):
            console.print(f"wrote {shown(picture, MAX_PATH)}")
    if not finished:
        console.print("interrupted: what was computed is kept", style="yellow")
        raise typer.Exit(130)
    if result["doubts"]:
        console.print(
            "doubtful: what the table says of it first makes its other numbers worth little", style="bold red"
        )
        raise typer.Exit(DOUBTFUL)


@app.command()
def check(scene: SceneFile, overrides: Overrides = None, threads: Threads = 0) -> None:
    """Forecast points, cells, steps, memory and time of a scene, before anything runs."""
    loaded = Scene.load(scene, overrides or ())
    expected = forecast(loaded, thread_count(threads))
    table = Table(show_header=False, title=literal(loaded.title or scene, "table.title"))
    table.add_row("points", f"{expected.points:,}")
    table.add_row("cells", f"{expected.cells:,}")
    if expected.cells_across is not None:
        table.add_row("cells across the projectile", f"{expected.cells_across:.3g}")
    table.add_row("steps, about", f"{expected.steps:,}")
    table.add_row("memory at its peak", f"{expected.memory / 2**20:,.0f} MiB")
    table.add_row("disk", f"{expected.disk / 1e6:,.0f} MB")
    table.add_row("time, about", f"{expected.seconds:,.0f} s on {thread_count(threads)} threads")
    console.print(table)
    for warning in expected.warnings:
        console.print(literal("warning:", "yellow"), literal(warning))


@app.command()
def measure(
    folder: RunDir,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON with stable keys, SI.")] = False,
) -> None:
    """Measure crater, energies and counters of a run; what each counter counts is said beside it (and in docs/output.md)."""
    result = measure_run(folder)
    if as_json:
        print(to_json(result))
    else:
        console.print(report(result))


@app.command()
def plot(
    folder: RunDir,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Folder for the pictures.")] = None,
) -> None:
    """Draw the slice through the crater and the history."""
    for picture in plot_run(folder, output):
        console.print(f"wrote {shown(picture, MAX_PATH)}")
    if said := standing_of(folder):
        console.print(literal(f"the run is {said}", "yellow"))


@app.command()
def bench(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, SI.")] = False,
    points: Annotated[int, typer.Option(min=1000, help="Material points, about.")] = 1_000_000,
    precision: Annotated[str, typer.Option(help="double or single.")] = "double",
    threads: Threads = 0,
    overrides: Overrides = None,
) -> None:
    """Time the step on this machine: a fixed impact with the full physics, phase by phase."""
    scene = bench_scene(points, (f"numerics.precision={precision}", *(overrides or ())))
    try:
        result = run_bench(scene, thread_count(threads))
    except RuntimeError as error:
        raise PockmarkError(f"bench: the run failed: {error}") from None
    if as_json:
        print(to_json(result))
        return
    title = (
        f"{result['points']:,} points, {result['scheme']}, {result['shape_functions']}, {result['precision']}"
    )
    table = Table("phase", "ns a point", "bytes a point", "of the copy bandwidth", title=title)
    for name, phase in result["phases"].items():
        share = f"{phase['share_of_copy_bandwidth']:.0%}" if phase["bytes_per_point"] else ""
        table.add_row(name, f"{phase['ns_per_point']:.1f}", f"{phase['bytes_per_point']:.0f}", share)
    console.print(table)
    console.print(
        f"{result['particle_steps_per_second'] / 1e6:.2f} M particle-steps/s on {result['threads']} threads "
        f"({result['isa']}); copy bandwidth {result['copy_bandwidth'] / 1e9:.1f} GB/s, "
        f"{result['share_of_copy_bandwidth']:.0%} of it used; {result['bytes_per_point']:.0f} bytes a point"
    )
    if "over_plain" in result:
        console.print(f"{result['over_plain']:.2f} times the plain driver, on one thread")


@app.command()
def study(
    name: Annotated[str, typer.Argument(help=f"A folder with a {FILE}, or the name of one in ./studies.")],
    quick: Annotated[bool, typer.Option(help="The coarse, short form.")] = False,
    only: Annotated[list[str] | None, typer.Option(help="A group or figure of the campaign.")] = None,
    jobs: Annotated[int, typer.Option(min=1, max=256, help="Runs at a time; they share the cores.")] = 1,
    output: Annotated[Path, typer.Option("-o", "--output", help="Where the runs are kept.")] = Path(
        "runs/studies"
    ),
) -> None:
    """Run a campaign: a scene with swept keys. What is there is not run again; what fails stops nothing."""
    folder = next((f for f in (Path(name), Path("studies") / name) if (f / FILE).exists()), Path(name))
    campaign = load(folder)
    wanted = cases(campaign, folder, quick=quick, only=only or [])
    try:
        outcomes = run_study(wanted, output, jobs=jobs, console=console)
    except KeyboardInterrupt:
        console.print("interrupted: what is done is kept, the same command goes on", style="yellow")
        raise typer.Exit(130) from None
    console.print(summary(outcomes, campaign.title or name))
    table = (output if quick else folder) / f"results{'-quick' if quick else ''}.csv"
    older = write_results(outcomes, output, table, cases(campaign, folder, quick=quick, only=[]))
    console.print(f"wrote {shown(table, MAX_PATH)}")
    if older:
        console.print(
            literal(
                f"{older} of its rows were of an older version or physics and are gone; the command without --only "
                "makes them again",
                "yellow",
            )
        )
    if campaign.report:
        make_report(folder / campaign.report, table, output)
    if failed := sum(bool(o.fault) for o in outcomes):
        console.print(f"{failed} of {len(outcomes)} runs failed", style="red")
        raise typer.Exit(1)


def _version(value: bool) -> None:
    if value:
        print(__version__)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Give the options of every command."""


def main() -> None:
    """Run the command line: a user's mistake is one sentence and exit code 2."""
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
