"""What equations and measurements say of a run's crater."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from ..base.lengths import in_metres
from ..laws.equations import cour_palais, volume_energy
from ..laws.measurements import Hardness, Measurement, hardness, near
from ..scene.materials import Material, material
from ..scene.prospect import Ball, largest_ball
from ..scene.scene import Scene
from ..view.comparison import Claim, Compared

DEPTH, SHAPE = "depth_over_projectile_diameter", "depth_over_diameter"


def compared(scene: Scene, result: Mapping[str, Any]) -> list[Compared]:
    """Return what is said elsewhere of the depth and the shape of a run's crater, whose measures are `result`.

    Nothing where no ball moves or there is no target.
    """
    ball = largest_ball(scene)
    if ball is None or not scene.targets:
        return []
    target = scene.materials[scene.body[scene.targets[0]].material]
    normal, crater = scene.impact.speed * math.cos(scene.impact.angle), result["crater"]
    struck_by = {known_as(scene.materials[scene.body[i].material]).kind for i in scene.projectiles}
    kinds = struck_by.pop() if len(struck_by) == 1 else "", known_as(target).kind
    depth = (
        _volume_energy(ball, target, normal),
        _cour_palais(scene, ball, target),
        *_measured(DEPTH, kinds, ball, normal),
    )
    return [
        Compared("C_p/d_p", crater[DEPTH], depth),
        Compared("C_p/D_c", crater[SHAPE], tuple(_measured(SHAPE, kinds, ball, normal))),
    ]


def known_as(found: Material) -> Hardness:
    """Return kind and hardness of a material, by the library's material with its density and equation of state.

    The hardness is that of a library's material with its strength, too. What is not known is empty or None.
    """
    kind = Hardness("", None, "")
    for name, known in hardness().items():
        ours = material(name)
        if (ours.density, ours.eos) != (found.density, found.eos):
            continue
        if ours.strength == found.strength:
            return known
        kind = Hardness(known.kind, None, "")
    return kind


def _volume_energy(ball: Ball, target: Material, normal: float) -> Claim:
    """Return what Liu et al. 2015, Eq. 22, says of C_p/d_p at a normal speed, m/s."""
    name = "Liu et al. 2015, Eq. 22"
    if not target.yield_strength:
        return Claim(name, None, None, "the target has no yield strength")
    value = volume_energy(normal, projectile_density=ball.density, target_strength=target.yield_strength)
    return Claim(name, value, value, f"yield strength {target.yield_strength / 1e6:.4g} MPa")


def _cour_palais(scene: Scene, ball: Ball, target: Material) -> Claim:
    """Return what Cour-Palais's equation says of C_p/d_p."""
    name, known = "Cour-Palais", known_as(target)
    ratio = ball.density / target.density
    if known.brinell is None:
        return Claim(name, None, None, "the target's Brinell hardness is not known")
    sound = math.sqrt(target.bulk_modulus / target.density)
    value = cour_palais(
        scene.impact.speed,
        diameter=ball.diameter,
        brinell=known.brinell,
        sound_speed=sound,
        density_ratio=ratio,
        angle=scene.impact.angle,
    )
    return Claim(
        name, value, value, f"Brinell hardness {known.brinell:g} ({known.source}), sound {sound:.0f} m/s"
    )


def _measured(quantity: str, kinds: tuple[str, str], ball: Ball, normal: float) -> Iterator[Claim]:
    """Give what is measured of a quantity nearest to an impact of two kinds, at a normal speed (m/s)."""
    found = near(quantity, *kinds, diameter=ball.diameter, speed=normal) if all(kinds) else ()
    for measurement in found:
        yield Claim(
            f"measured: {measurement.source}",
            measurement.low,
            measurement.high,
            f"{_how_far(measurement, ball.diameter, normal)}: {measurement.note}",
        )
    if not found:
        pair = " on ".join(kind or "a material of unknown kind" for kind in kinds)
        yield Claim("measured", None, None, f"no measurement is kept of {pair}")


def _how_far(measured: Measurement, diameter: float, speed: float) -> str:
    """Return of what a measurement is, and how far that is from an impact, diameter in m and speed in m/s."""
    pair = f"{measured.projectile or 'unknown projectiles'} on {measured.target}"
    if not measured.diameter or not measured.speed:
        return pair
    return (
        f"{pair}, {in_metres(measured.diameter)} at {measured.speed / 1e3:.4g} km/s, {measured.diameter / diameter:.3g} times the "
        f"diameter and {measured.speed / speed:.3g} times the normal speed here"
    )
