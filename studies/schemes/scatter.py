"""How the points of a state differ from what the grid sees of them: their pressures and their velocities."""

import sys
from pathlib import Path

import numpy as np
from scipy.ndimage import uniform_filter

sys.path.insert(0, str(Path(__file__).parents[1] / "convergence"))
from ringing import kinetic, of_blocks

from pockmark.run.store import RunFolder

REACH = 45e-6  # m from where the projectile hit


def pressure_scatter(folder: RunFolder) -> dict[str, float]:
    """Return the rms (MPa) of the points' pressure about their cell's mean, and of the means about their 27 neighbours'.

    Of the intact points of the target near the crater, in the last snapshot. Only cells whose neighbours all have
    points count for the second.
    """
    state, cell = folder.last_snapshot(), folder.scene().grid.cell
    place, damage, body = (state[name] for name in ("position", "damage", "body"))
    chosen = (body == 0) & (damage < 1) & (np.linalg.norm(place, axis=1) < REACH)
    pressure, at = state["pressure"][chosen].astype(float), _cells(place[chosen], cell)
    counts, sums = np.zeros((2, *(at.max(axis=0) + 2)))
    np.add.at(counts, tuple(at.T), 1)
    np.add.at(sums, tuple(at.T), pressure)
    mean = sums / np.maximum(counts, 1)
    is_inner = uniform_filter((counts > 0).astype(float), 3, mode="constant") > 1 - 1e-9
    between = (mean - uniform_filter(mean, 3, mode="constant"))[is_inner]
    within = pressure - mean[tuple(at.T)]
    return {"within_MPa": _rms(within) / 1e6, "between_MPa": _rms(between) / 1e6}


def kinetic_shares(folder: RunFolder) -> dict[str, float]:
    """Return the kinetic energy at the end over the initial energy, and the shares of it that cells see.

    What a cell sees is the motion of its mean velocity; a cube of two cells sees less.
    """
    state, cell = folder.last_snapshot(), folder.scene().grid.cell
    x, m, v = (state[name].astype(float) for name in ("position", "mass", "velocity"))
    whole = kinetic(m, v)
    return {
        "kinetic": whole / float(folder.history("initial")["initial"][0]),
        "seen_by_cells": of_blocks(x, m, v, cell) / whole,
        "seen_by_two_cells": of_blocks(x, m, v, 2 * cell) / whole,
    }


def _cells(position: np.ndarray, cell: float) -> np.ndarray:
    """Return the cells (n, 3) of places, counted from 1 so that none lies at the edge of an array."""
    at = np.floor(position / cell + 1e-9).astype(int)
    return np.asarray(at - at.min(axis=0) + 1)


def _rms(values: np.ndarray) -> float:
    """Return the root of the mean square; NaN without values."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")
