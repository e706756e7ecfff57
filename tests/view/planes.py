"""Synthetic snapshots: points on a jittered lattice that carry a known function."""

import numpy as np

from pockmark.base.geometry import Mirror, Setup

UM = 1e-6
H, CELL = 2.0, 4.0  # um
TARGET, PROJECTILE = 0, 1
SETUP = Setup(
    H * UM,
    names=("slab", "ball"),
    projectiles=(PROJECTILE,),
    mirrors=(Mirror(1, 0.0, False),),
    cell=CELL * UM,
)


def block(lower, upper, h=H):
    """Points of a lattice that fills a block, um."""
    axes = [np.arange(a + h / 2, b, h) for a, b in zip(lower, upper, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def fields(position, body, width=H, jitter=0.0, seed=1):
    """Fields of points at places (n, 3), um, that are cubes of a width, um, with a jitter in widths."""
    n = len(position)
    body = np.broadcast_to(np.asarray(body, dtype=np.uint8), n)
    width = np.broadcast_to(width, n) * UM
    noise = np.random.default_rng(seed).uniform(-jitter, jitter, (n, 3)) * width[:, None]
    return {
        "position": position * UM + noise,
        "velocity": np.zeros((n, 3)),
        "volume": width**3,
        "mass": 2700 * width**3,
        "body": body.copy(),
        "deviator": np.zeros((n, 6)),
        "pressure": np.zeros(n),
        "temperature": np.full(n, 293.0),
        "plastic_strain": np.zeros(n),
        "damage": np.zeros(n),
        "time": np.array([20e-9]),
    }


def rings():
    """The fields of rings (r, z) of a disk 30 um wide and high, whose pressure is their radius in MPa."""
    r, z = (a.ravel() for a in np.meshgrid(np.arange(1, 30, H), np.arange(-29, 0, H)))
    snapshot = fields(np.column_stack([r, 0 * r, z]), TARGET)
    snapshot["volume"] = 2 * np.pi * r * UM * (H * UM) ** 2
    snapshot["mass"] = 2700 * snapshot["volume"]
    snapshot["pressure"] = r * 1e6
    return snapshot


def only(snapshot, kept):
    """Some points of a snapshot."""
    return {name: values if name == "time" else values[kept] for name, values in snapshot.items()}
