"""The impacts of Tables 2 and 3 (Liu et al. 2015) as quarter models: crater, energies, scatter, faults."""

import math
from pathlib import Path

from scatter import kinetic_shares, pressure_scatter
from schemes import Changes, overrides
from shock import hugoniot

from pockmark import PockmarkError, Scene, measure, resume_run, run_scene
from pockmark.run.pipeline import can_resume
from pockmark.run.store import RunFolder
from pockmark.study.runner import is_done

EXAMPLES = Path(__file__).parents[2] / "examples"


def single_ball(
    changes: Changes,
    *,
    runs: Path,
    cell_um: float,
    half_um: float,
    end_ns: float,
    precision: str = "double",
) -> dict[str, float]:
    """Return what the impact of Table 2 leaves at its end, in a target of 2 half_um x 2 half_um x half_um."""
    changed = _quarter(cell_um, half_um, end_ns)
    changed |= {"body.projectile.spacing": f"{cell_um / 4} um", "numerics.precision": precision}
    return _of_a_run(_scene("normal-2200.toml", changed, changes), runs)


def group(changes: Changes, *, runs: Path, cell_um: float) -> dict[str, float]:
    """Return what the group of Table 3, at 4.5 km/s, leaves at 500 ns."""
    changed = _quarter(cell_um, 100, 500)
    changed |= {"body.swarm.spacing": f"{cell_um / 4} um", "body.swarm.lower": ["0 um", "0 um"]}
    return _of_a_run(_scene("group-4500.toml", changed, changes), runs)


def _quarter(cell_um: float, half_um: float, end_ns: float) -> dict[str, object]:
    """Return the changes that make a quarter of an example, with whole cells along each side.

    A cell of the target holds 2 x 2 x 2 points.
    """
    side, up = (math.ceil(length / cell_um) * cell_um for length in (half_um, half_um / 2))
    lower = ["0 um", "0 um", f"{-side} um"]
    return {
        "end_time": f"{end_ns} ns",
        "grid.lower": lower,
        "grid.upper": [f"{side} um", f"{side} um", f"{up} um"],
        "grid.cell": f"{cell_um} um",
        "boundary.x_lower": "symmetry",
        "body.target.lower": lower,
        "body.target.upper": [f"{side} um", f"{side} um", "0 um"],
        "body.target.spacing": f"{cell_um / 2} um",
        "output.snapshots": f"{end_ns} ns",
    }


def _scene(example: str, changed: dict[str, object], changes: Changes) -> Scene:
    """Return an example with what is changed, and a scheme. Python writes texts and lists as TOML does."""
    return Scene.load(
        EXAMPLES / example, [f"{key}={value!r}" for key, value in changed.items()] + overrides(changes)
    )


def _of_a_run(scene: Scene, runs: Path) -> dict[str, float]:
    """Return the measures of a scene's run, which is made if it is not there: a folder named by its hash.

    Raises KeyboardInterrupt if it was stopped; it goes on from there when it is asked for again.
    """
    path = runs / scene.hash
    if not is_done(path):
        _run(scene, path)
    folder, table = RunFolder.open(path), measure(path)
    shock, _ = hugoniot(scene, scene.impact.speed)
    energy, run, counters = table["energy"], table["run"], table["counters"]
    return {
        "C_p_um": _micrometres(table["crater"]["depth"]),
        "D_c_um": _micrometres(table["crater"]["diameter"]),
        "E_i^r": energy["residual_internal"],
        "absorbed": energy["absorbed"],
        "ledger_error": energy["ledger_error"],
        **kinetic_shares(folder),
        **pressure_scatter(folder),
        "largest_compression": run["max_compression"],
        "of_Hugoniot": run["max_compression"] * (1 - scene.impact.speed / 2 / shock),
        "negative_energies": counters["negative_energies"],
        "points": run["points"],
        "steps": run["steps"],
    }


def _run(scene: Scene, path: Path) -> None:
    """Run a scene, from its checkpoint if it was stopped. Raises KeyboardInterrupt if it is stopped.

    Raises PockmarkError where the run fails, without the name of its folder.
    """
    try:
        if can_resume(path, scene):
            is_finished = resume_run(path, threads=1, progress=False).is_finished
        else:
            _, is_finished = run_scene(scene, path, threads=1, force=True, progress=False, coarse=True)
    except PockmarkError as error:
        raise PockmarkError(str(error).removeprefix(f"{path}: ")) from None
    if not is_finished:
        raise KeyboardInterrupt


def _micrometres(length: float | None) -> float:
    """Return a length (m) in um; NaN for one that there is not."""
    return float("nan") if length is None else length / 1e-6
