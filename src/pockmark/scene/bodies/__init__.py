"""The bodies of a scene, and the closed list of their shapes.

Each shape has a file. shape.py says what a shape must give.
"""

from typing import Annotated

from pydantic import Field

from .block import Block
from .cylinder import Cylinder
from .overlap import box_gap, overlap
from .shape import NOISE, Array, Fit, Solid, Vector, require_size
from .sphere import Sphere
from .swarm import Swarm

Body = Annotated[Block | Sphere | Swarm | Cylinder, Field(discriminator="shape")]

__all__ = [
    "NOISE",
    "Array",
    "Block",
    "Body",
    "Cylinder",
    "Fit",
    "Solid",
    "Sphere",
    "Swarm",
    "Vector",
    "box_gap",
    "overlap",
    "require_size",
]
