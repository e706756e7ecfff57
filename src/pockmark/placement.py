"""How large the balls of a swarm are, and where: on a lattice, or at random places clear of each other."""

import math
from collections.abc import Sequence

import numpy as np

Place = tuple[float, float]
TRIES = 10_000  # places tried for one ball


def sphere_diameter(flux: float, *, area: float, number: int, density: float) -> float:
    """d_p, m (Eq. 29): `number` spheres of `density` (kg/m^3) over an `area` (m^2) at a flux (kg/m^2)."""
    return math.cbrt(6 / math.pi * area * flux / (number * density))


def on_lattice(lower: Sequence[float], upper: Sequence[float], pitch: float) -> list[Place]:
    """Centres (m) of the squares of side `pitch` that fit into the patch, x first."""
    x, y = (
        w + (np.arange(int((u - w) / pitch + 1e-9)) + 0.5) * pitch for w, u in zip(lower, upper, strict=True)
    )
    return [(float(a), float(b)) for b in y for a in x]


def at_random(
    lower: Sequence[float], upper: Sequence[float], radius: float, number: int, seed: int
) -> list[Place]:
    """`number` places (m) of balls of `radius` (m) whole in the patch and apart, one after another, each tried anew until it
    is clear of those before. Raises ValueError if one finds none: such a patch is too full."""
    low, high = np.asarray(lower) + radius, np.asarray(upper) - radius
    if np.any(high < low):
        raise ValueError(f"balls {2 * radius:.4g} m wide do not fit into the patch")
    random = np.random.default_rng(seed)
    places = np.empty((0, 2))
    for n in range(number):
        tried = random.uniform(low, high, (TRIES, 2))
        clear = np.ones(TRIES, dtype=bool)
        for place in places:
            clear &= ((tried - place) ** 2).sum(axis=1) >= (2 * radius) ** 2
        if not clear.any():
            raise ValueError(f"found places for {n} of {number} balls {2 * radius:.4g} m wide")
        places = np.vstack([places, tried[np.argmax(clear)]])
    return [(float(x), float(y)) for x, y in places]
