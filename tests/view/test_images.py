"""Pictures in a page: an animation has its frames, a bar its shares, and what cannot be drawn is not."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from pockmark.view.images import gif
from pockmark.view.many import ENERGIES, Series, energy_figure, swept_figure


def test_an_animation_has_its_frames_on_one_size():
    frames = [np.full((20 + n, 30 - n, 3), 60 * n, dtype=np.uint8) for n in range(3)]
    kind, data = gif(frames).split(",")
    image = Image.open(io.BytesIO(base64.b64decode(data)))
    assert kind == "data:image/gif;base64"
    assert (image.n_frames, image.size) == (3, (30, 22))
    for n in range(3):
        image.seek(n)
        shown = np.asarray(image.convert("RGB"), dtype=int)
        assert np.abs(shown[10, 10] - 60 * n).max() < 4
        assert (shown[20 + n :, 0] == 255).all()


def test_the_bar_of_energies_ends_where_they_add_up():
    energy = dict.fromkeys(ENERGIES, 0.0) | {"internal": 0.7, "kinetic": 0.2, "absorbed": 0.1, "viscous": 0.3}
    (axes,) = energy_figure(energy).axes
    assert max(bar.get_x() + bar.get_width() for bar in axes.patches) == pytest.approx(1.0)
    assert len(axes.patches) == 3  # what is a part of another is not beside it


def test_without_energy_there_is_no_bar():
    assert energy_figure(dict.fromkeys(ENERGIES)) is None


def test_a_line_is_in_the_order_of_the_swept_key():
    series = Series("one", np.array([3.0, 1.0, 2.0]), {"a": np.array([9.0, 1.0, 4.0])})
    figure = swept_figure("impact.speed (m/s)", [series], ["a"])
    assert figure.axes[0].lines[0].get_xdata().tolist() == [1.0, 2.0, 3.0]
    assert figure.axes[0].lines[0].get_ydata().tolist() == [1.0, 4.0, 9.0]
