"""The way from a run folder to its view in three dimensions."""

import os
import sys
from pathlib import Path

from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, make_folder, write_bytes
from ..metrology.measures import UNWARNED
from ..view.quantities import quantity_of
from ..view.space import Solid
from ..view.window import Shells, as_gif, as_mp4, as_png
from .measured import in_the_grid
from .setup import setup_of
from .store import RunFolder

FRAME = 0.4  # s, for which a snapshot is seen in an animation


def has_display() -> bool:
    """Return whether a window can be opened."""
    return sys.platform in ("win32", "darwin") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )


@UNWARNED
def shells_of(path: AnyPath, field: str = "pressure") -> Shells:
    """Return the surfaces of all snapshots of a run folder, in the colours of a field.

    Raises PockmarkError for an unknown field, one that a snapshot lacks, and without PyVista.
    """
    quantity, folder = quantity_of(field), RunFolder.open(path)
    scene = folder.scene()
    setup = setup_of(scene)
    files = folder.snapshots()
    if not files:
        raise PockmarkError(f"{folder.path}: holds no snapshot")
    shells = Shells(quantity, setup, scene.title or folder.path.name)
    for file in files:
        shells.add(Solid.of(in_the_grid(folder.snapshot(file), scene), setup, quantity))
    return shells


def write_views(shells: Shells, out: AnyPath) -> list[Path]:
    """Write view.png, the last snapshot, and an animation of all, if there are several, into a folder.

    The animation is view.mp4 if imageio-ffmpeg is installed, else view.gif. Return the files. Raises PockmarkError.
    """
    target = as_path(out)
    make_folder(target)
    images = [shells.image(n) for n in range(len(shells))]
    made = {"view.png": as_png(images[-1])}
    if len(images) > 1:
        film = as_mp4(images, FRAME)
        made |= {"view.mp4": film} if film else {"view.gif": as_gif(images, FRAME)}
    for name, content in made.items():
        write_bytes(target / name, content)
    return [target / name for name in made]
