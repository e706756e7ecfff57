"""The page of a run, of several or of a campaign: data in, one HTML text out that needs no other file and no network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..base.errors import PockmarkError, shown
from .comparison import Compared
from .crater3d import View3d

Rows = Sequence[tuple[str, str]]


class MaterialSheet(NamedTuple):
    """A material of a run: name, names of its bodies, source, and rows of its constants (key, value, meaning)."""

    name: str
    bodies: str
    source: str
    constants: Sequence[tuple[str, str, str]]


class Energy(NamedTuple):
    """Where a part of the energy is: what it is, J, and as a share of the initial energy."""

    name: str
    what: str
    joules: float
    share: float | None


@dataclass(frozen=True)
class RunReport:
    """All that the page of a run shows. Pictures are addresses of data, texts are a reader's.

    `cautions`, `doubts`, `warnings` and the counters among `parts` come first. `no_view` says why there is no view in three dimensions, `no_film` why
    there is no animation.
    """

    title: str
    folder: str
    standing: str
    cautions: Sequence[str]
    doubts: Sequence[str]
    warnings: Sequence[str]
    parts: Mapping[str, Rows]
    compared: Sequence[Compared]
    was_run: Rows
    materials: Sequence[MaterialSheet]
    energies: Sequence[Energy]
    pictures: Mapping[str, str]
    view: View3d | None
    no_view: str
    film: str | None
    no_film: str
    reproduced: Rows
    command: str
    scene: str


class Line(NamedTuple):
    """A line of a comparison: a name, a text for each run, and whether these differ."""

    name: str
    texts: Sequence[str]
    differs: bool


@dataclass(frozen=True)
class Comparison:
    """Several runs beside one another: what each was, the lines by part, and pictures."""

    names: Sequence[str]
    notes: Sequence[tuple[str, str]]
    parts: Mapping[str, Sequence[Line]]
    figure: str
    slices: Sequence[str]


class Cell(NamedTuple):
    """A cell of a table that is sorted: what is shown, and the number it is sorted by, None for a text."""

    text: str
    value: float | None = None


@dataclass(frozen=True)
class CampaignReport:
    """A campaign: its table, what is wrong with its runs, plots, and the slices of some runs by name."""

    title: str
    table: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    notes: Sequence[str]
    figures: Sequence[str]
    slices: Sequence[tuple[str, str]]
    no_slices: str


def run_page(report: RunReport, made_by: str) -> str:
    """Return the page of a run; `made_by` says by what and when. Raises PockmarkError where Jinja2 is missing."""
    return _page("run.html", report=report, made_by=made_by)


def comparison_page(report: Comparison, made_by: str) -> str:
    """Return the page of several runs. Raises PockmarkError where Jinja2 is missing."""
    return _page("comparison.html", report=report, made_by=made_by)


def campaign_page(report: CampaignReport, made_by: str) -> str:
    """Return the page of a campaign. Raises PockmarkError where Jinja2 is missing."""
    return _page("campaign.html", report=report, made_by=made_by)


def require_jinja() -> Any:
    """Return the module jinja2. Raises PockmarkError where it is missing."""
    try:
        import jinja2
    except ImportError:
        raise PockmarkError("Jinja2 is not installed: pip install 'pockmark[report]'") from None
    return jinja2


def _page(template: str, **data: Any) -> str:
    """Return a template filled with data, in which each text is escaped."""
    jinja2 = require_jinja()
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("pockmark.view"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["shown"] = lambda text: shown(text, 400)
    environment.filters["number"] = lambda value: "-" if value is None else f"{value:.4g}"
    return str(environment.get_template(template).render(**data))
