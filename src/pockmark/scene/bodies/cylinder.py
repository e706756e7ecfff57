"""A cylinder: a rod, disc or tube of material."""

import math
from collections.abc import Sequence
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ...base.geometry import Mirror
from ...base.units import Length
from ..model import Hint
from .lattice import half_integers
from .shape import EVERYWHERE, NOISE, NOT_ROUND, Array, Box, Fit, Solid, Vector

STARTS = 5, 24, 9  # places across the wall, around and along it, from which an overlap is looked for


class Cylinder(Solid):
    """A cylinder of material along an axis, hollow with an `inner_radius`.

    `center` has three coordinates, or x and y with a `gap` between the cylinder and z = 0. A whole number of points
    lies along its radius and along half of its length, so that any symmetry plane through its middle halves it. Its
    points share its volume, as a ball's do.
    """

    shape: Literal["cylinder"] = "cylinder"
    """Kind of the body."""
    axis: Literal["x", "y", "z"] = "z"
    """Axis of the grid along which it lies."""
    center: Annotated[tuple[Length, ...], Hint(allowed="[x, y, z], or [x, y] with a gap")]
    """Centre."""
    gap: Annotated[Length, Field(ge=0), Hint("0 m: no time is lost in flight")] | None = None
    """Clear height between the cylinder and z = 0."""
    radius: Annotated[Length, Field(gt=0)]
    """Radius."""
    inner_radius: Annotated[Length, Field(ge=0), Hint(allowed="a spacing less than radius, or 0")] = 0.0
    """Radius of the hole of a tube; 0 for a rod."""
    length: Annotated[Length, Field(gt=0)]
    """Length along its axis."""

    @model_validator(mode="after")
    def _has_a_height_and_a_wall(self) -> Self:
        if len(self.center) != (3 if self.gap is None else 2):
            raise ValueError(
                "needs either a center of x, y and z, or one of x and y with gap, the clear height above z = 0"
            )
        wall = self.radius - self.inner_radius
        if self.inner_radius and not wall >= self.spacing * (1 - NOISE):
            raise ValueError(
                f"radius less inner_radius: found {wall:g} m, expected at least the spacing, {self.spacing:g} m"
            )
        return self

    @property
    def fits(self) -> tuple[Fit, Fit]:
        """Return how points fill its radius and half of its length."""
        half = Fit.of(self.length / 2, self.spacing, self.rounded)
        return Fit.of(self.radius, self.spacing, self.rounded), half

    @property
    def middle(self) -> Vector:
        """Return its centre, m."""
        if self.gap is None:
            return self.center[0], self.center[1], self.center[2]
        radial, half = self.fits
        return self.center[0], self.center[1], self.gap + (half if self.axis == "z" else radial).length

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Return the lower and the upper corner of a box around what its points fill, m."""
        radial, half = self.fits
        reach = [radial.length] * 3
        reach[self._along] = half.length
        (x, y, z), (a, b, c) = self.middle, reach
        return (x - a, y - b, z - c), (x + a, y + b, z + c)

    @property
    def points_about(self) -> float:
        """Return its volume over that of a cube of the pitch."""
        radial, half = self.fits
        n, m = radial.number, self._inner
        return 2 * math.pi * (n * n - m * m) * half.number

    @property
    def point_volume(self) -> float:
        """Return the volume of a point, m^3.

        The points share the cylinder's volume. Those of a `rounded` one are cubes.
        """
        if self.rounded:
            return self.spacing**3
        return self.written_volume / self.count()

    @property
    def written_volume(self) -> float:
        """Return the volume of the size that is written, m^3."""
        return math.pi * (self.radius**2 - self.inner_radius**2) * self.length

    @property
    def foot(self) -> tuple[float, float]:
        """Return x and y (m) of the vertical line through its middle."""
        return self.middle[0], self.middle[1]

    @property
    def diameter(self) -> float:
        """Return its diameter across its axis, m."""
        return 2 * self.fits[0].length

    @property
    def coarseness(self) -> str:
        """Return what is wrong with fewer than 4 points across it, or 2 through the wall of a tube.

        The text is empty if there are more.
        """
        number = self.fits[0].number
        if number < 2:
            return "fewer than 4 points across the cylinder"
        return "fewer than 2 points through the cylinder's wall" if number - self._inner < 2 - NOISE else ""

    @property
    def starts(self) -> Array:
        """Return places in its wall (n, 3), m: from the inner to the outer face, around and along it."""
        radial, half = self.fits
        across, around, along = STARTS
        radius = np.linspace(self._inner * radial.pitch, radial.length, across)
        angle = np.arange(around) * 2 * math.pi / around
        r, a, w = (
            x.ravel()
            for x in np.meshgrid(radius, angle, np.linspace(-half.length, half.length, along), indexing="ij")
        )
        return self._placed(r * np.cos(a), r * np.sin(a), w)

    def lattice(self, box: Box = EVERYWHERE) -> Array:
        """Return the positions (n, 3), m, of its points in the box, whose upper faces do not belong to it."""
        (radial, half), (i, j, k) = self.fits, self._half_integers(box)
        u, v = (x.ravel() for x in np.meshgrid(i, j, indexing="ij"))
        kept = self._is_in_ring(u, v)
        section = np.stack([u[kept], v[kept]], axis=1) * radial.pitch
        across = np.repeat(section, len(k), axis=0)
        return self._placed(across[:, 0], across[:, 1], np.tile(k * half.pitch, len(section)))

    def count(self, box: Box = EVERYWHERE) -> int:
        """Return how many points lattice() makes, without making them."""
        i, j, k = self._half_integers(box)
        squares = np.sort(j**2)
        outer, inner = self.fits[0].number ** 2 - i**2, self._inner**2 - i**2
        return len(k) * int((np.searchsorted(squares, outer) - np.searchsorted(squares, inner)).sum())

    def nearest(self, places: Array) -> Array:
        """Return for each place (n, 3), m, the nearest place in it. On the axis of a tube one side is taken."""
        (radial, half), w = self.fits, self._along
        u, v = self._across
        local = places - np.array(self.middle)
        rho = np.hypot(local[:, u], local[:, v])
        low, high = self._inner * radial.pitch * (1 + NOISE), radial.length * (1 - NOISE)
        aim, end = np.clip(rho, low, high), half.length * (1 - NOISE)
        on_axis = rho == 0
        share = aim / np.where(on_axis, 1.0, rho)
        moved = np.array(local)
        moved[:, u], moved[:, v] = np.where(on_axis, aim, local[:, u] * share), local[:, v] * share
        moved[:, w] = np.clip(local[:, w], -end, end)
        is_in = (aim == rho) & (moved[:, w] == local[:, w])
        return np.where(is_in[:, None], places, moved + np.array(self.middle))

    def least_width(self, mirrors: Sequence[Mirror], tolerance: float) -> float:
        """Return its diameter, wall or length, m, the least; a length that ends at a symmetry plane counts twice."""
        radial, half = self.fits
        length = 2 * half.length
        for mirror in mirrors:
            if (
                mirror.axis == self._along
                and abs(self.box[mirror.above][mirror.axis] - mirror.at) <= tolerance
            ):
                length *= 2
        across = (radial.number - self._inner) * radial.pitch if self.inner_radius else 2 * radial.length
        return min(across, length)

    def turned(self) -> Self:
        """Return the cylinder itself. Raises ValueError if its axis is another one than x = y = 0."""
        if self.axis != "z" or max(map(abs, self.center[:2])) > NOISE * self.spacing:
            raise ValueError(NOT_ROUND)
        return self

    def is_halved_by(self, axis: int, at: float, tolerance: float) -> bool:
        """Return whether a plane across an axis goes through its middle, to a tolerance (m)."""
        return abs(self.middle[axis] - at) <= tolerance

    @property
    def _along(self) -> int:
        """Return the number of the axis along it."""
        return "xyz".index(self.axis)

    @property
    def _across(self) -> tuple[int, int]:
        """Return the numbers of the two axes across it."""
        return (self._along + 1) % 3, (self._along + 2) % 3

    @property
    def _inner(self) -> float:
        """Return the inner radius in pitches, a whole number if the cylinder is `rounded`."""
        if self.rounded:
            return Fit.of(self.inner_radius, self.spacing, True).number
        return self.inner_radius / self.fits[0].pitch

    def _half_integers(self, box: Box) -> tuple[Array, Array, Array]:
        """Return the half-integers, across it (two arrays) and along it, of the points that lie in the box."""
        radial, half = self.fits
        u, v, w = (
            half_integers(self.middle[a], fit, box[0][a], box[1][a])
            for a, fit in zip((*self._across, self._along), (radial, radial, half), strict=True)
        )
        return u, v, w

    def _is_in_ring(self, i: Array, j: Array) -> Array:
        """Return which points i, j of a section lie between its inner and its outer radius."""
        return np.asarray((j**2 < self.fits[0].number ** 2 - i**2) & (j**2 >= self._inner**2 - i**2))

    def _placed(self, u: Array, v: Array, w: Array) -> Array:
        """Return places (n, 3), m, given their distances from its middle across it (u, v) and along it (w)."""
        out = np.empty((len(u), 3))
        for axis, off in zip((*self._across, self._along), (u, v, w), strict=True):
            out[:, axis] = self.middle[axis] + off
        return out
