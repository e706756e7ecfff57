"""A block: a brick of material; and the disk that an axisymmetric scene makes of it."""

import math
from collections.abc import Sequence
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from ...base.geometry import Mirror
from .shape import EVERYWHERE, NOISE, Array, Box, Fit, Solid, Vector, require_size


class Block(Solid):
    """A brick of material between two corners."""

    shape: Literal["block"] = "block"
    """Kind of the body."""
    lower: Vector
    """Lower corner (x, y, z)."""
    upper: Vector
    """Upper corner (x, y, z)."""

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        require_size(self.lower, self.upper)
        return self

    @property
    def fits(self) -> tuple[Fit, Fit, Fit]:
        """Return how points fill the block along x, y and z."""
        x, y, z = (
            Fit.of(u - w, self.spacing, self.rounded) for w, u in zip(self.lower, self.upper, strict=True)
        )
        return x, y, z

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Return the lower and the upper corner of what its points fill, m.

        Rounding moves the lower side along z, and the upper sides along x and y.
        """
        x, y, z = (fit.length - (u - w) for fit, w, u in zip(self.fits, self.lower, self.upper, strict=True))
        (x0, y0, z0), (x1, y1, z1) = self.lower, self.upper
        return (x0, y0, z0 - z), (x1 + x, y1 + y, z1)

    @property
    def points_about(self) -> float:
        """Return the product of the points along its sides."""
        return math.prod(fit.number for fit in self.fits)

    @property
    def point_volume(self) -> float:
        """Return the volume of a point, m^3: the brick of the pitches."""
        return self.spacing**3 * math.prod(fit.pitch / self.spacing for fit in self.fits)

    @property
    def written_volume(self) -> float:
        """Return the volume between the corners that are written, m^3."""
        return math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))

    @property
    def foot(self) -> tuple[float, float]:
        """Return x and y of its middle, m."""
        return (self.lower[0] + self.upper[0]) / 2, (self.lower[1] + self.upper[1]) / 2

    @property
    def diameter(self) -> float:
        """Return its height, m."""
        return self.fits[2].length

    @property
    def flat_top(self) -> float:
        """Return the height of its top, m."""
        return self.upper[2]

    def lattice(self, box: Box = EVERYWHERE) -> Array:
        """Return the positions (n, 3), m, of its points in the box, whose upper faces do not belong to it."""
        axes = [
            axis[(axis >= low) & (axis < high)] for axis, low, high in zip(self._axes(), *box, strict=True)
        ]
        return np.asarray(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))

    def count(self, box: Box = EVERYWHERE) -> int:
        """Return how many points it has. The whole of it lies in the box."""
        return math.prod(int(fit.number) for fit in self.fits)

    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest place in its box."""
        return np.clip(places, *self.box)

    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return its shortest side, m. A side that ends at a symmetry plane counts twice."""
        sides = [fit.length for fit in self.fits]
        for mirror in mirrors:
            if abs(self.box[mirror.above][mirror.axis] - mirror.at) <= tolerance:
                sides[mirror.axis] *= 2
        return min(sides)

    def turned(self) -> Solid:
        """Return the disk with its upper x as radius. Raises ValueError unless the axis is its middle or its side."""
        low, high = self.lower[0], self.upper[0]
        if high <= 0 or min(abs(low), abs(low + high)) > NOISE * self.spacing:
            raise ValueError(
                f"reaches from x = {low:g} m to {high:g} m, with grid.geometry 'axisymmetric' a block must reach as far to either "
                "side of x = 0, or begin there: it becomes a disk"
            )
        return Disk(**dict(self))

    def _axes(self) -> list[Array]:
        """Return the coordinates of its points along x, y and z, m.

        They are lower + (i + 1/2) h with the pitches h; along z they are upper - (k + 1/2) h, so that the surface is
        where it is asked.
        """
        x, y, z = ((np.arange(fit.number) + 0.5) * fit.pitch for fit in self.fits)
        return [self.lower[0] + x, self.lower[1] + y, self.upper[2] - z[::-1]]


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
