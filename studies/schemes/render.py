"""The table as a page: a line a scheme, then each column with all its conditions."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence

from columns import COLUMNS, label
from kept import Row, settings_of
from schemes import SCHEMES
from shock import FRAMES

Cells = Sequence[str]
NONE = ""  # in a cell of what was not measured
STOPPED = "stopped"  # in a cell of a run that did not come to its end


def render(rows: Iterable[Row]) -> str:
    """Return the page of some rows, in Markdown."""
    by_column = {name: [row for row in rows if row.column == name] for name in COLUMNS}
    everything = [row for of in by_column.values() for row in of]
    schemes = [name for name in SCHEMES if any(row.scheme == name for row in everything)]
    parts = [
        "# Numerical schemes compared\n",
        "Drawn by `python studies/schemes/table.py` from `table.csv`. `--only COLUMN` measures one column, `--scheme NAME` one scheme.\n",
        _grid(["scheme", "settings"], [[name, f"`{settings_of(name)}`"] for name in schemes]),
        "## A line a scheme\n",
        _summary(schemes, by_column),
    ]
    for name, of in by_column.items():
        if of:
            parts += [f"## {COLUMNS[name].title}\n", f"`--only {name}`\n", _section(name, of)]
    return "\n".join([*parts, *_old(everything)])


def _old(rows: Sequence[Row]) -> list[str]:
    """Return a sentence that names the rows of an older physics than the newest; nothing without such rows."""
    newest = max((int(row.physics) for row in rows), default=0)
    old = dict.fromkeys(f"{row.scheme} {row.column}" for row in rows if int(row.physics) < newest)
    return [f"Of an older physics than {newest}: {', '.join(old)}.\n"] if old else []


def _summary(schemes: Sequence[str], by_column: dict[str, list[Row]]) -> str:
    """Return the table with a line a scheme: of each column what decides."""
    shown = {head: of for head, of in SUMMARY.items() if by_column[of[0]]}

    def cells(scheme: str) -> Iterator[str]:
        for column, cell in shown.values():
            yield cell([row for row in by_column[column] if row.scheme == scheme])

    return _grid(["scheme", *shown], [[scheme, *cells(scheme)] for scheme in schemes])


def _worst(measure: str, exact: float) -> Callable[[Sequence[Row]], str]:
    """Return what gives, for each number of points, the value furthest from the exact one and how many runs stopped."""

    def cell(rows: Sequence[Row]) -> str:
        return "; ".join(
            _worst_of([row for row in rows if row.condition.startswith(f"points {points},")], measure, exact)
            for points in dict.fromkeys(row.condition.split(",")[0].removeprefix("points ") for row in rows)
        )

    return cell


def _worst_of(rows: Sequence[Row], measure: str, exact: float) -> str:
    """Return the value furthest from the exact one, and how many runs stopped."""
    values = [row.numbers[measure] for row in rows if not row.fault]
    said = (
        [_short(max(values, key=lambda x: abs(x - exact) if math.isfinite(x) else math.inf))]
        if values
        else []
    )
    stopped = sum(bool(row.fault) for row in rows)
    return ", ".join([*said, *([f"{stopped} of {len(rows)} {STOPPED}"] if stopped else [])])


def _each(*measures: str) -> Callable[[Sequence[Row]], str]:
    """Return what gives some measures at each condition, in their order."""

    def cell(rows: Sequence[Row]) -> str:
        return "; ".join(" / ".join(_number(row, m) for m in measures) for row in rows)

    return cell


# Head of the column, the column that it is of, what its cell says of a scheme's rows.
SUMMARY: dict[str, tuple[str, Callable[[Sequence[Row]], str]]] = {
    "shock: p / p_RH, the worst at 1; 2; 4 points a cell edge": ("shock", _worst("pressure", 1.0)),
    "its largest scatter": ("shock", _worst("scatter", 0.0)),
    "disk: change of angular momentum / of radius": (
        "disk",
        _each("angular_momentum_change", "radius_change"),
    ),
    "bar: change of energy": ("bar", _each("energy_change")),
    "bar: period off": ("bar", _each("period_off")),
    "Table 2: C_p um": ("crater", _each("C_p_um")),
    "E_i^r": ("crater", _each("E_i^r")),
    "rho/rho0": ("crater", _each("largest_compression")),
    "settled: within / between MPa": ("settled", _each("within_MPa", "between_MPa")),
    "kinetic, and its share that cells see": ("settled", _each("kinetic", "seen_by_cells")),
    "group: C_p um / E_i^r": ("group", _each("C_p_um", "E_i^r")),
    "time of a step / trilinear's": ("cost", _each("of_trilinear")),
}


def _section(name: str, rows: Sequence[Row]) -> str:
    """Return all of a column."""
    if name == "shock":
        return "\n".join(_shocks(rows, measure) for measure in ("pressure", "scatter"))
    measures = list(dict.fromkeys(measure for row in rows for measure in row.numbers))
    lines = [
        [row.scheme, row.condition, *(_number(row, measure) for measure in measures), row.fault]
        for row in rows
    ]
    return _grid(["scheme", "condition", *measures, ""], lines)


def _shocks(rows: Sequence[Row], measure: str) -> str:
    """Return a measure of the shocks: a line for each number of points and scheme, a column for each speed."""
    found = {(row.scheme, row.condition): row for row in rows}
    named = {row.condition for row in rows}
    shock = COLUMNS["shock"]
    asked = [condition for condition in [*shock.conditions, *shock.quick] if label(condition) in named]
    schemes = dict.fromkeys(row.scheme for row in rows)
    numbers, speeds = (dict.fromkeys(c[key] for c in asked) for key in ("points", "speed_m_s"))

    def cell(scheme: str, *of: str | float) -> str:
        here = [found.get((scheme, label(c))) for c in asked if (c["points"], c["speed_m_s"]) == of]
        return " ".join(_number(row, measure) for row in here if row)

    lines = [
        [scheme, f"{points}", *(cell(scheme, points, speed) for speed in speeds)]
        for points in numbers
        for scheme in schemes
    ]
    told = f"{measure.capitalize()}, at rest: {', '.join(FRAMES)}; with none the shocked material is.\n"
    return f"{told}\n{_grid(['scheme', 'points', *(f'{speed:g} m/s' for speed in speeds)], lines)}"


def _number(row: Row, measure: str) -> str:
    """Return a measure of a row as a cell."""
    return STOPPED if row.fault else _short(row.numbers[measure]) if measure in row.numbers else NONE


def _short(value: float) -> str:
    """Return a number in three digits, one of a thousand or more without decimals."""
    if not math.isfinite(value):
        return "-"
    text = f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
    return text.replace("0.", ".", 1) if text.lstrip("-").startswith("0.") else text


def _grid(heads: Cells, lines: Iterable[Cells]) -> str:
    """Return a table in Markdown."""
    rows = [heads, ["---"] * len(heads), *lines]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)
