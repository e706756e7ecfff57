"""What is no file, no path or no plain number is one sentence at once, from the command line and from Python."""

import os
import time
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene, Simulation, measure
from pockmark.base.files import as_path
from pockmark.base.toml import LARGEST
from pockmark.cli import app
from pockmark.run.measured import standing_of, surface_of_run
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
NUL = "a\0b"


def refusal(function, *arguments, **more):
    """The sentence that a function refuses with; it takes less than 2 s."""
    start = time.monotonic()
    with pytest.raises(PockmarkError) as caught:
        function(*arguments, **more)
    print(said := str(caught.value))
    assert time.monotonic() - start < 2
    assert said.isprintable()
    return said


def _loop(path):
    path.symlink_to(path)


THINGS = {
    "a folder": (Path.mkdir, "is no regular file (a folder)"),
    "a pipe": (os.mkfifo, "is no regular file (a pipe)"),
    "zeros": (lambda path: path.symlink_to("/dev/zero"), "is no regular file (a device)"),
    "nothing": (lambda path: None, "cannot be read (No such file"),
    "a link to nothing": (lambda path: path.symlink_to("/nowhere"), "cannot be read (No such file"),
    "a loop": (_loop, "is no regular file (a link to itself)"),
    "too long": (lambda path: path.write_text("#" * (LARGEST + 1)), f"has more than {LARGEST:,} bytes"),
    "no text": (lambda path: path.write_bytes(b"\xff"), "is not a text file"),
}


@pytest.mark.parametrize(("make", "sentence"), THINGS.values(), ids=THINGS)
@pytest.mark.parametrize("name", ["scene.toml", "campaign.toml"])
def test_what_is_no_scene_file_is_told_at_once(name, make, sentence, tmp_path):
    make(tmp_path / name)
    words = ["study", tmp_path] if name == "campaign.toml" else ["check", tmp_path / name]
    said = refusal(app, [str(word) for word in words], standalone_mode=False)
    assert said.startswith(f"{tmp_path / name}: ")
    assert sentence in said


def test_a_scene_may_be_a_link_and_long(tmp_path):
    text = QUICK.read_text()
    (tmp_path / "there.toml").write_text(text + "#" * (LARGEST - len(text.encode())))
    (tmp_path / "here.toml").symlink_to("there.toml")
    assert Scene.load(tmp_path / "here.toml") == Scene.load(str(QUICK))


def test_a_campaign_may_be_named_by_its_file(tmp_path):
    (tmp_path / "campaign.toml").write_text('scene = "x.toml"\n[[group]]\nname = "g"\n')
    for name in (tmp_path, tmp_path / "campaign.toml"):
        said = refusal(app, ["study", str(name), "-o", str(tmp_path / "out")], standalone_mode=False)
        assert said == f"{tmp_path / 'x.toml'}: cannot be read (No such file or directory)"
    (tmp_path / "other.toml").write_text("")
    said = refusal(app, ["study", str(tmp_path / "other.toml")], standalone_mode=False)
    assert said.endswith("other.toml: is a file, expected a folder with a campaign.toml, or that file")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("runs") / "run"
    return run_scene(Scene.load(QUICK, ["end_time='1 ns'"]), path, threads=1, progress=False)[0]


@pytest.mark.parametrize("path", [NUL, Path(NUL), 7, None, b"run"], ids=repr)
def test_what_is_no_path_is_told(path, folder):
    scene = folder.scene()
    for function in (
        Scene.load,
        scene.save,
        RunFolder,
        RunFolder.open,
        measure,
        plot_run,
        standing_of,
        as_path,
    ):
        refusal(function, path)
    refusal(run_scene, scene, path, progress=False)
    if path is not None:
        refusal(plot_run, folder.path, path)


@pytest.mark.parametrize("key", ["scene", "report"])
def test_a_campaign_names_paths(key, tmp_path):
    table = {"scene": '"s.toml"', "report": '"r.py"'} | {key: r'"a\u0000b"'}
    lines = [*(f"{name} = {value}" for name, value in table.items()), "[[group]]", 'name = "g"']
    (tmp_path / "campaign.toml").write_text("\n".join(lines))
    assert "NUL" in refusal(app, ["study", str(tmp_path)], standalone_mode=False)


def test_a_run_folder_may_be_given_as_text_or_itself(folder):
    texts = RunFolder(str(folder.path))
    assert texts.status() == "finished"
    assert measure(folder) == measure(texts) == measure(folder.path)
    assert {path.parent for path in plot_run(folder, out=folder)} == {folder.path}
    assert standing_of(folder) == ""
    surface_of_run(folder)
    assert RunFolder.open(folder).path == folder.path


def test_a_scene_is_not_saved_onto_a_folder(folder, tmp_path):
    assert refusal(folder.scene().save, tmp_path) == f"{tmp_path}: Is a directory"
    folder.scene().save(tmp_path / "scene.toml")
    assert Scene.load(tmp_path / "scene.toml") == folder.scene()


def test_numbers_of_numpy_are_numbers():
    table = Scene.load(QUICK).to_dict()
    expected = Scene.from_dict(table)
    table["impact"]["speed"] = np.int64(2200)
    table["numerics"]["cfl"] = np.float32(0.5)
    table["grid"]["lower"] = np.array(table["grid"]["lower"])
    table["body"][0]["upper"] = tuple(map(np.float64, table["body"][0]["upper"]))
    scene = Scene.from_dict(table)
    assert (scene, scene.hash) == (expected, expected.hash)
    assert isinstance(table["impact"]["speed"], np.int64)  # the caller's table is left as it is
    swarm = {"name": "p", "shape": "swarm", "lower": np.array([-3e-5, 0]), "upper": [3e-5, 3e-5], "height": 1e-5, "radius": 5e-6,
             "seed": np.int64(1), "number": np.uint8(2), "spacing": 1e-6, "material": "al2024-liu2015", "projectile": True}  # fmt: skip
    assert len(Scene.from_dict(table | {"body": [table["body"][0], swarm]}).body[1].places) == 2


@pytest.mark.parametrize(
    "value", [np.array("x"), np.complex128(1j), np.float64("nan"), np.bool_(True)], ids=repr
)
def test_what_is_no_number_of_numpys_is_told(value):
    table = Scene.load(QUICK).to_dict()
    table["impact"]["speed"] = value
    assert "impact.speed: found" in refusal(Scene.from_dict, table)


def test_what_is_no_table_is_told():
    endless = Scene.load(QUICK).to_dict()
    endless["impact"]["more"] = endless
    assert "without an end" in refusal(Scene.from_dict, endless)
    for value in (5, None, [1], "text"):
        assert "expected a table" in refusal(Scene.from_dict, value)


@pytest.mark.parametrize("end", [np.nan, np.inf, -np.inf])
def test_a_run_needs_a_finite_end(end):
    simulation = Simulation(Scene.load(QUICK), threads=1)
    assert "expected a finite time" in refusal(simulation.run, (), end)
    assert simulation.steps == 0
