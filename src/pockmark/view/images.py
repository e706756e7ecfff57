"""Pictures inside of a page: as data, with no file beside it."""

import base64
import io
from collections.abc import Sequence
from typing import Any

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
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=dpi)
    return as_data("png", out.getvalue())


def frame(figure: Figure) -> Frame:
    """Return a figure as a frame of an animation."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=FRAME_DPI)
    return np.asarray(Image.open(out).convert("RGB"))


def gif(frames: Sequence[Frame]) -> str:
    """Return an animation of frames, one at least, as the address of a GIF. Smaller frames are put on white."""
    height, width = (max(one.shape[axis] for one in frames) for axis in (0, 1))
    images = []
    for one in frames:
        whole = np.full((height, width, 3), 255, dtype=np.uint8)
        whole[: one.shape[0], : one.shape[1]] = one
        images.append(Image.fromarray(whole).quantize(128))
    out, times = io.BytesIO(), [FRAME_MS] * (len(images) - 1) + [LAST_MS]
    options: dict[str, Any] = {"append_images": images[1:], "duration": times, "loop": 0}
    images[0].save(out, format="GIF", save_all=True, **options)
    return as_data("gif", out.getvalue())
