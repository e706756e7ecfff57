"""The results of a run as a table for the terminal."""

from collections.abc import Iterator, Mapping
from typing import Any

from rich.table import Table

from ..base.counters import COUNTERS
from ..base.lengths import unit_for
from ..base.terminal import literal
from ..metrology.modes import ROMAN

Results = Mapping[str, Any]


def report(result: Results) -> Table:
    """Return the table that `pockmark run` and `measure` print."""
    table = Table(show_header=False, title="Crater")
    for sentence in result["doubts"]:
        table.add_row(literal("doubtful", "bold red"), literal(sentence, "bold red"))
    for sentence in result["warnings"]:
        table.add_row(literal("warning", "yellow"), literal(sentence, "yellow"))
    table.add_section()
    for rows in parts(result).values():
        for name, value in rows:
            table.add_row(literal(name), literal(value))
        table.add_section()
    return table


def parts(result: Results) -> dict[str, list[tuple[str, str]]]:
    """Return the rows of each part of the table, names and values as a reader sees them."""
    makers = {"crater": _crater, "group": _group, "ejecta": _ejecta, "energy": _energy, "run": _run}
    return {name: [*make(result)] for name, make in (makers | {"counters": _counted}).items()}


def standing(status: str, time: float, snapshot_time: float, torn_rows: int) -> str:
    """Return how a run that has not ended stands (times in s); an empty text for one that has ended."""
    if status not in ("running", "killed"):
        return ""
    torn = "; a torn last row of its history is left out" if torn_rows else ""
    return f"{status} at {time * 1e9:.4g} ns; the last snapshot is of {snapshot_time * 1e9:.4g} ns{torn}"


def _shown(value: float | None, pattern: str, *, unit: float = 1.0) -> str:
    """Return a number in multiples of `unit`; "-" for None."""
    return "-" if value is None else pattern.format(value / unit)


