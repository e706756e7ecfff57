"""An order: a run that is to be made, in plain values that reach any process on any machine.

What passes orders on imports this, and nothing that makes a run: a dask scheduler needs no core.
"""

from pathlib import Path
from typing import Any, TypedDict

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError

INTERRUPTED = "interrupted"  # the fault of a run that was stopped, and has kept what there was


class Order(TypedDict):
    """A run that is to be made: its scene, its folder (an absolute path), and the pockmark that has to make it."""

    scene: dict[str, Any]
    folder: str
    coarse: bool
    pockmark: str
    physics: int


class RefusedError(PockmarkError):
    """An error for an order that a process must not follow: no order of the campaign can be followed there."""


def order_for(scene: dict[str, Any], folder: Path, *, coarse: bool) -> Order:
    """Return the order for a run of a scene, as plain tables, in a folder, by this version and this physics."""
    return Order(
        scene=scene, folder=str(folder.absolute()), coarse=coarse, pockmark=__version__, physics=PHYSICS
    )
