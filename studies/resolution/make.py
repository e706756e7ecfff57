"""What error a run's cells make, from converged studies: writes src/pockmark/run/resolution.toml.

python studies/resolution/make.py: an hour on two cores. What is there in runs/resolution is not run again. Only
measures that converge by their own order are kept.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from pockmark import PHYSICS, Scene, __version__
from pockmark.base.files import write_text
from pockmark.base.toml import to_toml
from pockmark.run.provenance import commit
from pockmark.run.resolution import FILE, MEASURES, kind_of
from pockmark.run.simulation import thread_count
from pockmark.scene.warnings import cells_across
from pockmark.study.convergence import Finding, cases_of, findings, sentence
from pockmark.study.levels import plan_of
from pockmark.study.processes import Processes
from pockmark.study.runner import run_study

ROOT = Path(__file__).parents[2]
COMMAND = "python studies/resolution/make.py"
SCENE = ROOT / "examples" / "normal-2200.toml"
SPEEDS = ("1 km/s", "2.2 km/s", "4.5 km/s", "7 km/s")
LEVELS, BUDGET = 5, 900.0  # s a speed
RUNS = ROOT / "runs" / "resolution"


def main() -> None:
    """Run the studies, and write what converged."""
    console, studies = Console(), []
    for speed in SPEEDS:
        scene = Scene.load(SCENE, [f"impact.speed='{speed}'"])
        plan = plan_of(scene, most=LEVELS, budget=BUDGET, threads=thread_count(0))
        found = findings(plan, run_study(cases_of(plan), RUNS, pool=Processes(1), console=console))
        for finding in found:
            console.print(f"{speed}: {sentence(finding)}")
        if measures := converged(found, [level.scene for level in plan.levels]):
            own = plan.levels[plan.own].scene
            kept = {"speed": own.impact.speed, "geometry": own.grid.geometry, "kind": kind_of(own)}
            studies.append(kept | measures)
    write_text(ROOT / "src" / "pockmark" / "run" / FILE, text_of(studies))


def converged(found: Sequence[Finding], scenes: Sequence[Scene]) -> dict[str, Any]:
    """Return the errors of each measure that converges, by its key, on the cells that have a value."""
    across = {scene.grid.cell: cells_across(scene) for scene in scenes}
    table = {}
    for finding in found:
        if finding.quantity.key not in MEASURES or finding.limit is None or finding.limit.kind != "converges":
            continue
        errors = [finding.error(value) for value in finding.values]
        table[finding.quantity.key] = {
            "cells_across": [across[cell] for cell in finding.cells],
            "errors": [error[0] for error in errors if error],
            "uncertainties": [error[1] for error in errors if error],
        }
    return table


def text_of(studies: Sequence[dict[str, Any]]) -> str:
    """Return the text of the file, with what made it."""
    made_by = {"version": __version__, "physics": PHYSICS, "commit": str(commit() or ""), "command": COMMAND}
    return to_toml(made_by | {"study": list(studies)})


if __name__ == "__main__":
    main()
