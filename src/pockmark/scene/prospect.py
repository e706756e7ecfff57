"""The impact that a scene asks for, and the crater that Liu et al. 2015, Eq. 22, predicts."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..base.errors import shown
from ..base.geometry import Mirror, copies
from ..base.lengths import in_metres
from ..laws.equations import volume_energy
from .bodies import Solid
from .materials import Material
from .scene import Scene


class Ball(NamedTuple):
    """A ball that makes a crater: diameter (m) and density (kg/m^3).

    `is_real` is false if it stands for a body of another shape with its volume.
    """

    diameter: float
    density: float
    is_real: bool


def impact_rows(scene: Scene) -> Iterator[tuple[str, str]]:
    """Give the names and values of what hits, and how hard; nothing without a projectile."""
    if not (each := _balls(scene)):
        return
    impact, largest = scene.impact, max(each, key=lambda ball: ball.diameter)
    count = sum(max(1, len(scene.body[i].places)) for i in scene.projectiles)
    yield "speed", f"{impact.speed / 1e3:.4g} km/s"
    turned = f", azimuth {math.degrees(impact.azimuth):.4g} deg" if impact.azimuth else ""
    yield "angle from the normal", f"{math.degrees(impact.angle):.4g} deg{turned}"
    of = "" if largest.is_real else ", of a ball of its volume"
    yield (
        "projectile's diameter" if count == 1 else f"largest of {count} projectiles",
        in_metres(largest.diameter) + of,
    )
    mass = projectile_mass(scene)
    yield (
        "mass" if count == 1 else "their mass",
        f"{mass:.4g} kg" + (", mirror images included" if scene.mirrors else ""),
    )
    yield "energy" if count == 1 else "their energy", f"{0.5 * mass * impact.speed**2:.4g} J"


def projectile_mass(scene: Scene) -> float:
    """Return the mass of all projectiles, with what symmetry planes hide, kg."""
    bodies = [scene.body[i] for i in scene.projectiles]
    computed = (scene.volume(b) * scene.materials[b.material].density for b in bodies)
    return copies(scene.mirrors) * math.fsum(computed)


def fit_warnings(scene: Scene) -> list[str]:
    """Say whether the crater that Eq. 22 predicts is too large for a target or for the grid.

    Say also where Eq. 22 can predict none.
    """
    out, ball = [], largest_ball(scene)
    for i in scene.targets:
        body = scene.body[i]
        material = scene.materials[body.material]
        if body.flat_top is None or not ball:
            continue
        if not material.yield_strength:
            out.append(
                f"material '{shown(body.material)}' has no yield strength, which Eq. 22 needs: neither the size of a crater in it nor "
                "when it has settled can be forecast"
            )
            continue
        depth = _depth(scene, ball, material.yield_strength)
        said = f"Eq. 22 predicts a crater {in_metres(depth, 3)} deep{_stands_for(ball)}"
        if depth > body.diameter / 2:
            out.append(
                f"body[{i}] '{shown(body.name)}': {said}, more than half of its thickness, "
                f"{in_metres(body.diameter)}: it may be perforated, or the crater feel what lies behind"
            )
        elif wide := _too_wide(scene, depth):
            out.append(f"{said}, and so {wide}")
    return list(dict.fromkeys(out))


def settling_warnings(scene: Scene) -> list[str]:
    """Say whether the run ends before the crater has settled, or before all projectiles have arrived."""
    end, ball = f"end_time: {scene.end_time * 1e9:.4g} ns", largest_ball(scene)
    if (settled := settled_at(scene)) is not None and ball and scene.end_time < settled:
        return [f"{end}; the crater is settled after about {settled * 1e9:.3g} ns{_stands_for(ball)}"]
    times = arrivals(scene)
    if times and scene.end_time < max(times):
        return [f"{end}; the last projectile is at z = 0 after about {max(times) * 1e9:.3g} ns"]
    return []


def settled_at(scene: Scene) -> float | None:
    """Return when the deepest crater that Eq. 22 predicts will have settled, s; None if it predicts none."""
    found = []
    for i in scene.targets:
        material = scene.materials[scene.body[i].material]
        if scene.body[i].flat_top is not None and (depth := predicted_depth(scene, material)) is not None:
            found.append(settling_time(depth, material))
    return max(arrivals(scene)) + max(found) if found else None


def predicted_depth(scene: Scene, target: Material) -> float | None:
    """Return the depth of the deepest crater in a target, m, by Liu et al. 2015, Eq. 22.

    The speed in it is the normal part. A body that is no ball counts as the ball of its volume. None without a
    projectile, a speed or a yield strength.
    """
    ball = largest_ball(scene)
    strength = target.yield_strength
    return _depth(scene, ball, strength) if ball and strength else None


def settling_time(depth: float, target: Material) -> float:
    """Return the time (s) in which a crater of a depth (m) settles: depth sqrt(rho/Y).

    It is the target's strength that stops it. docs/metrology.md has what the rule was compared with.
    """
    assert target.yield_strength
    return depth * math.sqrt(target.density / target.yield_strength)


def arrivals(scene: Scene) -> list[float]:
    """Return when the lower side of each projectile meets z = 0, s; an empty list if none moves."""
    if not scene.impact.speed:
        return []
    heights = [scene.body[i].box[0][2] for i in scene.projectiles]
    return [max(0.0, height) / -scene.impact.velocity[2] for height in heights]


def _balls(scene: Scene) -> list[Ball]:
    """Return a ball for each projectile: its own, or one of its volume."""
    out = []
    for body in (scene.body[i] for i in scene.projectiles):
        own = body.ball_diameter
        volume = scene.volume(body) * copies(_halving(body, scene))
        diameter = math.cbrt(6 / math.pi * volume) if own is None else own
        out.append(Ball(diameter, scene.materials[body.material].density, own is not None))
    return out


def largest_ball(scene: Scene) -> Ball | None:
    """Return the ball that makes the deepest crater by Eq. 22, in any target; None if nothing moves."""
    if not scene.impact.speed:
        return None
    return max(_balls(scene), key=lambda ball: ball.diameter * math.cbrt(ball.density), default=None)


def _depth(scene: Scene, ball: Ball, strength: float) -> float:
    """Return the depth, m, that Eq. 22 predicts of a ball in a target of a yield strength, Pa."""
    normal = scene.impact.speed * math.cos(scene.impact.angle)
    return ball.diameter * volume_energy(normal, projectile_density=ball.density, target_strength=strength)


def _stands_for(ball: Ball) -> str:
    """Return the words that say that a ball stands for a body of another shape; empty for a real ball."""
    return "" if ball.is_real else " (by a ball of the projectile's volume)"


def _halving(body: Solid, scene: Scene) -> Sequence[Mirror]:
    """Return the symmetry planes at which a body ends, or that cut it in its middle.

    Its image behind such a plane is a part of the whole body.
    """
    tolerance = 1e-9 * scene.grid.cell
    return [
        mirror
        for mirror in scene.mirrors
        if abs(body.box[mirror.above][mirror.axis] - mirror.at) <= tolerance
        or body.is_halved_by(mirror.axis, mirror.at, tolerance)
    ]


def _places(body: Solid, scene: Scene) -> Sequence[Sequence[float]]:
    """Return the places of a body's balls (x, y, ...; m), or its middle."""
    if body.places:
        return body.places
    middle = [*body.foot]
    for mirror in _halving(body, scene):
        middle[mirror.axis] = mirror.at
    return [middle]


def _too_wide(scene: Scene, depth: float) -> str:
    """Say along which axis hemispherical craters of a depth (m) take more than half of the grid.

    The text is empty if they do along none.
    """
    places = [place for i in scene.projectiles for place in _places(scene.body[i], scene)]
    for axis, name in enumerate("x" if scene.grid.is_axisymmetric else "xy"):
        low, high = min(p[axis] for p in places) - depth, max(p[axis] for p in places) + depth
        left, right = scene.grid.lower[axis], scene.grid.corner[axis]
        for mirror in scene.planes:
            if mirror.axis == axis and mirror.above:
                high, right = 2 * mirror.at - low, 2 * mirror.at - left
            elif mirror.axis == axis:
                low, left = 2 * mirror.at - high, 2 * mirror.at - right
        if high - low > (right - left) / 2:
            return (
                f"{in_metres(high - low, 3)} wide along {name}, more than half of the grid, {in_metres(right - left)}: it feels "
                "the faces"
            )
    return ""
