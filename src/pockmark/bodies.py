"""Bodies of a scene: their shapes and whether they overlap."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from .materials import Model
from .units import Length

Vector = tuple[Length, Length, Length]


class Solid(Model):
    """What bodies of every shape have."""

    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: bool = False


class Block(Solid):
    """A brick of material between two corners."""

    shape: Literal["block"]
    lower: Vector
    upper: Vector

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        if min(u - w for w, u in zip(self.lower, self.upper, strict=True)) <= 0:
            raise ValueError("upper must exceed lower in each direction")
        return self

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners, m."""
        return self.lower, self.upper


class Sphere(Solid):
    """A ball of material. Its radius is rounded to a whole number of point spacings."""

    shape: Literal["sphere"]
    center: Vector
    radius: Annotated[Length, Field(gt=0)]

    @property
    def points_a_radius(self) -> int:
        """The radius in point spacings, rounded; 0 where the spacing is too coarse for any point."""
        return round(self.radius / self.spacing)

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the ball's bounding box, m."""
        x, y, z = self.center
        r = self.radius
        return (x - r, y - r, z - r), (x + r, y + r, z + r)


Body = Annotated[Block | Sphere, Field(discriminator="shape")]


def overlap(a: Block | Sphere, b: Block | Sphere) -> bool:
    """Whether two bodies share more than a surface."""
    if isinstance(a, Sphere) and isinstance(b, Sphere):
        return math.dist(a.center, b.center) < (a.radius + b.radius) * (1 - 1e-9)
    if isinstance(a, Block) and isinstance(b, Block):
        gaps = [
            max(al, bl) - min(au, bu)
            for al, au, bl, bu in zip(a.lower, a.upper, b.lower, b.upper, strict=True)
        ]
        return max(gaps) < -1e-9 * max(a.spacing, b.spacing)
    sphere, block = (a, b) if isinstance(a, Sphere) else (b, a)
    assert isinstance(sphere, Sphere)
    assert isinstance(block, Block)
    nearest = [min(max(c, w), u) for c, w, u in zip(sphere.center, block.lower, block.upper, strict=True)]
    return math.dist(nearest, sphere.center) < sphere.radius * (1 - 1e-9)
