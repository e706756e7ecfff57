"""The examples of README.md and docs/ run: scenes, commands and Python, in their order, in one folder a document; C++ is the core's.

A block that does not run here says why in the line above it: <!-- not run: the reason -->.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

from pockmark import PockmarkError, Scene
from pockmark.cli import app
from pockmark.study.campaign import cases, load

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"(?:<!-- not run: (.+?) -->\n)?^ *```(\w*)\n(.*?)^ *```$", re.M | re.S)
# What makes the README's scene one of seconds. The cells stay: what a command asks for must go with them.
SMALL = (
    "end_time='6 ns'",
    "grid.lower=['-24 um', '0 um', '-20 um']",
    "grid.upper=['24 um', '24 um', '24 um']",
    "body.target.lower=['-24 um', '0 um', '-20 um']",
    "body.target.upper=['24 um', '24 um', '0 um']",
    "output.snapshots='2 ns'",
)
# A run that has finished needs somewhere to go on to; a study of cells is one of seconds.
ADDED = {"resume": ["--end-time", "8 ns"], "converge": ["--budget", "1 s", "--levels", "2"]}


def blocks(document):
    """Yield the reason not to run a block, its language and its text."""
    yield from (found.groups() for found in BLOCK.finditer(document.read_text(encoding="utf-8")))


def commands(text):
    """Return the commands of a block, without comments, each as its words."""
    return [words for line in text.splitlines() if (words := shlex.split(line, comments=True))]


def runs(words, folder):
    """Run one command or Python program there; fail with what it said."""
    # Matplotlib draws without a screen, and nothing waits for a key.
    environment = os.environ | {"MPLBACKEND": "agg"}
    done = subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, f"{shlex.join(words)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}"


def stands_in_the_core(text):
    """Return whether a file of core/ has these lines, one after another, however they are indented and broken."""
    wanted = "".join(text.split())
    return any(
        wanted in "".join(path.read_text(encoding="utf-8").split()) for path in ROOT.glob("core/**/*.hpp")
    )


def write_small_campaign(words, folder):
    """Let a study that has the figure asked for be one run of the small scene: tests/studies runs the real ones."""
    name, figure = words[2], words[words.index("--only") + 1]
    real, small = ROOT / "studies" / name, folder / "studies" / name
    assert cases(load(real), real, quick=False, only=[figure])
    small.mkdir(parents=True)
    sweep = '{ "impact.speed" = ["3 km/s"] }'
    group = f'[[group]]\nname = "one"\nfigures = ["{figure}"]\nsweep = {sweep}\n'
    (small / "campaign.toml").write_text(f'scene = "../../scene.toml"\n{group}', encoding="utf-8")


def test_blocks_are_found_whole():
    """Each fence belongs to a block that is found, and the README has one of each kind."""
    for document in DOCUMENTS:
        fences = re.findall(r"^ *```", document.read_text(encoding="utf-8"), flags=re.M)
        assert len(fences) == 2 * len(list(blocks(document))), document.name
    kinds = [language for reason, language, _ in blocks(ROOT / "README.md") if not reason]
    assert sorted(kinds) == ["", "python", "toml"]


WITH_BLOCKS = [d for d in DOCUMENTS if any(True for _ in blocks(d))]


@pytest.mark.parametrize("document", WITH_BLOCKS, ids=lambda document: document.name)
def test_the_examples_of_a_document_run(document, tmp_path):
    ran = []
    for reason, language, text in blocks(document):
        if reason:
            continue
        if language == "toml":
            (tmp_path / "written.toml").write_text(text, encoding="utf-8")
            Scene.load(tmp_path / "written.toml")
            Scene.load(tmp_path / "written.toml", SMALL).save(tmp_path / "scene.toml")
        elif language == "python":
            runs(["-c", text], tmp_path)
        elif language == "cpp":
            assert stands_in_the_core(text), f"{document.name}: no file of core/ has these lines:\n{text}"
        else:
            for words in commands(text):
                assert words[0] == "pockmark", f"{document.name}: {shlex.join(words)}: neither run nor marked"
                if words[1] == "study":
                    write_small_campaign(words, tmp_path)
                added = ADDED.get(words[1], [])
                runs(["-m", *words, *([] if set(added) & set(words) else added)], tmp_path)
        ran.append(language or "commands")
    print(f"{document.name}: {', '.join(ran)}")


def test_commands_named_in_the_text_are_there():
    """What stands as `pockmark NAME --option` anywhere has that name and those options."""
    known = {
        name: {option for parameter in command.params for option in parameter.opts}
        for name, command in typer.main.get_command(app).commands.items()
    }
    named = 0
    for document in [*DOCUMENTS, *ROOT.glob("*.md"), *ROOT.glob("*/README.md")]:
        for text in re.findall(r"`pockmark ([^`\n]+)`", document.read_text(encoding="utf-8")):
            name, *words = shlex.split(text)
            options = {word.strip("[]").split("=")[0] for word in words if word.strip("[").startswith("-")}
            assert name in known, f"{document.name}: pockmark {text}"
            assert options <= known[name], f"{document.name}: pockmark {text}"
            named += 1
    print(f"{named} commands named, of {len(known)}")
    assert named > 20


def test_a_scene_with_a_mistake_would_be_seen(tmp_path):
    """The README's scene with one key misspelt."""
    text = next(text for _, language, text in blocks(ROOT / "README.md") if language == "toml")
    (tmp_path / "scene.toml").write_text(text.replace("spacing =", "spacin =", 1), encoding="utf-8")
    with pytest.raises(PockmarkError, match="spacin"):
        Scene.load(tmp_path / "scene.toml")