def _crater(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows of the crater or of the hole."""
    crater, run = result["crater"], result["run"]
    stands = standing(run["status"], run["time"], crater["time"], run["torn_rows"]) or run["status"]
    yield "run", stands + _shown(run["end_time"], " (to end at {:.4g} ns)", unit=1e-9)
    yield "crater at", _shown(crater["time"], "{:.4g} ns", unit=1e-9)
    known = crater["uncertainty"] or {}

    def length(key: str) -> str:
        value, spread = crater[key], known.get(key)
        unit, size = unit_for(value, spread)
        around = "" if spread is None else _shown(spread, " +- {:.2f}", unit=size)
        return _shown(value, f"{{:.2f}}{around} {unit}", unit=size)

    if crater["perforated"]:
        yield "crater", "none: perforated"
        yield "holes", str(crater["holes"])
        yield "least width of the widest hole", length("hole_width")
        where = [crater[f"hole_{axis}"] for axis in "xyz"]
        unit, size = unit_for(*where, crater["hole_width"])
        yield "  there, at x, y, z", ", ".join(_shown(x, "{:z.1f}", unit=size) for x in where) + f" {unit}"
        yield from _resolution(result)
        return
    if crater["depth"] is None:
        yield "crater", "none"
        return
    yield "depth C_p", length("depth")
    yield "  change in the last tenth", _shown(crater["depth_change_last_tenth"], "{:.1%}")
    yield "diameter D_c", length("diameter")
    yield "D_max", length("major_axis")
    yield "D_min", length("minor_axis")
    yield "e1, e2", ", ".join(_shown(crater[key], "{:z.3f}") for key in ("e1", "e2"))
    yield "rim height", length("rim_height")
    yield "rim diameter, crest to crest", length("rim_diameter")
    yield "lining of projectile", _shown(crater["lining_fraction"], "{:.0%} of it")
    unit, size = unit_for(crater["volume"], power=3)
    yield "volume", _shown(crater["volume"], f"{{:.5g}} {unit}", unit=size)
    yield "C_p/d_p", _shown(crater["depth_over_projectile_diameter"], "{:.3f}")
    yield "C_p/D_c", _shown(crater["depth_over_diameter"], "{:.3f}")
    yield from _resolution(result)


def _resolution(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows that say how far the measures can be trusted."""
    yield "+-", "of the measure on these points alone; the error of the cells' size is not in it"
    across = _shown(result["run"]["cells_across_projectile"], "{:.3g} cells across the projectile")
    yield "resolution", f"{across}; {_cell_error(result['resolution'])}"


def _cell_error(resolution: Results) -> str:
    """Return by how much the cells' size puts the measures off, as far as that is known."""
    names = {"depth": "C_p", "diameter": "D_c", "residual_internal": "E_i^r"}
    known = {name: resolution[key] for key, name in names.items() if resolution[key] is not None}
    if not known:
        return "their error is unknown, for no converged study is of this kind (pockmark converge makes one)"
    told = ", ".join(f"{name} {100 * error:.2g} %" for name, error in known.items())
    studies = resolution["studies"]
    return f"their error is about {told}, from {studies} converged stud{'ies' if studies > 1 else 'y'}"


def _group(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows of a group of craters; none without a group."""
    if not (group := result.get("group")):
        return
    yield (
        "craters, pitheads, bottoms",
        ", ".join(str(group[key]) for key in ("craters", "pitheads", "bottoms")),
    )
    if group["holes"]:
        yield "balls that went through", str(group["holes"])
    if "mode" not in group:
        return
    mode, nearest = (ROMAN[group[key] - 1] for key in ("mode", "nearest_mode"))
    yield (
        "mode of the group",
        f"{mode} (next: {nearest}, if a measure changed by {group['distance_to_it']:.0%})",
    )
    spread = f"{group['depth_spread']:.0%} between the deepest and the shallowest"
    unit, size = unit_for(group["depth_mean"])
    yield "their mean depth", _shown(group["depth_mean"], f"{{:.2f}} {unit}, {spread}", unit=size)


def _ejecta(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows of the ejecta."""
    ejecta = result["ejecta"]
    masses = (_shown(ejecta[key], "{:.3g}", unit=1e-12) for key in ("mass", "left_mass"))
    yield "ejecta in the grid, left", ", ".join(masses) + " ng"
    yield "momentum enhancement beta", _shown(ejecta["beta"], "{:.4f}")


def _energy(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows of the energies."""
    energy = result["energy"]

    def share(*keys: str) -> str:
        return ", ".join(_shown(energy[key], "{:.4f}") for key in keys)

    yield "energies at", _shown(result["run"]["time"], "{:.4g} ns, as shares of the initial one", unit=1e-9)
    yield "residual internal E_i^r", share("residual_internal")
    yield "  in the grid, left", share("internal", "left_internal")
    yield "  of it by bulk viscosity", share("viscous")
    yield "kinetic in the grid, left", share("kinetic", "left_kinetic")
    yield "absorbed by faces", share("absorbed")
    for key, name in (("pic", "PIC"), ("contact", "contact and friction")):
        if energy[key]:
            yield f"taken by {name}", share(key)
    yield "sum - 1: ledger error", _shown(energy["ledger_error"], "{:+z.2%}")


def _run(result: Results) -> Iterator[tuple[str, str]]:
    """Give the rows of the run itself."""
    run = result["run"]
    yield "failure treatment", str(run["failure_treatment"])
    by_cells = ", volumetric strain by cells" if run.get("volumetric_strain") == "cells" else ""
    linear = ", linear velocities at the nodes" if run.get("node_velocity") == "linear" else ""
    every = run.get("filter_interval")
    filtered = f", filtered every {every} steps" if every else ""
    yield "scheme", f"{run['scheme']}, {run['shape_functions']}{by_cells}{linear}{filtered}"
    yield "largest rho/rho0", _shown(run["max_compression"], "{:.3f}")
    rate = _shown(run["particle_steps_per_second"], "{:.2f} M particle-steps/s", unit=1e6)
    yield "size", f"{run['points']:,} points, {run['steps']:,} steps, {rate}"


def _counted(result: Results) -> Iterator[tuple[str, str]]:
    """Give a row for each counter that is not zero."""
    counted = {name: count for name, count in result["counters"].items() if count}
    if not counted:
        yield "counted", "nothing"
    for name, count in counted.items():
        yield name, f"{count:,} {COUNTERS[name].what if name in COUNTERS else ''}"
