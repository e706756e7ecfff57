"""Pictures inside of a page: as data, with no file beside it."""

import base64
import io
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

Frame = NDArray[np.uint8]  # (height, width, 3)
FRAME_DPI = 60
FRAME_MS, LAST_MS = 350, 1500  # how long a frame of an animation stands; the last one


def as_data(kind: str, content: bytes) -> str:
    """Return the address of a picture that is the picture itself; `kind` is png or gif."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def png(figure: Figure, dpi: int = 110) -> str:
    """Return a figure as the address of a PNG."""
    return as_data("png", _drawn(figure, dpi))


def frame(figure: Figure) -> Frame:
    """Return a figure as a frame of an animation."""
    return np.asarray(Image.open(io.BytesIO(_drawn(figure, FRAME_DPI))).convert("RGB"))


def _drawn(figure: Figure, dpi: int) -> bytes:
    """Return a figure as a PNG."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi)
    return out.getvalue()


def gif(frames: Sequence[Frame]) -> str:
    """Return an animation of frames, one at least, as the address of a GIF. Smaller frames are put on white."""
    height, width = (max(one.shape[axis] for one in frames) for axis in (0, 1))
    images = []
    for one in frames:
        whole = np.full((height, width, 3), 255, dtype=np.uint8)
        whole[: one.shape[0], : one.shape[1]] = one
        images.append(Image.fromarray(whole).quantize(128))
    return as_data("gif", animated(images, [FRAME_MS] * (len(images) - 1) + [LAST_MS]))


def animated(images: Sequence[Image.Image], times: int | list[int]) -> bytes:
    """Return images as a GIF that begins anew at its end. `times` in ms are of each, or one of all."""
    out = io.BytesIO()
    images[0].save(out, "GIF", save_all=True, append_images=images[1:], duration=times, loop=0)
    return out.getvalue()
