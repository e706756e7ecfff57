"""A hundred periods of an elastic bar held at one end: energy and period. `studies/schemes` has all schemes."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "studies" / "schemes"))
import bar
from schemes import CELLS, PIC, QUADRATIC, TRILINEAR

DAMPED = "a share of PIC takes energy out of every motion, the resolved one too"
CASES = [
    pytest.param({}, id="default"),
    pytest.param(TRILINEAR, id="trilinear"),
    pytest.param(CELLS, id="cells"),
    pytest.param(QUADRATIC, id="quadratic"),
    pytest.param(PIC, id="pic", marks=pytest.mark.xfail(strict=True, reason=DAMPED)),
]


@pytest.mark.parametrize("changes", CASES)
def test_a_hundred_periods_keep_the_energy(changes):
    got = bar.measure(changes, cells=16, periods=100)
    print(got)
    assert abs(got["energy_change"]) < 0.02


def test_the_period_converges_to_the_closed_form():
    """4 L / sqrt(E / rho), to second order."""
    off = [bar.measure({}, cells=cells, periods=100)["period_off"] for cells in (8, 16)]
    print(
        f"period off by {off[0]:+.2e} and {off[1]:+.2e} with 8 and 16 cells, order {np.log2(off[0] / off[1]):.2f}"
    )
    assert abs(off[1]) < 0.002
    assert 1.7 < np.log2(off[0] / off[1]) < 2.3
