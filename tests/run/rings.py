"""A run of rings that takes a second: 8 ns of the example on coarse cells."""

from pockmark import Scene, example

CHANGES = {
    "grid.cell": "5 um",
    "body.wall.spacing": "2.5 um",
    "body.ball.spacing": "1.25 um",
    "end_time": "8 ns",
}


def small_rings(snapshots):
    """Return its scene, with snapshots as often."""
    return Scene.load(example("rings")).with_(CHANGES | {"output.snapshots": snapshots})
