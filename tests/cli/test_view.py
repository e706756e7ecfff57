"""`pockmark view` where there is no display: pictures and an animation, or one sentence."""

import shutil
import sys
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1] / "run"))
from rings import small_rings

from pockmark import run_scene
from pockmark.cli import main
from pockmark.run.pictures import plot_run
from pockmark.run.viewing import shells_of
from pockmark.view.window import SIZE, as_gif, as_mp4


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return run_scene(small_rings("4 ns"), tmp_path_factory.mktemp("view") / "run", threads=1, progress=False)[
        0
    ]


@pytest.fixture
def view(monkeypatch, capsys):
    """Call the command without a display; return its exit code, what it printed, and what it said of mistakes."""

    def call(*arguments):
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr("sys.argv", ["pockmark", "view", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return (ended.value.code or 0, *capsys.readouterr())

    return call


def opened(path):
    """The pixels of a picture."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"), dtype=int)


def is_drawn(array):
    """Whether a picture has material: many pixels of many colours that are not the background."""
    other = np.abs(array - array[array.shape[0] // 2, 2]).max(axis=2) > 12
    return 0.1 < other.mean() < 0.9 and len(np.unique(array[other], axis=0)) > 50


def test_pictures_and_an_animation_are_written(folder, view, tmp_path):
    pytest.importorskip("pyvista")
    code, printed, _ = view(folder.path, "-o", tmp_path, "--field", "speed")
    assert code == 0
    assert "view.png" in printed
    picture = opened(tmp_path / "view.png")
    assert picture.shape[1::-1] == SIZE
    assert is_drawn(picture)
    if (tmp_path / "view.mp4").exists():
        return
    frames = []
    with Image.open(tmp_path / "view.gif") as film:
        for n in range(film.n_frames):
            film.seek(n)
            frames.append(np.asarray(film.convert("RGB"), dtype=int))
    assert len(frames) == len(folder.snapshots())
    assert all(is_drawn(frame) for frame in frames)
    assert all(np.abs(b - a).max() > 50 for a, b in pairwise(frames))


def test_a_window_has_a_slider_for_the_snapshots(folder, monkeypatch):
    """As far as it goes without a display: the window opens, and each place of the slider is drawn."""
    pyvista = pytest.importorskip("pyvista")
    monkeypatch.setattr(pyvista, "OFF_SCREEN", True)
    slide, shown = pyvista.Plotter.add_slider_widget, []

    def spied(self, callback, ends, **options):
        slider = slide(self, callback, ends, **options)
        for n in np.linspace(*ends, 3):  # GetText(2): the upper left corner
            callback(n)
            shown.append(self.actors["title"].GetText(2))
        return slider

    monkeypatch.setattr(pyvista.Plotter, "add_slider_widget", spied)
    shells_of(folder.path, "speed").open()
    assert [title.split()[-2:] for title in shown] == [["0", "ns"], ["4", "ns"], ["8", "ns"]]


def test_one_snapshot_is_not_animated(folder, view, tmp_path):
    pytest.importorskip("pyvista")
    shutil.copytree(folder.path, tmp_path / "one")
    for file in folder.snapshots()[:-1]:
        (tmp_path / "one" / file.name).unlink()
    code, printed, _ = view(tmp_path / "one", "--off-screen")
    assert code == 0
    assert "one snapshot: there is nothing to animate" in printed
    assert not [*(tmp_path / "one").glob("view.[gm]*")]
    assert is_drawn(opened(tmp_path / "one" / "view.png"))


def test_without_pyvista_one_sentence_says_how_to_get_it(folder, view, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    code, _, said = view(folder.path, "-o", tmp_path)
    assert (code, said) == (
        2,
        "pockmark: pockmark view needs PyVista, which is not installed: pip install 'pockmark[view]'\n",
    )


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--field", "colour"), "field: found colour, expected one of effective_stress, pressure,"),
        (("-o", "/dev/null"), "/dev/null"),
    ],
)
def test_a_mistake_is_one_sentence(folder, view, arguments, sentence):
    pytest.importorskip("pyvista")
    code, _, said = view(folder.path, *arguments)
    assert code == 2
    assert sentence in said
    assert said.count("\n") == 1


def test_a_field_that_the_snapshot_lacks_is_one_sentence(folder, view, tmp_path):
    """The pictures have the sentence in its panel; a view of it says no more than that."""
    pytest.importorskip("pyvista")
    lacking = tmp_path / "lacking"
    shutil.copytree(folder.path, lacking)
    for file in folder.snapshots():
        with h5py.File(lacking / file.name, "a") as written:
            del written["VTKHDF/PointData/temperature"]
    assert all(path.exists() for path in plot_run(lacking))
    code, _, said = view(lacking, "--off-screen", "--field", "temperature")
    assert code == 2
    assert said == "pockmark: the snapshot lacks the field temperature\n"


def test_what_is_no_run_is_one_sentence(view, tmp_path):
    code, _, said = view(tmp_path)
    assert code == 2
    assert said.count("\n") == 1


def test_an_animation_is_a_film_where_there_is_imageio_ffmpeg(monkeypatch):
    images = [np.full((SIZE[1], SIZE[0], 3), value, dtype=np.uint8) for value in (0, 120, 255)]
    assert as_gif(images, 0.1)[:4] == b"GIF8"
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "imageio_ffmpeg", None)
        assert as_mp4(images, 0.1) is None
    pytest.importorskip("imageio_ffmpeg")
    assert b"ftyp" in as_mp4(images, 0.1)[:12]
