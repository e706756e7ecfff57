"""Run folders that were altered: one sentence or the same figures, never a traceback, a hang or another file's data."""

import json
import os
import shutil
import socket
from contextlib import suppress
from pathlib import Path

import pytest
from altered import LAST, QUICK, every_reader, refusal

from pockmark import PockmarkError, Scene, measure
from pockmark.run.measured import standing_of
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder
from pockmark.study.runner import is_done

MANIFESTS = {
    "empty": "",
    "list": "[1]",
    "lists": "[[[]]]",
    "brackets": "[" * 10_000 + "]" * 10_000,
    "tables": '{"a":' * 10_000,
    "text": '"text"',
    "number": "1",
    "long number": "9" * 5000,
    "nan": "NaN",
    "null": "null",
    "no json": "status = finished",
    "a stranger's": '{"name": "my web page"}',
    "not utf-8": b"\xff\xfe{}",
    "zeros": b"\0" * 100,
    "absurdly long": " " * 2**21 + "{}",
    "half": '{"scene_hash": "0", "status": "fini',
}


@pytest.mark.parametrize("text", MANIFESTS.values(), ids=MANIFESTS)
def test_a_file_that_is_no_manifest_is_told(text, folder):
    (folder / "manifest.json").write_bytes(text.encode() if isinstance(text, str) else text)
    for reader in every_reader():
        assert "manifest.json" in refusal(reader, folder)
    assert not is_done(folder)
    with pytest.raises(PockmarkError, match="is not empty and holds no run"):
        RunFolder.create(folder, Scene.load(QUICK), force=True)


VALUES = [
    ("status", [None, 3, [], "done", "x" * 10**5]),
    ("scene_hash", [None, 5, [], "", "0" * 16, "x" * 10**5]),
    ("physics", ["x", -1, 1.5, 10**30]),
    ("run", [None, 3, [], {}, "run", [{}]]),
    ("run.points", [None, -1, "7", 1.5, 10**30, float("nan"), True]),
    ("run.steps", [None, -1, [], {}]),
    ("run.time", [None, -1.0, "1 ns", float("nan"), float("inf")]),
    ("run.particle_steps_per_second", ["fast", -1.0]),
    ("run.max_compression", ["much", float("inf")]),
    ("ledger", [None, 3, [], {}, "J"]),
    ("ledger.initial", ["1 J", [], {}, float("nan")]),
    ("ledger.left_momentum_z", ["x", [1]]),
    ("counters", [None, 3, [], [1, 2], "none"]),
    ("counters.left_points", [-1, "x", 1.5, 10**40, None]),
]


@pytest.mark.parametrize(("key", "value"), [(key, value) for key, values in VALUES for value in values])
def test_a_manifest_s_value_that_cannot_be_is_told(key, value, folder):
    manifest = json.loads((folder / "manifest.json").read_text())
    *tables, name = key.split(".")
    table = manifest
    for part in tables:
        table = table[part]
    table[name] = value
    (folder / "manifest.json").write_text(json.dumps(manifest))
    sentence = refusal(measure, folder)
    assert key.rpartition(".")[0] in sentence or key in sentence
    assert str(folder) in sentence


@pytest.mark.parametrize(
    "key", ["status", "scene_hash", "run", "ledger", "counters", "run.time", "ledger.error"]
)
def test_a_manifest_without_a_key_is_told(key, folder):
    manifest = json.loads((folder / "manifest.json").read_text())
    *tables, name = key.split(".")
    table = manifest[tables[0]] if tables else manifest
    del table[name]
    (folder / "manifest.json").write_text(json.dumps(manifest))
    assert name in refusal(measure, folder)


SCENES = {
    "empty": "",
    "no toml": "title = [",
    "brackets": "x = " + "[" * 10_000,
    "not utf-8": b"\xff\xfe",
    "absurdly long": "#" * 2**21,
    "another": None,
}


@pytest.mark.parametrize("text", SCENES.values(), ids=SCENES)
def test_a_scene_that_is_not_the_run_s_is_told(text, folder):
    path = folder / "scene.toml"
    if text is None:
        text = path.read_text().replace("speed = 2200.0", "speed = 2300.0")
        assert text != path.read_text()
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    for reader in every_reader():
        assert "scene.toml" in refusal(reader, folder)


def test_another_title_is_the_same_scene(original, folder):
    path = folder / "scene.toml"
    path.write_text(path.read_text().replace('title = "quick', 'title = "my quick'))
    assert "my quick" in path.read_text()
    assert measure(folder) == original[1]


def _rewritten(change):
    """A history with its lines changed."""

    def write(path):
        path.write_text("".join(change(path.read_text().splitlines(keepends=True))))

    return write


