"""The limit of a measure: against power laws that are known, with and without noise, and where there is none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pockmark.metrology.limit import LARGEST_ORDER, LEAST_ORDER, limit_of

COVERED = 0.95  # the share of intervals that are said to hold the limit
TRIALS = 200


def cells(number, ratio, coarsest=4e-6):
    return coarsest / ratio ** np.arange(number)


def of(h, f, reading=0.0):
    found = limit_of(h, f, np.broadcast_to(reading, len(h)))
    print(f"{np.asarray(f)} -> {found}")
    return found


@settings(max_examples=200, deadline=None)
@given(
    limit=st.floats(0.5, 2).map(lambda x: x * 1e-5),
    change=st.floats(0.02, 0.9),
    sign=st.sampled_from([-1, 1]),
    order=st.floats(LEAST_ORDER + 0.01, LARGEST_ORDER - 0.01),
    number=st.integers(3, 6),
    ratio=st.floats(1.3, 2),
)
def test_a_power_law_is_found_again(limit, change, sign, order, number, ratio):
    h = cells(number, ratio)
    found = of(h, limit * (1 + sign * change * (h / h[0]) ** order))
    assert found.kind == "converges"
    assert found.value == pytest.approx(limit, rel=1e-4 * change)
    assert found.order == found.observed == pytest.approx(order, abs=1e-3)
    assert found.at(h) == pytest.approx(limit * (1 + sign * change * (h / h[0]) ** order), rel=1e-6)


def test_on_clean_values_the_interval_is_the_grid_convergence_index():
    """Celik et al. 2008, Table 1, the case of 18000, 4500 and 980 cells in two dimensions."""
    found = of(1 / np.sqrt([18000, 4500, 980]), [10.7880, 10.7250, 10.6050])
    assert found.observed == pytest.approx(0.75, abs=0.005)
    assert found.value == pytest.approx(10.8801, abs=0.001)
    assert found.uncertainty / 10.7880 == pytest.approx(0.011, abs=0.0005)


@pytest.mark.parametrize("number", [2, 3, 4, 5])
@pytest.mark.parametrize("ratio", [1.3, 2.0])
@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01, 0.03])
def test_intervals_hold_the_limit_as_often_as_is_said(number, ratio, noise):
    """Noise is of each reading and as large as is told, in parts of the limit on the coarsest cell."""
    random = np.random.default_rng(number)
    h = cells(number, ratio)
    share = h / h[0]
    hits = []
    for _ in range(TRIALS):
        order, change = random.uniform(0.7, 1.8), random.choice([-1, 1]) * random.uniform(0.05, 0.4)
        reading = noise * share
        found = limit_of(h, 1 + change * share**order + reading * random.normal(size=number), reading)
        if found.kind != "unknown":  # whose interval promises nothing
            hits.append(abs(found.value - 1) <= found.uncertainty)
    print(f"{np.mean(hits):.3f} of {len(hits)} intervals hold the limit")
    assert len(hits) > TRIALS / 2
    assert np.mean(hits) >= COVERED


def test_of_noise_that_no_reading_tells_an_interval_holds_the_limit_less_often():
    """Of four cells the scatter tells some of it: nine in ten, which docs/converge.md says."""
    random = np.random.default_rng(4)
    h = cells(4, 2.0)
    hits = []
    for _ in range(4 * TRIALS):
        order, change = random.uniform(0.7, 1.8), random.choice([-1, 1]) * random.uniform(0.05, 0.4)
        found = limit_of(h, 1 + change * (h / h[0]) ** order + 0.01 * random.normal(size=4), 0 * h)
        hits.append(abs(found.value - 1) <= found.uncertainty)
    print(f"{np.mean(hits):.3f} of {len(hits)} intervals hold the limit")
    assert 0.85 <= np.mean(hits) < COVERED


@pytest.mark.parametrize("number", [3, 4])
def test_two_powers_at_once_are_within_the_interval(number):
    random = np.random.default_rng(5)
    h = cells(number, 2.0)
    share = h / h[0]
    for second in random.uniform(-0.5, 1, TRIALS):
        found = limit_of(h, 1 + 0.2 * share + 0.2 * second * share**2, 0 * h)
        assert abs(found.value - 1) <= found.uncertainty, found


@pytest.mark.parametrize(
    ("values", "kind", "observed"),
    [
        ([14.63, 17.36, 20.16], "unknown", "below 0"),  # changes that do not shrink
        ([10, 11, 13, 17], "unknown", "below 0"),
        ([10, 12, 10, 12], "unknown", "any"),  # neither rising nor falling
        ([10, 12, 10.1], "unknown", "any"),
        ([14.3, 17.5, 18.0], "limited", "above 2"),  # the paper's C_p
        ([10, 11, 11.8, 12.5], "limited", "below 0.5"),
        ([10, 12, 11, 11.5], "limited", "any"),  # an oscillation that dies away
    ],
)
def test_what_is_no_clean_power_law_is_told(values, kind, observed):
    found = of(cells(len(values), 2), values)
    assert found.kind == kind
    assert found.observed is not None
    assert {
        "below 0": found.observed < 0,
        "below 0.5": 0 < found.observed < 0.5,
        "above 2": found.observed > 2,
        "any": True,
    }[observed]
    change = np.diff(values)
    assert found.turns == bool(change.min() < 0 < change.max())
    if kind == "unknown":
        assert found.order is None
        assert found.value == values[-1]
        assert found.uncertainty == 3 * np.ptp(values)
    else:
        assert found.order in (LEAST_ORDER, LARGEST_ORDER)
        # An order that is not believed costs a factor of safety of 3 on the change that it predicts.
        assert found.uncertainty >= 3 * abs(found.value - found.at(cells(len(values), 2))[-1])


def test_an_oscillation_that_dies_away_is_within_the_interval():
    h = cells(4, 2)
    found = of(h, 12 - 2 * np.array([1, -0.5, 0.25, -0.125]))
    assert abs(found.value - 12) <= found.uncertainty
    assert found.turns


def test_two_cells_give_first_order_and_a_wide_interval():
    found = of([4e-6, 2e-6], [14.0, 16.0])
    assert (found.kind, found.observed, found.order) == ("assumed", None, 1.0)
    assert found.value == pytest.approx(18.0)
    assert found.uncertainty == pytest.approx(3 * 2.0)


@pytest.mark.parametrize("number", [2, 3, 4])
def test_values_that_do_not_differ_are_their_limit(number):
    found = of(cells(number, 2), [0.9] * number, 0.01)
    assert (found.kind, found.value, found.order) == ("same", 0.9, None)
    assert found.uncertainty == pytest.approx(0.02)
    assert found.at(cells(3, 2)) == pytest.approx([0.9] * 3)


def test_the_order_of_the_cells_and_the_unit_do_not_matter():
    h, f, u = (
        np.array([1.0, 2.0, 3.0, 4.0]),
        np.array([17.83, 17.37, 16.39, 15.42]),
        np.array([0.1, 0.2, 0.3, 0.4]),
    )
    a, b = limit_of(h, f, u), limit_of(h[::-1] * 1e-6, f[::-1] * 1e-6, u[::-1] * 1e-6)
    assert (b.value, b.uncertainty) == pytest.approx((a.value * 1e-6, a.uncertainty * 1e-6), rel=1e-6)
    assert b.order == pytest.approx(a.order, abs=1e-6)


def test_a_reading_widens_the_interval():
    h = cells(4, 2)
    widths = [limit_of(h, 1 - 0.2 * h / h[0], u * h).uncertainty for u in (0, 1e3, 1e4)]
    assert widths == sorted(widths)
    assert widths[0] == pytest.approx(1.25 * 0.2 / 8, rel=1e-4)
    assert widths[2] > 1.1 * widths[0]


@pytest.mark.parametrize("h", [[], [1.0], [1.0, 1.0]])
def test_one_cell_has_no_limit(h):
    with pytest.raises(ValueError, match="two different cells"):
        limit_of(h, [1.0] * len(h), [0.0] * len(h))
