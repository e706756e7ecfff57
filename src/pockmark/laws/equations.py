"""Depth of a crater by published equations.

They hold for a sphere of the target's hardness class on a semi-infinite metal. P/d is the depth over the sphere's
diameter.
"""

import math


def volume_energy(speed: float, *, projectile_density: float, target_strength: float) -> float:
    """Return P/d of the volume-energy formula, Liu et al. 2015, Eq. 22.

    `speed` is in m/s, `projectile_density` in kg/m^3, `target_strength` the yield strength in Pa.
    """
    return 0.27 * math.pow(speed * math.sqrt(projectile_density / target_strength), 2 / 3)


def cour_palais(
    speed: float,
    *,
    diameter: float,
    brinell: float,
    sound_speed: float,
    density_ratio: float = 1.0,
    angle: float = 0.0,
) -> float:
    """Return P/d of Cour-Palais as in Christiansen's NASA handbook (NASA/TM-2009-214785, Eqs. 4-1, 4-2).

    The exponent of `density_ratio` = rho_p/rho_t is 1/2 below 1.5, and 2/3 from there on.
    `speed` and the target's `sound_speed` are in m/s, `diameter` in m, `angle` from the normal in rad. `brinell` is
    the target's Brinell hardness, kgf/mm^2.
    """
    centimetres = 100 * diameter
    normal = speed * math.cos(angle) / sound_speed
    hardness, exponent = math.pow(brinell, -0.25), 1 / 2 if density_ratio < 1.5 else 2 / 3
    density = math.pow(density_ratio, exponent)
    return 5.24 * math.pow(centimetres, 1 / 18) * hardness * density * math.pow(normal, 2 / 3)


def summers_charters(speed: float, *, sound_speed: float, density_ratio: float = 1.0) -> float:
    """Return P/d of Summers and Charters.

    `speed` and the target's `sound_speed` are in m/s; `density_ratio` is rho_p/rho_t.
    """
    return 2.28 * math.pow(density_ratio * speed / sound_speed, 2 / 3)


def herrmann_jones(
    speed: float, *, target_density: float, brinell: float, density_ratio: float = 1.0
) -> float:
    """Return P/d of Herrmann and Jones's logarithmic formula.

    `speed` is in m/s, `target_density` in kg/m^3. `brinell` is the target's Brinell hardness, kgf/mm^2.
    `density_ratio` is rho_p/rho_t.
    """
    hardness = brinell * 9.80665e6
    ratio = math.pow(density_ratio, 2 / 3)
    return 0.6 * ratio * math.log(1 + ratio * target_density * speed**2 / (4 * hardness))
