"""Running a campaign.

A run is made once, and kept by the hash of its scene and the physics. What fails stops nothing.
"""

import csv
import itertools
import json
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError
from ..base.files import make_folder, replaced, told
from ..base.lengths import in_metres, unit_for
from ..base.terminal import literal
from ..run.measured import measure_run
from ..run.stop import heard_between_steps
from ..run.store import RunFolder
from ..scene.forecast import forecast
from .campaign import Case
from .making import is_done
from .order import order_for
from .pace import PACE, every
from .pool import Pool
from .progress import Watched, bars_of


@dataclass
class Outcome:
    """A case that is done: its results, or why there are none.

    `kept` is true if the run was there already.
    """

    case: Case
    result: dict[str, Any] | None
    fault: str = ""
    kept: bool = False

    @property
    def is_doubtful(self) -> bool:
        """Return whether the run's numbers are worth little, as its table says first."""
        return bool((self.result or {}).get("doubts"))

    @property
    def standing(self) -> str:
        """Return why there is no result, or what it is worth; empty without doubts and warnings."""
        if self.result is None:
            return self.fault
        said = ["doubtful"] if self.is_doubtful else []
        if count := len(self.result.get("warnings", ())):
            said.append(f"{count} warning{'s' if count > 1 else ''}")
        return ", ".join(said)


def run_study(
    cases: Sequence[Case], out: Path, *, pool: Pool, console: Console, coarse: bool = False
) -> list[Outcome]:
    """Let a pool make the runs of the cases that are not there yet, and return the outcomes of all.

    A case with fewer than four cells across a projectile runs only if `coarse` allows it. Ctrl-C, SIGTERM and SIGHUP
    raise KeyboardInterrupt; what is done is then kept, and nothing runs any more.
    """
    there = [case for case in cases if is_done(place(out, case))]
    to_make = [case for case in cases if case not in there]
    outcomes = [_measured(case, out, kept=True) for case in there]
    orders = [order_for(case.scene.to_dict(), place(out, case), coarse=coarse) for case in to_make]
    runs = [_watched(case, out) for case in to_make]
    start = f"{len(outcomes)} of {len(cases)} runs were there"
    with bars_of(console, runs, start) as bars, heard_between_steps() as stop_if_asked:
        look = every(PACE, bars.look)

        def between() -> None:
            stop_if_asked()
            look()

        for n, fault in pool.finished(orders, between):
            case = to_make[n]
            outcomes.append(Outcome(case, None, fault) if fault else _measured(case, out))
            failed = sum(bool(o.fault) for o in outcomes)
            bars.end(n, f"{len(outcomes)} of {len(cases)} runs" + (f", {failed} failed" if failed else ""))
            console.print(line_of(outcomes[-1]))
    return sorted(outcomes, key=lambda o: cases.index(o.case))


def _watched(case: Case, out: Path) -> Watched:
    """Return what the bars need to know of a run. One thread is as good as many: the runs' times are only compared."""
    return Watched(case.label, place(out, case), case.scene.end_time, forecast(case.scene, 1).seconds)


def _measured(case: Case, out: Path, *, kept: bool = False) -> Outcome:
    """Return the outcome of a run that is there. If it cannot be measured, the outcome says why."""
    try:
        return Outcome(case, measure_run(place(out, case)), kept=kept)
    except PockmarkError as error:
        return Outcome(case, None, str(error), kept=kept)


def place(out: Path, case: Case) -> Path:
    """Return the folder of a case's run."""
    return out / case.scene.hash


def summary(outcomes: Sequence[Outcome], title: str) -> Table:
    """Return a table with a row for each run. Its lengths are in the unit that suits the largest of all."""
    lengths = [_lengths(outcome) for outcome in outcomes]
    unit, size = unit_for(*itertools.chain(*lengths))
    table = Table("run", f"C_p ({unit})", f"D_c ({unit})", "E_i^r", "", title=literal(title, "table.title"))
    for outcome, both in zip(outcomes, lengths, strict=True):
        shown = ["-" if length is None else f"{length / size:.4g}" for length in both]
        residual = (outcome.result or {}).get("energy", {}).get("residual_internal")
        shown.append("-" if residual is None else f"{residual:.4f}")
        said = ", ".join(text for text in ("was there" if outcome.kept else "", outcome.standing) if text)
        table.add_row(literal(outcome.case.label), *shown, literal(said, _style(outcome)))
    return table


