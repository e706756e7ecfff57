"""The first mode of a fixed-free elastic bar: frequency, and how the error falls with the cell."""

import numpy as np
import pytest
from builders import FIXED, FREE, PRECISIONS, SYMMETRY, by_id, elastic, lattice, options, solver

YOUNG, DENSITY, LENGTH = 100.0, 1.0, 25.0
OMEGA = np.pi / 2 / LENGTH * np.sqrt(YOUNG / DENSITY)  # 0.628319
AMPLITUDE = 1e-4  # of the wave speed: linear


def frequency(cells, scheme, shape, single=False):
    """Angular frequency of the mean velocity over one period, from its zero crossings."""
    h = LENGTH / cells
    position = lattice((0, 0, 0), (2 * cells, 1, 1), (h / 2, h, h))
    v = np.zeros_like(position)
    v[:, 0] = 10 * AMPLITUDE * np.sin(np.pi / 2 * position[:, 0] / LENGTH)
    s = solver(
        (0, 0, 0),
        h,
        (cells + 1, 1, 1),
        [FIXED, FREE] + [SYMMETRY] * 4,
        [elastic(YOUNG, 0.0, DENSITY)],
        options(scheme, shape, cfl=0.2),
        [(position, v, h**3 / 2, DENSITY, 0)],
        single=single,
    )
    period = 2 * np.pi / OMEGA
    times, momenta = [0.0], [s.ledger()["momentum_x"]]
    for t in np.linspace(0, 1.1 * period, 400)[1:]:
        s.advance(10**6, t)
        times.append(t)
        momenta.append(s.ledger()["momentum_x"])
    p, t = np.array(momenta), np.array(times)
    down = np.flatnonzero((p[:-1] > 0) & (p[1:] <= 0))[0]
    up = np.flatnonzero((p[:-1] < 0) & (p[1:] >= 0))[0]
    zero = [t[i] + (t[i + 1] - t[i]) * p[i] / (p[i] - p[i + 1]) for i in (down, up)]
    return np.pi / (zero[1] - zero[0])


@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
@PRECISIONS
def test_frequency_converges(scheme, single):
    cells = (8, 16, 32)
    errors = [frequency(n, scheme, "trilinear", single) / OMEGA - 1 for n in cells]
    rates = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    print(
        f"{scheme}: frequency off by {', '.join(f'{e:+.3e}' for e in errors)} for {cells} cells; rates {rates.round(2)}"
    )
    assert abs(errors[-1]) < 1e-3
    assert rates.min() > 1.7  # second order in space; the step falls with the cell


def test_quadratic_splines():
    error = frequency(32, "usavg", "quadratic") / OMEGA - 1
    print(f"quadratic: frequency off by {error:+.3e}")
    assert abs(error) < 0.01


def struck(width, shape, volume):
    """The velocities (m/s), in their order, of the points of a bar `width` cells thick, mirrors on its sides, and its ledger's error."""
    cells, h = 8, LENGTH / 8
    position = lattice((0, 0, 0), (2 * cells, 2 * width, 2 * width), h / 2)
    v = np.zeros_like(position)
    v[:, 0] = 10 * AMPLITUDE * np.sin(np.pi / 2 * position[:, 0] / LENGTH)
    s = solver(
        (0, 0, 0),
        h,
        (cells + 1, width, width),
        [FIXED, FREE] + [SYMMETRY] * 4,
        [elastic(YOUNG, 0.0, DENSITY)],
        options("usavg", shape, volume=volume),
        [(position, v, h**3 / 8, DENSITY, 0)],
    )
    s.advance(400, 1e9)
    ledger = s.ledger()
    return by_id(s, "velocity").reshape(2 * cells, -1, 3), ledger["error"] / ledger["initial"]


@pytest.mark.parametrize("volume", ["points", "cells"])
@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
def test_a_bar_one_cell_thick_between_mirrors_is_one_of_two_cells(shape, volume):
    """What lies behind a mirror is then the image of nodes on the mirror across."""
    (thin, error), (thick, _) = struck(1, shape, volume), struck(2, shape, volume)
    size = np.abs(thick).max()
    print(f"{shape}, {volume}: ledger {error:.1e}, sideways {np.abs(thin[..., 1:]).max() / size:.1e}")
    assert abs(error) < 1e-12
    assert np.abs(thin[..., 1:]).max() < 1e-10 * size
    assert np.abs(thin - thick[:, :4]).max() < 1e-10 * size
