"""The grid of a scene, and what each of its faces does."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..base.geometry import ENOUGH_CELLS_ACROSS
from ..base.units import Length
from .bodies import Vector, require_size
from .model import Hint, Model

Geometry = Literal["3d", "axisymmetric"]
FaceKind = Literal["free", "symmetry", "fixed", "transmitting"]
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
INNER = '"symmetry" where a plane of symmetry halves the impact, else "transmitting"'
MAX_NODES = 2**32 - 2  # what the core can number


class Grid(Model):
    """The background grid: a box of cubic cells. Its upper corner is rounded up to whole cells.

    That of an axisymmetric scene is a slice one cell thick (axisymmetry.py).
    """

    geometry: Annotated[Geometry, Hint('"axisymmetric" for a normal impact of one ball')] = "3d"
    """Whether points fill a box, or are rings about the axis x = y = 0 (a normal impact alone)."""
    lower: Annotated[
        Vector, Hint("two projectile diameters from the projectile, and the crater at most half of the grid")
    ]
    """Lower corner (x, y, z). z points out of the target, whose surface is z = 0."""
    upper: Annotated[Vector, Hint("along z a projectile diameter above it; else as `lower`")]
    """Upper corner (x, y, z), rounded up to whole cells."""
    cell: Annotated[
        Length,
        Field(gt=0),
        Hint(f"{ENOUGH_CELLS_ACROSS} or more across the projectile; fewer than 4 run with --coarse only"),
    ]
    """Width of a cell, which is a cube."""

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
    """The kinds of the grid's faces.

    Points leave through a free face, are mirrored at one of symmetry, cannot move at a fixed one; waves leave through
    a transmitting one.
    """

    x_lower: Annotated[FaceKind, Hint(INNER)] = "transmitting"
    """Kind of the face at the lower x."""
    x_upper: Annotated[FaceKind, Hint(INNER)] = "transmitting"
    """Kind of the face at the upper x."""
    y_lower: Annotated[FaceKind, Hint(INNER)] = "symmetry"
    """Kind of the face at the lower y."""
    y_upper: Annotated[FaceKind, Hint(INNER)] = "transmitting"
    """Kind of the face at the upper y."""
    z_lower: Annotated[FaceKind, Hint('"transmitting" in a thick target, "free" behind a plate')] = (
        "transmitting"
    )
    """Kind of the face at the lower z, under the target."""
    z_upper: Annotated[FaceKind, Hint('"free": ejecta leave, and are counted')] = "free"
    """Kind of the face at the upper z, above the target."""

    @property
    def faces(self) -> tuple[FaceKind, ...]:
        """Return the kinds of the six faces in the core's order."""
        return (self.x_lower, self.x_upper, self.y_lower, self.y_upper, self.z_lower, self.z_upper)
