"""`pockmark check`: what a scene will take, before anything runs."""

from rich.table import Table

from ..base.terminal import literal
from ..run.simulation import thread_count
from ..scene.forecast import forecast
from ..scene.scene import Scene
from .common import CONSOLE, Overrides, SceneFile, Threads


def check(scene: SceneFile, overrides: Overrides = None, threads: Threads = 0) -> None:
    """Forecast points, cells, steps, memory and time of a scene, and what hits how hard, before anything runs."""
    loaded = Scene.load(scene, overrides or ())
    expected = forecast(loaded, thread_count(threads))
    table = Table(show_header=False, title=literal(loaded.title or scene, "table.title"))
    table.add_row("points", f"{expected.points:,}")
    table.add_row("cells", f"{expected.cells:,}")
    if expected.cells_across is not None:
        table.add_row("cells across the projectile", f"{expected.cells_across:.3g}")
    for row in expected.impact:
        table.add_row(*row)
    table.add_row("steps, about", f"{expected.steps:,}")
    table.add_row("memory at its peak", f"{expected.memory / 2**20:,.0f} MiB")
    table.add_row("disk", f"at most {expected.disk / 1e6:,.0f} MB")
    table.add_row("time, about", f"{expected.seconds:,.0f} s on {thread_count(threads)} threads")
    CONSOLE.print(table)
    for warning in expected.warnings:
        CONSOLE.print(literal("warning:", "yellow"), literal(warning))