HISTORIES = {
    "empty": _rewritten(lambda lines: []),
    "header alone": _rewritten(lambda lines: lines[:1]),
    "two columns of a name": _rewritten(lambda lines: [lines[0].replace("kinetic", "error", 1), *lines[1:]]),
    "a column gone": _rewritten(lambda lines: [lines[0].replace("error", "mistake"), *lines[1:]]),
    "ragged": _rewritten(lambda lines: [*lines[:2], "1,2\n", *lines[2:]]),
    "too long a row": _rewritten(lambda lines: [*lines[:2], lines[2].strip() + ",1\n", *lines[3:]]),
    "a huge cell": _rewritten(lambda lines: [*lines[:2], "1" * 200_000 + ",1\n", *lines[2:]]),
    "a huge quoted cell": _rewritten(lambda lines: [*lines[:2], '"' + "x\n" * 200_000, *lines[2:]]),
    "one long line": lambda path: path.write_bytes(b"x" * 2**24),
    "zeros": lambda path: path.write_bytes(b"\0" * 10_000),
    "not utf-8": lambda path: path.write_bytes(path.read_bytes()[:-40] + b"\xff\xfe\n"),
    "torn": lambda path: path.write_bytes(path.read_bytes()[:-30]),
    "words": _rewritten(lambda lines: [lines[0], *("x" + line for line in lines[1:])]),
}


@pytest.mark.parametrize("change", HISTORIES.values(), ids=HISTORIES)
def test_a_history_that_is_none_is_told(change, folder):
    change(folder / "history.csv")
    for reader in (measure, plot_run):
        assert "history.csv" in refusal(reader, folder)


def test_a_history_of_absurd_size_is_told(folder):
    with (folder / "history.csv").open("r+b") as file:
        file.truncate(10 * 2**30)  # no bytes on disk
    assert "more than" in refusal(measure, folder)


def _pipe(path):
    os.mkfifo(path)


def _socket(path):
    # The name of a socket is short: it is bound from beside it.
    here = os.getcwd()
    os.chdir(path.parent)
    try:
        socket.socket(socket.AF_UNIX).bind(path.name)
    finally:
        os.chdir(here)


def _link_to_itself_elsewhere(path):
    shutil.move(path.with_name(path.name + ".old"), path.parent.parent / path.name)
    path.symlink_to(path.parent.parent / path.name)


THINGS = {
    "nothing": lambda path: None,
    "a folder": Path.mkdir,
    "a pipe": _pipe,
    "a socket": _socket,
    "a link": _link_to_itself_elsewhere,
    "a link to a device": lambda path: path.symlink_to("/dev/zero"),
    "a link to nothing": lambda path: path.symlink_to("/nowhere"),
    "a loop": lambda path: path.symlink_to(path),
}


@pytest.mark.parametrize("name", ["scene.toml", "manifest.json", "history.csv", LAST])
@pytest.mark.parametrize("thing", THINGS.values(), ids=THINGS)
def test_what_is_no_file_is_told_at_once(thing, name, folder):
    path = folder / name
    path.rename(path.with_name(name + ".old"))
    thing(path)
    if name == LAST and not os.path.lexists(path):
        for other in folder.glob("snapshot*.vtkhdf"):
            other.unlink()
    for reader in (measure, plot_run):
        assert str(folder) in refusal(reader, folder)


def test_nothing_is_written_through_a_link(folder, tmp_path):
    names = ("crater.png", "history.png")
    for name in names:
        (folder / name).unlink(missing_ok=True)
        (tmp_path / name).write_text("mine")
        (folder / name).symlink_to(tmp_path / name)
        # As a guess at the name that is written first.
        (folder / f"{name}.{os.getpid()}.part").symlink_to(tmp_path / name)
    plot_run(folder)
    assert all((tmp_path / name).read_text() == "mine" for name in names)
    assert all(not (folder / name).is_symlink() for name in names)
    assert not list(folder.glob("*.part"))


@pytest.mark.parametrize(
    "name", ["scene.toml", "manifest.json", "history.csv", "snapshot-0000.vtkhdf", "run.lock"]
)
def test_a_run_writes_through_no_link(name, folder, tmp_path):
    mine = tmp_path / "mine"
    mine.write_text((folder / name).read_text() if name == "manifest.json" else "mine")
    before = mine.read_text()
    (folder / name).unlink(missing_ok=True)
    (folder / name).symlink_to(mine)
    scene = Scene.load(QUICK, ["end_time='0.1 ns'"])
    with suppress(PockmarkError):
        run_scene(scene, folder, threads=1, force=True, progress=False, coarse=True)
    assert mine.read_text() == before


def test_a_folder_that_the_user_names_by_a_link_is_fine(original, tmp_path):
    (tmp_path / "link").symlink_to(original[0])
    assert measure(tmp_path / "link") == original[1]
    assert standing_of(tmp_path / "link") == ""


@pytest.mark.parametrize("time", [1.0001e4, 1e300])
def test_a_time_that_no_run_has_is_told(time, folder):
    manifest = RunFolder(folder).manifest()
    manifest["run"]["time"] = time
    RunFolder(folder).write_manifest(manifest)
    assert "run.time" in refusal(measure, folder)
