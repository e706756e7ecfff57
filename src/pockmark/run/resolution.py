"""The error that a run's cells make, where converged studies of its kind are known.

resolution.toml has the studies: their kind, speed, cells across the projectile, and the errors on these.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from ..scene.scene import Scene
from ..scene.warnings import cells_across

MEASURES = ("depth", "diameter", "residual_internal")
FILE = "resolution.toml"
Study = Mapping[str, Any]


@cache
def known_studies() -> tuple[Study, ...]:
    """Return the converged studies that come with pockmark."""
    text = files(__package__).joinpath(FILE).read_text(encoding="utf-8")
    return tuple(tomllib.loads(text).get("study", ()))


def kind_of(scene: Scene) -> dict[str, Any] | None:
    """Return what a study and a run must have in common, but for speed and cells.

    None for an impact of anything but one ball, of which no study is kept.
    """
    balls = [scene.body[i] for i in scene.projectiles]
    if len(balls) != 1 or len(balls[0].places) != 1 or not scene.targets:
        return None
    wall = scene.body[scene.targets[0]]
    numerics = scene.numerics.model_dump(exclude={"precision"}, exclude_none=True)
    return {
        "numerics": numerics,
        "friction": scene.contact.friction if scene.contact else "sticks",
        "angle": round(math.degrees(scene.impact.angle), 6),
        "points_a_cell": [round(scene.grid.cell / body.spacing, 3) for body in (balls[0], wall)],
        "materials": [_laws(scene, body.material) for body in (balls[0], wall)],
    }


def resolution_of(scene: Scene, studies: Sequence[Study] | None = None) -> dict[str, Any]:
    """Return by what share a run's depth, diameter and E_i^r are off, and by how many studies that is known.

    It is the largest error, the study's own uncertainty included, that the studies of this kind at the next lower and
    the next higher speed have on as many cells across. None for each measure that they do not bracket so.
    `studies` None takes those that come with pockmark.
    """
    kind, across = kind_of(scene), cells_across(scene)
    known = known_studies() if studies is None else studies
    near = _bracket([s for s in known if s["kind"] == kind and _serves(s, scene)], scene.impact.speed)
    table: dict[str, Any] = {"studies": len(near)}
    for name in MEASURES:
        errors = [_error_at(study, name, across) for study in near]
        there = [error for error in errors if error is not None]
        table[name] = max(there) if there and len(there) == len(near) else None
    return table


def _laws(scene: Scene, name: str) -> list[str]:
    """Return the laws of a material by their names, its failure treatment among them."""
    material = scene.materials[name]
    return [*material.laws, str(getattr(material.failure, "treatment", ""))]


def _serves(study: Study, scene: Scene) -> bool:
    """Return whether a study's geometry is that of a scene.

    An axisymmetric one serves both, for the crater is the same on the same cells (docs/converge.md).
    """
    return bool(study["geometry"] in ("axisymmetric", scene.grid.geometry))


def _bracket(studies: Sequence[Study], speed: float) -> list[Study]:
    """Return the studies at the next lower and the next higher speed (m/s), or the one at it; none beyond them all."""
    lower = [study for study in studies if study["speed"] <= speed * (1 + 1e-6)]
    higher = [study for study in studies if study["speed"] >= speed * (1 - 1e-6)]
    if not lower or not higher:
        return []
    below = max(lower, key=lambda study: study["speed"])
    above = min(higher, key=lambda study: study["speed"])
    return [below] if below is above else [below, above]


def _error_at(study: Study, name: str, across: float | None) -> float | None:
    """Return the error of a measure on so many cells across, by a study; None beyond its cells or without its limit.

    Error and uncertainty are taken together, and between its cells as a power of their number.
    """
    if not across or name not in study:
        return None
    cells, errors, spread = (
        np.array(study[name][key]) for key in ("cells_across", "errors", "uncertainties")
    )
    size = np.hypot(errors, spread)
    if not cells.min() * (1 - 1e-6) <= across <= cells.max() * (1 + 1e-6) or not (size > 0).all():
        return None
    order = np.argsort(cells)
    return float(np.exp(np.interp(math.log(across), np.log(cells[order]), np.log(size[order]))))
