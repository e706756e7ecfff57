"""`pockmark bench`: how fast the step is on this machine."""

from typing import Annotated

import typer
from rich.table import Table

from ..base.errors import PockmarkError
from ..base.json import to_json
from ..run.bench import bench as run_bench
from ..run.bench import bench_scene
from ..run.simulation import thread_count
from .common import CONSOLE, Overrides, Threads


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
    CONSOLE.print(table)
    CONSOLE.print(
        f"{result['particle_steps_per_second'] / 1e6:.2f} M particle-steps/s on {result['threads']} threads "
        f"({result['isa']}); copy bandwidth {result['copy_bandwidth'] / 1e9:.1f} GB/s, "
        f"{result['share_of_copy_bandwidth']:.0%} of it used; {result['bytes_per_point']:.0f} bytes a point"
    )
    CONSOLE.print(f"{result['over_plain']:.2f} times the plain driver, on one thread")
