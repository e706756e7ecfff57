"""States that cannot be, found in a finished run with NumPy alone: each is "kind: detail"."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pockmark import Scene
from pockmark.scene.materials import Material

Fields = Mapping[str, NDArray[Any]]
LEDGER = 0.01  # of the initial energy
# Of the larger of the projectile's kinetic energy and the heat at rest, per volume: below is rounding and the scheme's error
# in the energy of a point that has hardly been shocked. Compression, flow and viscosity all pay in.
ENERGY = 1e-3


def impossible_points(scene: Scene, snapshot: Fields) -> Iterator[str]:
    """Yield what is impossible in the points of a snapshot, a line a kind and body."""
    for index, body in enumerate(scene.body):
        mine = np.asarray(snapshot["body"]) == index
        if not mine.any():
            continue
        fields = {name: np.asarray(snapshot[name])[mine] for name in NEEDED}
        for kind, wrong, worst in _impossible(scene.materials[body.material], fields, scene.impact.speed):
            if n := int(np.count_nonzero(wrong)):
                yield f"{kind}: {n} of {mine.sum()} points of '{body.name}', the worst {worst:.4g}"


NEEDED = (
    "position",
    "velocity",
    "mass",
    "volume",
    "energy",
    "deviator",
    "pressure",
    "temperature",
    "plastic_strain",
    "damage",
)


def _impossible(
    material: Material, f: Fields, speed: float
) -> Iterator[tuple[str, NDArray[np.bool_], float]]:
    """Yield each kind of fault, which points have it, and the worst value."""
    finite = np.all([np.isfinite(x).reshape(len(x), -1).all(axis=1) for x in f.values()], axis=0)
    yield "not finite", ~finite, math.nan
    volume, energy, temperature = f["volume"], f["energy"], f["temperature"]
    with np.errstate(all="ignore"):
        density = f["mass"] / volume / material.density  # rho/rho0
    yield "no volume", volume <= 0, _least(volume / (f["mass"] / material.density))
    yield "below 0 K", temperature < 0, _least(temperature)
    yield "beyond the strong-shock limit", density > most(material), -_least(-density)
    scale = material.density * max(
        speed**2 / 2, material.thermal.specific_heat * material.thermal.room_temperature
    )
    compressed = (volume > 0) & (density > 1)
    yield (
        "negative energy",
        compressed & (energy < -ENERGY * scale),
        _least(np.where(compressed, energy, 0.0)),
    )


def most(material: Material) -> float:
    """Return the rho/rho0 that no single shock exceeds, s/(s - 1); infinite where the law has none."""
    s = getattr(material.eos, "s", 0.0)
    return s / (s - 1) if s > 1 else math.inf


def _least(values: NDArray[Any]) -> float:
    return float(np.nanmin(values, initial=math.inf))


def impossible_history(scene: Scene, history: Fields) -> Iterator[str]:
    """Yield what is impossible in the columns of a history: energy from nowhere, matter too dense."""
    error, initial = history["error"], float(history["initial"][0])
    if not np.isfinite(error).all():
        yield "ledger: not finite"
    elif initial and np.abs(error).max() > LEDGER * initial:
        yield f"ledger: {np.abs(error).max() / initial:.3g} of the initial energy"
    limit = max(most(scene.materials[body.material]) for body in scene.body)
    if (densest := float(history["max_compression"].max())) > limit:
        yield f"beyond the strong-shock limit: {densest:.4g} at some time, at most {limit:.4g}"


def impossible_result(scene: Scene, result: Mapping[str, Any]) -> Iterator[str]:
    """Yield what is impossible in the results: residual energy, and a depth beyond the target's back."""
    residual = result["energy"]["residual_internal"]
    if residual is not None and not -LEDGER <= residual <= 1 + LEDGER:
        yield f"residual energy: E_i^r = {residual:.4g}"
    depth = result["crater"]["depth"]
    # A plate that is bent down is deeper than it is thick, and the table says so.
    if depth is None or any("deeper than half" in sentence for sentence in result["warnings"]):
        return
    targets = [scene.body[i] for i in scene.targets]
    back, spacing = min(b.box[0][2] for b in targets), max(b.spacing for b in targets)
    if not 0 <= depth <= -back - spacing / 2:
        yield f"depth: {depth:.4g} m of a target of {-back:.4g} m"
