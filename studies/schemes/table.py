"""The table of numerical schemes: `python studies/schemes/table.py [--only COLUMN] [--scheme NAME] [--quick] [--fine]`.

What is in table.csv already, of this version, physics and scheme, is not measured again: to do so after a change of
these scripts, remove its rows. Every measure has a time limit; a run that met it goes on from its checkpoint the next
time. table.md is drawn from table.csv.
"""

import argparse
import itertools
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import kept
from columns import COLUMNS, Column, Condition, label
from render import render
from schemes import SCHEMES, overrides

from pockmark import PockmarkError, Scene

HERE = Path(__file__).parent


class OutOfTime(Exception):  # noqa: N818
    """A measure took longer than it may."""


def main() -> None:
    """Measure what is asked for and not there yet, and draw the table after each column."""
    asked = _arguments()
    asked.out.mkdir(parents=True, exist_ok=True)
    name = "table-quick" if asked.quick else "table"
    path = asked.out / f"{name}.csv"
    rows = kept.read(path)
    schemes = _known(asked.scheme)
    for column, scheme in itertools.product(asked.only or COLUMNS, schemes):
        for condition in _conditions(COLUMNS[column], quick=asked.quick, fine=asked.fine):
            row = rows.get((scheme, column, label(condition)))
            if row and row.is_fresh:
                continue
            row = _measured(scheme, column, condition, asked)
            rows[row.key] = row
            kept.write(path, rows)
            print(
                f"{scheme}, {column}, {row.condition}: {row.fault or row.values} ({row.seconds} s)",
                flush=True,
            )
    path.with_suffix(".md").write_text(render(rows.values()), encoding="utf-8")


def _arguments() -> argparse.Namespace:
    """Return the words of the command line."""
    parser = argparse.ArgumentParser(description="Compare numerical schemes.")
    parser.add_argument("--only", action="append", choices=list(COLUMNS), help="a column; may be repeated")
    parser.add_argument("--scheme", action="append", choices=list(SCHEMES), help="a scheme; may be repeated")
    parser.add_argument("--quick", action="store_true", help="coarse and short, into table-quick.csv")
    parser.add_argument("--fine", action="store_true", help="with the conditions that take hours")
    parser.add_argument("--limit", type=float, default=900.0, help="the seconds that a measure may take")
    parser.add_argument("-o", "--out", type=Path, default=HERE, help="the folder of the table")
    return parser.parse_args()


def _known(asked: Sequence[str] | None) -> list[str]:
    """Return the schemes asked for that this version has, and say of the others why it has not."""
    known = []
    for scheme in asked or SCHEMES:
        try:
            Scene.load(HERE.parents[1] / "examples" / "quick.toml", overrides(SCHEMES[scheme]))
            known.append(scheme)
        except PockmarkError as error:
            print(f"{scheme}: left out: {error}")
    return known


def _conditions(column: Column, *, quick: bool, fine: bool) -> Sequence[Condition]:
    """Return the conditions of a column that are asked for."""
    return column.quick if quick else [*column.conditions, *(column.fine if fine else ())]


def _measured(scheme: str, column: str, condition: Condition, asked: argparse.Namespace) -> kept.Row:
    """Return the row of a measure, with its numbers or with why there are none."""
    values, fault, start = {}, "", time.perf_counter()
    place = {"runs": asked.out / "runs"} if COLUMNS[column].keeps_runs else {}
    try:
        with _at_most(asked.limit):
            values = COLUMNS[column].measure(SCHEMES[scheme], **condition, **place)
    except OutOfTime:
        fault = f"{kept.OUT_OF_TIME} {asked.limit:g} s"
    except (PockmarkError, RuntimeError) as error:  # the core says so where a step collapses
        fault = str(error)
    return kept.row_of((scheme, column, condition), values, fault, time.perf_counter() - start)


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    """Raise OutOfTime after some seconds. Until then runs hear it as Ctrl-C, and keep a checkpoint."""
    is_over = False

    def stop(_number: int, _frame: object) -> None:
        nonlocal is_over
        is_over = True
        signal.raise_signal(signal.SIGINT)

    old = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    except KeyboardInterrupt:
        if is_over:
            raise OutOfTime from None
        raise
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, old)


if __name__ == "__main__":
    main()
