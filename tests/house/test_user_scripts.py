"""The Python of README.md and docs/ is typed as a user's may be: `mypy --strict` passes on it, and sees a mistake."""

import subprocess
import sys
from pathlib import Path

import pytest
from test_examples import DOCUMENTS, blocks

import pockmark

SCRIPTS = [
    (document.name, number, text)
    for document in DOCUMENTS
    for number, (reason, language, text) in enumerate(blocks(document))
    if language == "python" and not reason
]
MISTAKES = [
    'from pockmark import Scene\nScene.load("a.toml").with_("impact.speed")\n',
    'from pockmark import measure\nmeasure("a").depth\n',
    "from pockmark import Simulation\nSimulation(3)\n",
    "from pockmark import Grid\nGrid(lower=(0.0, 0.0, 0.0), upper=(1.0, 1.0, 1.0))\n",
    "from pockmark import nothing\n",
]


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What mypy says of each script and mistake, in one run."""
    folder = tmp_path_factory.mktemp("scripts")
    for name, number, text in SCRIPTS:
        (folder / f"{Path(name).stem}_{number}.py").write_text(text)
    for number, text in enumerate(MISTAKES):
        (folder / f"mistake_{number}.py").write_text(text)
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", *sorted(path.name for path in folder.glob("*.py"))],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stdout + done.stderr


@pytest.mark.parametrize(("name", "number"), [(name, number) for name, number, _ in SCRIPTS])
def test_a_script_passes_strictly(name, number, said):
    assert f"{Path(name).stem}_{number}.py:" not in said, said


@pytest.mark.parametrize("number", range(len(MISTAKES)))
def test_a_mistake_is_seen(number, said):
    assert f"mistake_{number}.py:" in said, said


def test_there_are_scripts():
    assert len(SCRIPTS) > 5


def test_what_is_public_is_listed():
    assert dir(pockmark) == sorted(dir(pockmark))
    assert {"Scene", "Simulation", "Task", "Material", "bodies", "measure", "run_scene"} < set(dir(pockmark))
    for name in dir(pockmark):
        assert getattr(pockmark, name) is not None
        assert name.startswith("__") or name == "PHYSICS" or getattr(pockmark, name).__doc__, name
    with pytest.raises(AttributeError, match="nothing"):
        pockmark.nothing  # noqa: B018
