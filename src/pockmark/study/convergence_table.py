"""The tables of a convergence study: for the terminal, and as files."""

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from .. import PHYSICS, __version__
from ..base.files import make_folder, replaced, write_text
from ..base.json import to_json
from ..base.lengths import in_metres
from ..base.terminal import literal
from ..run.resolution import kind_of
from .convergence import Finding, figure, order_told, sentence, unit_of
from .levels import Plan
from .runner import Outcome


def table_of(plan: Plan, found: Sequence[Finding], title: str) -> Table:
    """Return a table with a row for each cell, its errors beside the values, and one for the limit.

    A star marks the cells that were asked for.
    """
    table = Table("cell", title=literal(title, "table.title"))
    units = [unit_of(finding) for finding in found]
    for finding, (unit, _) in zip(found, units, strict=True):
        table.add_column(f"{finding.quantity.name} ({unit})" if unit else finding.quantity.name)
    for place, level in enumerate(plan.levels):
        shown = (_value(f, level.cell, size) for f, (_, size) in zip(found, units, strict=True))
        table.add_row(in_metres(level.cell) + (" *" if place == plan.own else ""), *shown)
    table.add_section()
    table.add_row("limit", *(_limit(f, size) for f, (_, size) in zip(found, units, strict=True)))
    table.add_row("order", *(_order(finding) for finding in found))
    return table


def _value(finding: Finding, cell: float, size: float) -> str:
    """Return the value on a cell (m) in a unit's size, and its error; "-" where there is none."""
    value = finding.on(cell)
    if value is None:
        return "-"
    error = finding.error(value)
    return figure(value / size) + (f"  {error[0]:+.1%}" if error else "")


def _limit(finding: Finding, size: float) -> str:
    """Return a limit in a unit's size, with half of its interval as a share."""
    limit = finding.limit
    if limit is None or not limit.is_known:
        return "not known"
    share = limit.uncertainty / abs(limit.value) if limit.value else 0.0
    return f"{figure(limit.value / size)} +-{share:.1%}"


def _order(finding: Finding) -> str:
    """Return the order by which a limit is known; "-" without one."""
    limit = finding.limit
    return "-" if limit is None or limit.order is None else f"{limit.order:.2f}"


def as_json(plan: Plan, found: Sequence[Finding], outcomes: Sequence[Outcome]) -> str:
    """Return a study as JSON, SI: what was run, each quantity's limit, and what the runs are a study of."""
    own = plan.levels[plan.own]
    levels = [
        {
            "cell": level.cell,
            "cells_across": level.expected.cells_across,
            "points": level.expected.points,
            "scene": level.scene.hash,
            "fault": outcome.fault,
            "doubts": (outcome.result or {}).get("doubts", []),
            "warnings": (outcome.result or {}).get("warnings", []),
        }
        for level, outcome in zip(plan.levels, outcomes, strict=True)
    ]
    return to_json(
        {
            "version": __version__,
            "physics": PHYSICS,
            "why_3d": plan.why_3d,
            "own_cell": own.cell,
            "kind": kind_of(own.scene),
            "levels": levels,
            "quantities": {finding.quantity.key: _quantity_json(finding) for finding in found},
        }
    )


def _quantity_json(finding: Finding) -> dict[str, Any]:
    """Return what was found of a quantity as plain tables, SI."""
    limit = finding.limit
    errors = [finding.error(value) for value in finding.values]
    return {
        "name": finding.quantity.name,
        "cells": finding.cells,
        "values": finding.values,
        "readings": finding.readings,
        "errors": [error and error[0] for error in errors],
        "error_uncertainties": [error and error[1] for error in errors],
        "missing": finding.missing,
        "limit": limit and limit.value if limit and limit.is_known else None,
        "uncertainty": limit and limit.uncertainty,
        "kind": limit and limit.kind,
        "observed_order": limit and limit.observed,
        "order": limit and limit.order,
        "order_told": limit and order_told(limit),
        "sentence": sentence(finding),
    }


def write_files(plan: Plan, found: Sequence[Finding], outcomes: Sequence[Outcome], out: Path) -> list[Path]:
    """Write converge.csv and converge.json into a folder, and return their paths. Raises PockmarkError."""
    table, text = out / "converge.csv", out / "converge.json"
    make_folder(out)
    write_text(text, as_json(plan, found, outcomes) + "\n")
    with (
        replaced(table) as descriptor,
        open(descriptor, "w", newline="", encoding="utf-8", closefd=False) as file,
    ):
        rows = csv.writer(file)
        rows.writerow(
            ("quantity", "cell", "value", "reading_uncertainty", "error", "limit", "uncertainty", "order")
        )
        for finding in found:
            rows.writerows(_rows(finding))
    return [table, text]


def _rows(finding: Finding) -> Iterator[list[Any]]:
    """Give a row for each cell of a quantity, SI; what is not known is empty."""
    limit = finding.limit if finding.limit and finding.limit.is_known else None
    known = [limit.value, limit.uncertainty, limit.order] if limit else [None] * 3
    for cell, value, reading in zip(finding.cells, finding.values, finding.readings, strict=True):
        error = finding.error(value)
        yield [finding.quantity.name, cell, value, reading, error and error[0], *known]
