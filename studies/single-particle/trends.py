"""What Section 3 of Liu et al. 2015 says of single craters, as statements that our runs either bear out or do not.

A rise or fall counts where it is larger than the uncertainties of both values, and "about" and "nearly" mean within a
cell of the background grid (2 um) for lengths, and .1 for ratios.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

from reporting import Row, Statement

from pockmark.laws.equations import volume_energy

CELL = 2e-6  # m, of model 3
ABOUT = 0.1
Pair = tuple[str, bool]


def statements(rows: Sequence[Row]) -> list[Statement]:
    """Return the statements for which there are runs."""
    swept = [row for row in rows if row.friction is None and "panels" not in row.groups]
    by_angle = {angle: [row for row in swept if row.angle == angle] for angle in (0, 15, 30)}
    out = []
    if len(normal := by_angle[0]) > 1:
        out += _of_normal(normal)
    if len(by_angle[15]) > 1 and len(by_angle[30]) > 1:
        out += _of_oblique(by_angle)
    if frictional := [row for row in rows if row.friction is not None]:
        out += _of_friction(frictional, by_angle[30])
    return out


def _of_normal(rows: Sequence[Row]) -> list[Statement]:
    factor = "depth_over_diameter"
    last = rows[-1]
    equation = {row.speed: row["depth_over_projectile_diameter"] / equation_22(row.speed) for row in rows}
    low = {v: share for v, share in equation.items() if v <= 1500}
    high = {v: share for v, share in equation.items() if v >= 4500}
    return [
        _rises("Fig. 6", "C_p/D_c rises with the speed", rows, factor),
        Statement(
            "Fig. 6", "C_p/D_c ends at about 1/2", abs(last[factor] - 0.5) <= ABOUT, f"{last[factor]:.3f}"
        ),
        Statement(
            "Fig. 7", "C_p/d_p is below Eq. 22 up to 1.5 km/s", all(s < 1 for s in low.values()), _shares(low)
        ),
        Statement(
            "Fig. 7",
            "C_p/d_p is within 10 % of Eq. 22 from 4.5 km/s on",
            all(abs(s - 1) <= 0.1 for s in high.values()),
            _shares(high),
        ),
        Statement(
            "Fig. 7",
            "C_p/d_p comes closer to Eq. 22 with the speed",
            all(
                abs(equation[b.speed] - 1) <= abs(equation[a.speed] - 1) + _relative(a) + _relative(b)
                for a, b in pairwise(rows)
            ),
            _shares(equation),
        ),
    ]


def _of_oblique(by_angle: dict[int, list[Row]]) -> list[Statement]:
    oblique = [*by_angle[15], *by_angle[30]]
    names = {"depth": "C_p", "major_axis": "D_max", "minor_axis": "D_min"}
    out = []
    for key, name in names.items():
        found = [_rises("", "", by_angle[angle], key) for angle in (15, 30)]
        numbers = "; ".join(f"{angle} deg: {s.numbers}" for angle, s in zip((15, 30), found, strict=True))
        out.append(Statement("Fig. 9", f"{name} rises with the speed", all(s.holds for s in found), numbers))
    shapes = {"depth_over_major_axis": "C_p/D_max", "depth_over_minor_axis": "C_p/D_min"}
    return [
        *out,
        _compared(
            "Fig. 9", "C_p is smaller at a larger angle", by_angle, (0, 15, 30), "depth", lambda a, b: b < a
        ),
        _compared(
            "Fig. 9",
            "D_max is larger at 30 than at 15 deg",
            by_angle,
            (15, 30),
            "major_axis",
            lambda a, b: b > a,
        ),
        _compared(
            "Fig. 9",
            "D_min is nearly the same",
            by_angle,
            (15, 30),
            "minor_axis",
            lambda a, b: abs(b - a) <= CELL,
        ),
        _each(
            "Fig. 10",
            "C_xb and C_xs are very close",
            oblique,
            lambda row: (
                f"{(row['bottom_x'] - row['centre_x']) * 1e6:+.1f} um",
                abs(row["bottom_x"] - row["centre_x"]) <= CELL,
            ),
        ),
        _each(
            "Fig. 11",
            "e1 fluctuates around zero",
            oblique,
            lambda row: (f"{row['e1']:+.3f}", abs(row["e1"]) <= ABOUT),
        ),
        *(_rises_then_falls(by_angle[angle]) for angle in (15, 30)),
        _compared(
            "Fig. 11", "e2 is larger at 30 than at 15 deg", by_angle, (15, 30), "e2", lambda a, b: b > a
        ),
        *(
            _compared(
                "Fig. 12",
                f"{name} is smaller at a larger angle",
                by_angle,
                (0, 15, 30),
                key,
                lambda a, b: b < a,
            )
            for key, name in shapes.items()
        ),
        *(
            _each(
                "Fig. 12",
                f"{name} ends at about 1/2",
                [by_angle[15][-1], by_angle[30][-1]],
                lambda row, key=key: (f"{row[key]:.3f}", abs(row[key] - 0.5) <= ABOUT),
            )
            for key, name in shapes.items()
        ),
    ]


def _of_friction(frictional: Sequence[Row], oblique: Sequence[Row]) -> list[Statement]:
    runs = [*frictional, *(row for row in oblique if row.speed == frictional[0].speed)]
    out = []
    for key, name in {"depth": "C_p", "major_axis": "D_max"}.items():
        values = [row[key] for row in runs]
        spread = max(values) - min(values)
        out.append(
            Statement(
                "Fig. 4",
                f"friction .05 to .9 and sticky contact leave {name} within a cell",
                spread <= CELL,
                f"{min(values) * 1e6:.2f} to {max(values) * 1e6:.2f} um",
            )
        )
    return out


def _relative(row: Row) -> float:
    """Return the uncertainty of C_p over Eq. 22's."""
    return row.spread("depth_over_projectile_diameter") / equation_22(row.speed)


