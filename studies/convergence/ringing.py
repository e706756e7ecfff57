"""How much of the kinetic energy at the end is motion within a few cells, which no wave and no ejecta carries.

python studies/convergence/ringing.py runs/model-1 runs/model-2 runs/model-3, after run.py has left those folders.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from campaign import keep

from pockmark.store import RunFolder

HERE = Path(__file__).parent


def kinetic(mass: np.ndarray, velocity: np.ndarray) -> float:
    """Sum of m v^2 / 2 (J)."""
    return float(0.5 * (mass[:, None] * velocity**2).sum())


def of_blocks(position: np.ndarray, mass: np.ndarray, velocity: np.ndarray, size: float) -> float:
    """The kinetic energy (J) of the mean velocities of cubes of edge `size` (m)."""
    key = np.floor(position / size).astype(int)
    key -= key.min(axis=0)
    cube = np.ravel_multi_index(tuple(key.T), tuple(key.max(axis=0) + 1))
    _, cube = np.unique(cube, return_inverse=True)
    momentum = np.stack([np.bincount(cube, mass * velocity[:, a]) for a in range(3)])
    return float((0.5 * (momentum**2).sum(axis=0) / np.bincount(cube, mass)).sum())


def main() -> None:
    """A row for each run and kind of point."""
    for path in map(Path, sys.argv[1:]):
        folder = RunFolder.open(path)
        points = folder.last_snapshot()
        initial = float(folder.history()["initial"][0])
        cell = folder.scene().grid.cell
        for body, kind in ((1, "projectile"), (0, "target")):
            for failed in (False, True):
                chosen = (points["body"] == body) & ((points["damage"] >= 1) == failed)
                x, m, v = (points[name][chosen] for name in ("position", "mass", "velocity"))
                keep(
                    HERE / "ringing.csv",
                    {
                        "case": f"{path.name} {kind} {'failed' if failed else 'intact'}",
                        "points": len(m),
                        "kinetic_over_initial": f"{kinetic(m, v) / initial:.4f}",
                        "of_blocks_of_two_cells": f"{of_blocks(x, m, v, 2 * cell) / initial:.4f}",
                        "rms_speed_m_s": f"{np.sqrt(2 * kinetic(m, v) / m.sum()):.0f}",
                        "mean_velocity_z_m_s": f"{(m * v[:, 2]).sum() / m.sum():.1f}",
                    },
                )


if __name__ == "__main__":
    main()
