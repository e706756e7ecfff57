"""How much of the kinetic energy at the end is motion within a few cells, which no wave and no ejecta carries."""

import numpy as np

from pockmark.run.store import RunFolder


def ringing(folder: RunFolder) -> list[dict[str, object]]:
    """Return a row for each kind of point: its kinetic energy (of the initial one) and that of the means of cubes of two cells."""
    points = folder.last_snapshot()
    initial = float(folder.history()["initial"][0])
    scene = folder.scene()
    found: list[dict[str, object]] = []
    for body, kind in ((1, "projectile"), (0, "target")):
        for failed in (False, True):
            chosen = (points["body"] == body) & ((points["damage"] >= 1) == failed)
            if not chosen.any():
                continue
            x, m, v = (points[name][chosen].astype(float) for name in ("position", "mass", "velocity"))
            found.append(
                {
                    "points_of": f"{kind}, {'failed' if failed else 'intact'}",
                    "points": len(m),
                    "kinetic_over_initial": f"{kinetic(m, v) / initial:.4f}",
                    "of_blocks_of_two_cells": f"{of_blocks(x, m, v, 2 * scene.grid.cell) / initial:.4f}",
                    "rms_speed_m_s": f"{np.sqrt(2 * kinetic(m, v) / m.sum()):.0f}",
                    "mean_velocity_z_m_s": f"{(m * v[:, 2]).sum() / m.sum():.1f}",
                }
            )
    return found


def kinetic(mass: np.ndarray, velocity: np.ndarray) -> float:
    """Return the sum of m v^2 / 2 (J)."""
    return float(0.5 * (mass[:, None] * velocity**2).sum())


def of_blocks(position: np.ndarray, mass: np.ndarray, velocity: np.ndarray, size: float) -> float:
    """Return the kinetic energy (J) of the mean velocities of cubes of edge `size` (m)."""
    key = np.floor(position / size).astype(int)
    key -= key.min(axis=0)
    _, cube = np.unique(np.ravel_multi_index(tuple(key.T), tuple(key.max(axis=0) + 1)), return_inverse=True)
    momentum = np.stack([np.bincount(cube, mass * velocity[:, a]) for a in range(3)])
    return float((0.5 * (momentum**2).sum(axis=0) / np.bincount(cube, mass)).sum())
