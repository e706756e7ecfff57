"""A run in three dimensions, by PyVista: the cut face and the crater in colours, still or moving."""

import io
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from numpy.typing import NDArray
from PIL import Image as Pillow

from ..base.errors import PockmarkError, shown
from ..base.geometry import Setup
from .images import animated
from .panels import told
from .quantities import Quantity
from .raster import slice_axis
from .space import Solid

SIZE = (1008, 720)  # pixels, whole blocks of 16, as films want them
Image = NDArray[np.uint8]  # (height, width, 3)


class Shells:
    """The surfaces of a run's snapshots, in the colours of one quantity, which are the same at all times."""

    def __init__(self, quantity: Quantity, setup: Setup, title: str) -> None:
        """Begin without a surface. Raises PockmarkError without PyVista."""
        self._vista = pyvista()
        self._quantity, self._setup, self._title = quantity, setup, title
        self._shells: list[tuple[float, Any]] = []  # ns, mesh

    def add(self, solid: Solid) -> None:
        """Take the surface of a solid: its filling at the level of one half, closed by the plane of the cut."""
        grid = self._vista.ImageData(
            dimensions=solid.filling.shape,
            spacing=[along[1] - along[0] for along in solid.nodes],
            origin=[along[0] for along in solid.nodes],
        )
        for name, array in (
            ("filling", solid.filling),
            ("value", solid.values),
            ("projectile", solid.projectile),
        ):
            grid.point_data[name] = array.ravel(order="F")
        filled = grid.clip_scalar(scalars="filling", value=0.5, invert=False)
        self._shells.append((solid.time, filled.extract_surface(algorithm="dataset_surface")))

    def image(self, n: int) -> Image:
        """Return the picture of the n-th snapshot."""
        plotter = self._vista.Plotter(off_screen=True, window_size=SIZE, lighting="none")
        self._draw(plotter, n)
        try:
            return np.asarray(plotter.screenshot(None, return_img=True))[:, :, :3]
        finally:
            plotter.close()

    def open(self) -> None:
        """Open a window with the last snapshot, and a slider for the others."""
        plotter = self._vista.Plotter(window_size=SIZE, lighting="none")
        last = len(self) - 1
        self._draw(plotter, last)
        if last:
            plotter.add_slider_widget(
                lambda n: self._draw(plotter, round(n)),
                (0, last),
                value=last,
                title="snapshot",
                fmt="%.0f",
                interaction_event="always",
            )
        plotter.show()

    def __len__(self) -> int:
        """Return how many snapshots there are."""
        return len(self._shells)

    def _span(self) -> Normalize:
        """Return the range of the colours for all snapshots."""
        seen = [np.asarray(shell["value"]) for _, shell in self._shells if shell.n_points]
        return self._quantity.span(np.concatenate(seen) if seen else np.zeros(0))

    def _draw(self, plotter: Any, n: int) -> None:
        """Draw the n-th snapshot in place of another: its surface, the projectile's outline, the time."""
        time, shell = self._shells[n]
        span, bar = self._span(), _bar(self._quantity)
        if shell.n_points:
            plotter.add_mesh(
                shell,
                scalars="value",
                cmap=self._quantity.colours,
                clim=(span.vmin, span.vmax),
                name="shell",
                scalar_bar_args=bar,
                ambient=0.6,  # the colours are to be read on the cut face, whichever way it is lit
                diffuse=0.4,
            )
            edge = shell.contour([0.5], scalars="projectile")
            for name, colour, width in (("ground", "white", 6), ("edge", "black", 2)):
                if edge.n_points:
                    plotter.add_mesh(edge, color=colour, line_width=width, lighting=False, name=name)
                else:
                    plotter.remove_actor(name)
        else:
            for name in ("shell", "ground", "edge"):
                plotter.remove_actor(name)
        title = "".join(c if c.isascii() else "?" for c in shown(self._title, 80))  # what VTK's font has
        plotter.add_text(f"{title}, {time:.0f} ns", font_size=11, color="black", name="title")
        plotter.set_background("white")
        if not plotter.renderer.lights:
            plotter.add_light(self._vista.Light(light_type="headlight"))
        self._look(plotter)

    def _look(self, plotter: Any) -> None:
        """Look at the cut face, from above."""
        _, first = self._shells[0]
        box = np.array(first.bounds if first.n_points else (-1, 1, -1, 1, -1, 1)).reshape(3, 2)
        centre, size = box.mean(axis=1), float(np.ptp(box, axis=1).max())
        across = slice_axis(self._setup)
        away = np.array([0.25, 0.25, 0.75])
        away[across] = -1.0 if abs(box[across, 0]) <= abs(box[across, 1]) else 1.0
        centre[2] -= 0.1 * size  # room for the bar below
        plotter.camera_position = [centre + 1.7 * size * away, centre, (0, 0, 1)]


def _bar(quantity: Quantity) -> dict[str, Any]:
    """Return how PyVista draws the bar of a quantity."""
    comma = "," if quantity.unit else ""
    title = f"{quantity.name}{comma} {told(quantity)}".replace("area", "surface")
    return {
        "title": title,
        "color": "black",
        "n_labels": 5,
        "fmt": "%.4g",
        "title_font_size": 16,
        "label_font_size": 14,
    }


def pyvista() -> ModuleType:
    """Return PyVista. Raises PockmarkError without it."""
    try:
        import pyvista as found
        from vtkmodules.vtkCommonCore import vtkLogger
    except ImportError:
        raise PockmarkError(
            "pockmark view needs PyVista, which is not installed: pip install 'pockmark[view]'"
        ) from None
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # else it warns where there is no display
    return found


def as_png(image: Image) -> bytes:
    """Return an image as a PNG."""
    made = io.BytesIO()
    Pillow.fromarray(image).save(made, "PNG", optimize=True)
    return made.getvalue()


def as_gif(images: Sequence[Image], seconds: float) -> bytes:
    """Return an animation as a GIF, so many seconds an image; it begins anew at its end."""
    made = [Pillow.fromarray(image).quantize(255, dither=Pillow.Dither.NONE) for image in images]
    return animated(made, round(1000 * seconds))


def as_mp4(images: Sequence[Image], seconds: float) -> bytes | None:
    """Return an animation as a film, so many seconds an image; None without imageio-ffmpeg."""
    try:
        from imageio_ffmpeg import write_frames
    except ImportError:
        return None
    with TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        writer = write_frames(path, SIZE, fps=1 / seconds, output_params=["-r", "25"])
        writer.send(None)
        for image in images:
            writer.send(np.ascontiguousarray(image))
        writer.close()
        return path.read_bytes()
