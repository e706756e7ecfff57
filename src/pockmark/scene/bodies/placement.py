"""The balls of a swarm: how large they are, and where: on a lattice, or at random and clear of each other."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Place = tuple[float, float]
Array = NDArray[np.float64]
MAX_BALLS = 5_000  # in a swarm
AROUND_X, AROUND_Y = np.repeat((-1, 0, 1), 3), np.tile((-1, 0, 1), 3)  # a cell and the eight around it
TRIES = 10_000  # places tried for one ball


def sphere_diameter(flux: float, *, area: float, number: int, density: float) -> float:
    """Return the diameter d_p of a swarm's spheres, m (Liu et al. 2015, Eq. 29).

    There are `number` spheres of `density` (kg/m^3) over an `area` (m^2), at a flux (kg/m^2).
    """
    return math.cbrt(6 / math.pi * area * flux / (number * density))


def require_few(number: float) -> None:
    """Raise ValueError for more than MAX_BALLS balls. It is asked before any ball is made."""
    if not number < MAX_BALLS + 0.5:
        raise ValueError(
            f"makes {number:.3g} balls, at most {MAX_BALLS} are allowed: has each length its unit?"
        )


def on_lattice(lower: Sequence[float], upper: Sequence[float], pitch: float) -> list[Place]:
    """Return the centres (m) of the squares of side `pitch` (m) that fit into the patch, x first.

    Raises ValueError for too many of them.
    """
    sides = [(u - w) / pitch + 1e-9 for w, u in zip(lower, upper, strict=True)]
    require_few(math.prod(float(n) for n in np.floor(sides)))
    x, y = (w + (np.arange(int(n)) + 0.5) * pitch for w, n in zip(lower, sides, strict=True))
    return [(float(a), float(b)) for b in y for a in x]


def at_random(
    lower: Sequence[float], upper: Sequence[float], radius: float, number: int, seed: int
) -> list[Place]:
    """Return `number` places (x, y; m) of balls of a `radius` (m), whole in the patch and clear of each other.

    The balls are placed one after another. Each is tried anew until it is clear of those before. Raises ValueError if
    one finds no place: such a patch is too full.
    """
    low, high = np.asarray(lower) + radius, np.asarray(upper) - radius
    if np.any(high < low):
        raise ValueError(f"balls {2 * radius:.4g} m wide do not fit into the patch")
    placed = _Placed(low, high, 2 * radius, number)
    random = np.random.default_rng(seed)
    for n in range(number):
        place, tries = _first_clear(random, placed, low, high)
        if place is None:
            raise ValueError(f"found places for {n} of {number} balls {2 * radius:.4g} m wide")
        placed.add(place)
        # Each ball uses up the random numbers of all TRIES, drawn or not. So a seed's places do not depend on the batches.
        random.bit_generator.advance(2 * (TRIES - tries))  # type: ignore[attr-defined]
    return [(float(x), float(y)) for x, y in placed.places[:number]]


def _first_clear(
    random: np.random.Generator, placed: "_Placed", low: Array, high: Array
) -> tuple[Array | None, int]:
    """Return the first of TRIES random places that is clear of those placed, and how many were drawn.

    The place is None if none is clear.
    """
    drawn, batch = 0, 4
    while drawn < TRIES:
        tried = random.uniform(low, high, (min(batch, TRIES - drawn), 2))
        drawn += len(tried)
        clear = placed.are_clear(tried)
        if clear.any():
            return tried[np.argmax(clear)], drawn
        batch = min(4 * batch, 1024)  # most balls find their place at once, the last ones need many tries
    return None, drawn


class _Placed:
    """The places that are taken.

    They are kept in square cells at least as wide as a ball, so that only the nine cells around a place matter.
    """

    def __init__(self, low: Array, high: Array, width: float, number: int) -> None:
        """Prepare for `number` places between two corners (m), at least `width` (m) apart."""
        span = high - low
        self.low, self.width = low, width
        # A little wider than a ball against rounding, and not so small that there are many more cells than places.
        self.cell = max(width * (1 + 1e-9), math.sqrt(span[0] * span[1] / number), *(span / number))
        self.shape = np.floor(span / self.cell).astype(int) + 3 if self.cell else np.array([3, 3])
        # The numbers of the places in each cell. The outermost cells are empty. `number` stands for no place: it is infinitely far.
        self.cells = np.full((*self.shape, 4), number)
        self.places = np.full((number + 1, 2), np.inf)
        self.x, self.y = self.places.T.copy()
        self.count = 0

    def are_clear(self, tried: Array) -> NDArray[np.bool_]:
        """Return which of the places (n, 2), m, are at least a width from all that are taken."""
        x, y = self._cell_of(tried).T
        near = self.cells[x[:, None] + AROUND_X, y[:, None] + AROUND_Y].reshape(len(tried), -1)
        apart = self.x[near] - tried[:, :1], self.y[near] - tried[:, 1:]
        return np.asarray((apart[0] ** 2 + apart[1] ** 2 >= self.width**2).all(axis=1))

    def add(self, place: Array) -> None:
        """Take a place."""
        x, y = self._cell_of(place)
        free = self.cells[x, y] == len(self.places) - 1
        if not free.any():
            self.cells = np.pad(self.cells, ((0, 0), (0, 0), (0, 4)), constant_values=len(self.places) - 1)
            free = self.cells[x, y] == len(self.places) - 1
        self.cells[x, y, np.argmax(free)] = self.count
        self.places[self.count] = self.x[self.count], self.y[self.count] = place
        self.count += 1

    def _cell_of(self, places: Array) -> NDArray[np.int64]:
        """Return the cells (n, 2) in which places lie."""
        return np.asarray(np.floor((places - self.low) / self.cell).astype(np.int64) + 1 if self.cell else 1)
