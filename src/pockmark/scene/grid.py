"""The grid of a scene, and what each of its faces does."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..base.units import Length
from .bodies import Vector, require_size
from .model import Model

Geometry = Literal["3d", "axisymmetric"]
FaceKind = Literal["free", "symmetry", "fixed", "transmitting"]
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
MAX_NODES = 2**32 - 2  # what the core can number


class Grid(Model):
    """The background grid: a box of cubic cells. Its upper corner is rounded up to whole cells.

    That of an axisymmetric scene is a slice one cell thick (axisymmetry.py).
    """

    geometry: Geometry = "3d"
    lower: Vector
    upper: Vector
    cell: Annotated[Length, Field(gt=0)]

    @property
    def is_axisymmetric(self) -> bool:
        """Return whether points are rings, and x the radius."""
        return self.geometry == "axisymmetric"

    @property
    def cells(self) -> tuple[int, int, int]:
        """Return the number of cells along x, y, z."""
        x, y, z = (math.ceil((u - w) / self.cell - 1e-9) for w, u in zip(self.lower, self.upper, strict=True))
        return x, y, z

    @property
    def cell_count(self) -> int:
        """Return the number of cells."""
        return math.prod(self.cells)

    @property
    def node_count(self) -> int:
        """Return the number of nodes, with the layer beyond each face."""
        return math.prod(n + 3 for n in self.cells)

    @property
    def corner(self) -> tuple[float, ...]:
        """Return the upper corner after rounding to whole cells, m."""
        return tuple(w + n * self.cell for w, n in zip(self.lower, self.cells, strict=True))

    @property
    def box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the lower and the upper corner, m."""
        return self.lower, self.corner

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        require_size(self.lower, self.upper)
        # With the layer beyond each face, and a cell for rounding. As floats, for these may be infinite.
        nodes = math.prod((u - w) / self.cell + 4 for w, u in zip(self.lower, self.upper, strict=True))
        if not nodes <= MAX_NODES:
            raise ValueError(f"a cell of {self.cell:g} m makes {nodes:.3g} nodes, at most {MAX_NODES} fit")
        return self


class Boundary(Model):
    """The kinds of the grid's faces."""

    x_lower: FaceKind = "transmitting"
    x_upper: FaceKind = "transmitting"
    y_lower: FaceKind = "symmetry"
    y_upper: FaceKind = "transmitting"
    z_lower: FaceKind = "transmitting"
    z_upper: FaceKind = "free"

    @property
    def faces(self) -> tuple[FaceKind, ...]:
        """Return the kinds of the six faces in the core's order."""
        return (self.x_lower, self.x_upper, self.y_lower, self.y_upper, self.z_lower, self.z_upper)
