"""A disk: a block as an axisymmetric scene has it."""

import math
from collections.abc import Sequence

import numpy as np

from ...base.geometry import Mirror
from .block import Block
from .shape import NOISE, Array, Fit, Vector


class Disk(Block):
    """A block turned about the axis x = y = 0: its upper x is the radius, and y is not taken.

    Its lattice is that of its rings.
    """

    @property
    def fits(self) -> tuple[Fit, Fit, Fit]:
        """Return how points fill its radius, one place along y, and its height."""
        radial = Fit.of(self.upper[0], self.spacing, self.rounded)
        high = Fit.of(self.upper[2] - self.lower[2], self.spacing, self.rounded)
        return radial, Fit(1.0, self.spacing, self.spacing), high

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Return the lower and the upper corner of a box around what its points fill, m."""
        r, _, high = (fit.length for fit in self.fits)
        return (-r, -r, self.upper[2] - high), (r, r, self.upper[2])

    @property
    def written_volume(self) -> float:
        """Return the volume of the size that is written, m^3."""
        return math.pi * self.upper[0] ** 2 * (self.upper[2] - self.lower[2])

    @property
    def foot(self) -> tuple[float, float]:
        """Return x and y of its axis, m."""
        return 0.0, 0.0

    @property
    def rings_about(self) -> float:
        """Return the product of its points along the radius and the height."""
        return self.points_about

    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest place in it."""
        (_, _, low), (radius, _, high) = self.box
        rho = np.hypot(places[:, 0], places[:, 1])
        reach = radius * (1 - NOISE)
        share = np.where(rho > reach, reach / np.where(rho > 0, rho, 1.0), 1.0)
        return np.column_stack([places[:, :2] * share[:, None], np.clip(places[:, 2], low, high)])

    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return its diameter or its height, m, the lesser."""
        return min(2 * self.fits[0].length, self.fits[2].length)

    def is_halved_by(self, axis: int, at: float, tolerance: float) -> bool:
        """Return whether a plane across x or y goes through its axis, to a tolerance (m)."""
        return axis < 2 and abs(at) <= tolerance

    def turned(self) -> "Disk":
        """Return the disk itself."""
        return self

    def _axes(self) -> list[Array]:
        """Return the coordinates of its rings along x, y and z, m."""
        radial, _, high = self.fits
        z = (np.arange(high.number) + 0.5) * high.pitch
        return [(np.arange(radial.number) + 0.5) * radial.pitch, np.zeros(1), self.upper[2] - z[::-1]]
