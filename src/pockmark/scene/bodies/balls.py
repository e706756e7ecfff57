"""Bodies that are made of equal balls."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from ...base.geometry import Mirror
from .lattice import ball_axes, count_within, whole_ball
from .shape import EVERYWHERE, NOISE, Array, Box, Fit, Solid, Vector


class Balls(Solid):
    """A body made of equal balls."""

    @property
    @abstractmethod
    def places(self) -> Sequence[Vector]:
        """Return the centres of the balls, m."""

    @property
    @abstractmethod
    def fit(self) -> Fit:
        """Return how points fill the radius of a ball."""

    @property
    @abstractmethod
    def written_radius(self) -> float:
        """Return the radius of a ball as it is written, m."""

    @property
    def fits(self) -> tuple[Fit]:
        """Return how points fill the radius of a ball."""
        return (self.fit,)

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Return the lower and the upper corner of a box around all that its points fill, m."""
        (x, y, z), (x1, y1, z1) = (
            tuple(end(axis) for axis in zip(*self.places, strict=True)) for end in (min, max)
        )
        r = self.fit.length
        return (x - r, y - r, z - r), (x1 + r, y1 + r, z1 + r)

    @property
    def points_about(self) -> float:
        """Return the volume of the balls over that of a cube of the pitch."""
        n = self.fit.number
        return len(self.places) * 4 / 3 * math.pi * n * n * n

    @property
    def point_volume(self) -> float:
        """Return the volume of a point, m^3.

        The points of a ball share its volume. Those of a `rounded` one are cubes.
        """
        if self.rounded:
            return self.spacing**3
        return 4 / 3 * math.pi * self.fit.length**3 / whole_ball(int(self.fit.number))

    @property
    def written_volume(self) -> float:
        """Return the volume of balls with the radius that is written, m^3."""
        return len(self.places) * 4 / 3 * math.pi * self.written_radius**3

    @property
    def foot(self) -> tuple[float, float]:
        """Return x and y (m) of the vertical line through the first ball."""
        return self.places[0][:2]

    @property
    def diameter(self) -> float:
        """Return the diameter of a ball, m."""
        return 2 * self.fit.length

    @property
    def ball_diameter(self) -> float:
        """Return the diameter of a ball, m."""
        return self.diameter

    @property
    def starts(self) -> Array:
        """Return the centres of the balls (n, 3), m."""
        return np.array(self.places)

    @property
    def coarseness(self) -> str:
        """Return what is wrong with fewer than 4 points across a ball; empty if there are more."""
        return "fewer than 4 points across the sphere" if self.fit.number < 2 else ""

    def lattice(self, box: Box = EVERYWHERE) -> Array:
        """Return the positions (n, 3), m, of its points in the box, whose upper faces do not belong to it."""
        return np.concatenate([self._ball(center, box) for center in self.places])

    def count(self, box: Box = EVERYWHERE) -> int:
        """Return how many points lattice() makes, without making them."""
        return sum(self._count(center, box) for center in self.places)

    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest place in the ball whose centre is nearest."""
        distance, number = self._tree.query(places)
        center, reach = np.array(self.places)[number], self.fit.length * (1 - NOISE)
        outside = distance >= reach
        share = (reach / np.where(outside, distance, 1.0))[:, None]
        return np.where(outside[:, None], center + (places - center) * share, places)

    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return the diameter of a ball, m. A symmetry plane can only lie in its middle."""
        return self.diameter

    @cached_property
    def _tree(self) -> KDTree:
        """Return the centres of the balls in a tree, made once."""
        return KDTree(np.array(self.places))

    def _ball(self, center: Vector, box: Box) -> Array:
        """Return the positions (n, 3), m, of the points of one ball in the box."""
        axes = ball_axes(center, self.fit, box)
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        inside = (grid**2).sum(axis=1) < self.fit.number**2
        return np.asarray(grid[inside] * self.fit.pitch + np.asarray(center))

    def _count(self, center: Vector, box: Box) -> int:
        """Return how many points of one ball lie in the box."""
        r = self.fit.length
        if all(w <= c - r and c + r <= u for c, w, u in zip(center, *box, strict=True)):
            return whole_ball(int(self.fit.number))
        return count_within(self.fit.number, *ball_axes(center, self.fit, box))