def write_results(outcomes: Sequence[Outcome], out: Path, path: Path, campaign: Sequence[Case] = ()) -> int:
    """Write a row for each run in `out`: swept keys, groups, every measure (SI), and what made the run.

    Rows of the campaign's other runs stay if they are of this version and physics. Returns how many rows were older
    and are gone.
    """
    rows: list[Mapping[str, Any]] = [
        outcome.case.swept
        | {"groups": " ".join(outcome.case.groups), "fault": outcome.fault, "scene": outcome.case.scene.hash}
        | dict(_flat(outcome.result or {}))
        | _made_by(place(out, outcome.case))
        for outcome in outcomes
    ]
    order = {case.scene.hash: i for i, case in enumerate(campaign)}
    others = _rows_of_others(path, order.keys() - {outcome.case.scene.hash for outcome in outcomes})
    kept = [row for row in others if (row.get("version"), row.get("physics")) == (__version__, str(PHYSICS))]
    rows = sorted([*rows, *kept], key=lambda row: order.get(row["scene"], 0))
    columns = dict.fromkeys(key for row in rows for key in row)
    make_folder(path.parent)
    with (
        replaced(path) as descriptor,
        open(descriptor, "w", newline="", encoding="utf-8", closefd=False) as file,
    ):
        writer = csv.DictWriter(file, list(columns), restval="")
        writer.writeheader()
        writer.writerows(rows)
    return len(others) - len(kept)


def _rows_of_others(path: Path, others: Set[str]) -> list[dict[str, str]]:
    """Return the rows of a results file whose scenes are among `others`. Raises PockmarkError."""
    if not path.exists():
        return []
    with told(path), path.open(newline="", encoding="utf-8") as file:
        try:
            return [row for row in csv.DictReader(file) if row.get("scene") in others]
        except (csv.Error, UnicodeDecodeError) as error:
            raise PockmarkError(f"{path}: is not a table of pockmark's ({error})") from None


def make_report(script: Path, table: Path, runs: Path) -> None:
    """Run a campaign's own script, which draws beside the table. Raises PockmarkError if the script fails."""
    done = subprocess.run(
        [sys.executable, str(script), str(table), str(runs), str(table.parent)], check=False
    )
    if done.returncode:
        raise PockmarkError(f"{script}: failed; {table} and the runs are kept")


def _made_by(folder: Path) -> dict[str, str]:
    """Return version, physics and commit of what made a run; empty texts for a run that never began.

    They may be older than what measures it.
    """
    try:
        manifest = RunFolder(folder).manifest()
    except PockmarkError:
        manifest = {}
    names = {"version": "pockmark", "physics": "physics", "commit": "commit"}
    return {column: str(manifest.get(key) or "") for column, key in names.items()}


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Give the keys of nested tables, joined by dots, with their values: ("crater.depth", 1.5e-5), ...

    Lists become JSON. Lists of tables, such as a group's craters one by one, are left out.
    """
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{key}.")
        elif not isinstance(value, list):
            yield f"{prefix}{key}", value
        elif not (value and isinstance(value[0], Mapping)):
            yield f"{prefix}{key}", json.dumps(value)


def line_of(outcome: Outcome) -> Text:
    """Return the line that is printed as a run ends: its crater, and what it is worth."""
    said = [outcome.standing]
    if outcome.result is not None:
        depth, diameter = ("-" if length is None else in_metres(length) for length in _lengths(outcome))
        said[:0] = [f"C_p {depth}", f"D_c {diameter}"]
        said += outcome.result.get("doubts", [])[:1]
    return literal(f"{outcome.case.label}: {', '.join(text for text in said if text)}", _style(outcome))


def _style(outcome: Outcome) -> str:
    """Return the colour of a run's line: red for failed or doubtful, yellow with warnings, else none."""
    if outcome.fault or outcome.is_doubtful:
        return "bold red"
    return "yellow" if outcome.standing else ""


def _lengths(outcome: Outcome) -> tuple[float | None, float | None]:
    """Return the depth and the diameter of the crater, m; None for each that is not known."""
    crater = (outcome.result or {}).get("crater", {})
    return crater.get("depth"), crater.get("diameter")