def equation_22(speed: float) -> float:
    """Return C_p/d_p of the volume-energy formula for the paper's aluminium, speed in m/s."""
    return volume_energy(speed, projectile_density=2770, target_strength=265e6)


def _shares(of: dict[float, float]) -> str:
    return ", ".join(f"{share:.2f} at {v / 1e3:g}" for v, share in of.items()) + " km/s"


def _rises(source: str, text: str, rows: Sequence[Row], key: str) -> Statement:
    """Return whether no value falls below the one before by more than both uncertainties."""
    falls = [(a, b) for a, b in pairwise(rows) if b[key] < a[key] - a.spread(key) - b.spread(key)]
    ends = " to ".join(_number(row[key]) for row in (rows[0], rows[-1]))
    where = "".join(f", falls from {a.speed:g} to {b.speed:g} m/s" for a, b in falls)
    return Statement(source, text, not falls and rows[-1][key] > rows[0][key], ends + where)


def _rises_then_falls(rows: Sequence[Row]) -> Statement:
    top = max(rows, key=lambda row: row["e2"])
    ends = [rows[0]["e2"], top["e2"], rows[-1]["e2"]]
    return Statement(
        "Fig. 11",
        f"e2 rises with the speed and then falls, {rows[0].angle:g} deg",
        top is not rows[0] and top is not rows[-1],
        f"{ends[0]:.3f}, {ends[1]:.3f} at {top.speed:g} m/s, {ends[2]:.3f}",
    )


def _compared(
    source: str,
    text: str,
    by_angle: dict[int, list[Row]],
    angles: Sequence[int],
    key: str,
    right: Callable[[float, float], bool],
) -> Statement:
    """Return whether a measure compares so from each angle to the next, at every speed."""
    wrong, close, total = [], 0, 0
    for first, second in pairwise(angles):
        other = {row.speed: row for row in by_angle[second]}
        for row in by_angle[first]:
            if row.speed not in other:
                continue
            total += 1
            a, b = row[key], other[row.speed][key]
            if right(a, b):
                continue
            if abs(a - b) <= row.spread(key) + other[row.speed].spread(key):
                close += 1
            else:
                wrong.append(f"{row.speed:g} m/s: {_number(a)} at {first}, {_number(b)} at {second} deg")
    within = f", {close} the other way within the uncertainties" if close else ""
    numbers = f"{total - close - len(wrong)} of {total}{within}" + "".join(f"; {w}" for w in wrong)
    return Statement(source, text, not wrong, numbers)


def _each(source: str, text: str, rows: Sequence[Row], judge: Callable[[Row], Pair]) -> Statement:
    judged = [(row, *judge(row)) for row in rows]
    numbers = ", ".join(f"{shown} ({row.label})" for row, shown, good in judged if not good)
    held = sum(good for *_, good in judged)
    return Statement(
        source,
        text,
        held == len(judged),
        f"{held} of {len(judged)}" + (f"; not {numbers}" if numbers else ""),
    )


def _number(value: float) -> str:
    """Print lengths in um, ratios as they are."""
    return f"{value * 1e6:.2f} um" if value < 1e-2 else f"{value:.3f}"
