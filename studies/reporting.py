"""What the studies' figures share: the rows of a campaign's table, figures, tables, checked statements."""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from rich.console import Console
from rich.table import Table

from pockmark.base.units import to_si
from pockmark.run.pictures import plot_process
from pockmark.view.canvas import blank, plain_axes


class Row:
    """A run: its swept keys, and its measures by their name in `crater.`."""

    def __init__(self, cells: Mapping[str, str]) -> None:
        """Read a line of the table that `pockmark study` wrote."""
        self.cells = cells
        self.speed = to_si(cells["impact.speed"], "m/s")
        self.angle = round(math.degrees(to_si(cells["impact.angle"], "rad")), 6)
        self.friction = float(cells["contact.friction"]) if cells.get("contact.friction") else None
        flux = cells.get("body.swarm.flux")
        self.flux = to_si(flux, "kg/m^2") if flux else None
        self.fault = cells["fault"]
        self.groups = cells["groups"].split()
        self.scene = cells["scene"]

    def get(self, key: str) -> float | None:
        """Return a measure of the crater, or of the group ("group.mode"), SI, None if there is none."""
        text = self.cells.get(key if "." in key and key in self.cells else f"crater.{key}")
        return float(text) if text else None

    def __getitem__(self, key: str) -> float:
        """Return a measure that must be there."""
        value = self.get(key)
        if value is None:
            raise KeyError(f"{self.label}: has no {key}")
        return value

    def spread(self, key: str) -> float:
        """Return the uncertainty of a measure; of a ratio without its own that of C_p in it; 0 where it is not known."""
        own = self.get(f"uncertainty.{key}")
        return own if own is not None else self[key] * (self.get("uncertainty.depth") or 0.0) / self["depth"]

    @property
    def label(self) -> str:
        """What was swept."""
        friction = "" if self.friction is None else f", friction {self.friction:g}"
        flux = "" if self.flux is None else f", {self.flux * 100:g} mg/cm2"
        return f"{self.speed:g} m/s, {self.angle:g} deg{friction}{flux}"


def read_results(path: Path) -> list[Row]:
    """Return the rows of a campaign's table, by angle and speed."""
    with path.open(newline="", encoding="utf-8") as file:
        return sorted(
            map(Row, csv.DictReader(file)), key=lambda row: (row.angle, row.speed, row.friction or 0)
        )


@contextmanager
def figure(path: Path, x: str, y: str) -> Iterator[Axes]:
    """Give axes that become a PNG."""
    drawing = blank((6.4, 4.4))
    yield plain_axes(drawing, x, y)
    drawing.savefig(path, dpi=120)


def write_rows(path: Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Write a CSV table; what a row has no value for stays empty."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(dict.fromkeys(key for row in rows for key in row)), restval="")
        writer.writeheader()
        writer.writerows(rows)


def made_by(cells: Mapping[str, str]) -> dict[str, str]:
    """Return the version, the physics and the commit of a run, for its row in another table."""
    return {name: cells[name] for name in ("version", "physics", "commit")}


def write_table(
    path: Path,
    rows: Sequence[Row],
    keys: Sequence[str],
    extra: Mapping[str, Sequence[float | None]] | None = None,
) -> None:
    """Write angle, speed and measures (SI) with their uncertainties, a row a run, and what version made it."""
    known = [f"uncertainty.{key}" for key in keys if any(r.get(f"uncertainty.{key}") for r in rows)]
    table: list[dict[str, object]] = []
    for i, row in enumerate(rows):
        values = {key: row.get(key) for key in (*keys, *known)}
        values |= {name: of[i] for name, of in (extra or {}).items()}
        shown = {name: "" if value is None else f"{value:.5g}" for name, value in values.items()}
        table.append(
            {"angle_deg": f"{row.angle:g}", "speed_m/s": f"{row.speed:g}"} | shown | made_by(row.cells)
        )
    write_rows(path, table)


def process_figures(rows: Sequence[Row], runs: Path, out: Path, names: Mapping[int, str]) -> None:
    """Draw stress and pressure of the runs of the group `panels` that are there, named by their angle in degrees."""
    for row in rows:
        if "panels" in row.groups and (runs / row.scene).exists():
            plot_process(runs / row.scene).savefig(out / names[round(row.angle)], dpi=100)


@dataclass(frozen=True)
class Statement:
    """Something that the paper says, whether our runs say it too, and the numbers."""

    source: str
    text: str
    holds: bool
    numbers: str


def keep_statements(statements: Sequence[Statement], path: Path) -> None:
    """Print them, and write them as a table."""
    table = Table("paper", "statement", "holds", "numbers", title="What the paper says")
    for s in statements:
        table.add_row(s.source, s.text, "[green]yes[/green]" if s.holds else "[red]no[/red]", s.numbers)
    Console(width=160).print(table)
    write_rows(
        path,
        [
            {
                "paper": s.source,
                "statement": s.text,
                "holds": "yes" if s.holds else "no",
                "numbers": s.numbers,
            }
            for s in statements
        ],
    )
