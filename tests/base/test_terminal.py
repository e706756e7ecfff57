"""A user's texts reach the terminal and the pictures as they are: never as markup, never with control characters."""

import io
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from pockmark import PockmarkError, Scene
from pockmark.base.errors import found, shown, together
from pockmark.base.geometry import Setup
from pockmark.base.terminal import literal, make_console
from pockmark.study.campaign import Case
from pockmark.study.processes import Processes
from pockmark.study.runner import Outcome, run_study, summary
from pockmark.view.plots import slice_figure

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
HOSTILE = [
    "x [/b] y",
    "[red]x[/red]",
    "[link=http://a]x",
    ":smile: [@click=x]",
    r"\[b]",
    r"cost $\frac{$ _^{",
    "_x",
    "%s{0}",
]
CONTROL = [
    "\x1b[31mred",
    "a\nb",
    "a\rb",
    "\x07",
    "\u202eabc",
    "\u2028",
    "\x9b31m",
    "\x7f",
    "a\x00b",
    "\u2066x",
]


def printed(*things, console=None):
    console = console or Console()
    console.file = io.StringIO()
    console.print(*things)
    return console.file.getvalue()


@pytest.mark.parametrize("text", [*HOSTILE, *CONTROL])
def test_a_literal_is_printed_as_it_is(text):
    said = printed(literal(text)).removesuffix("\n")
    print(said)
    assert said.isprintable()
    assert said == (text if text in HOSTILE else ascii(text)[1:-1])


@pytest.mark.parametrize("text", HOSTILE)
def test_the_consoles_of_pockmark_know_no_markup(text):
    assert printed(text, console=make_console()).strip() == text


@pytest.mark.parametrize("text", [*HOSTILE, *CONTROL])
def test_titles_labels_and_faults_of_a_study_are_literal(text):
    case = Case(Scene.load(QUICK), {"a": text}, [text])
    said = printed(summary([Outcome(case, None, text)], text), console=Console(width=300))
    wanted = text if text in HOSTILE else ascii(text)[1:-1]
    print(said)
    assert said.count(wanted) == 4
    assert said.replace("\n", "").isprintable()


def test_what_a_study_says_of_a_run_is_literal(tmp_path):
    """In a process of its own a run fails at once: its folder is a file."""
    case = Case(Scene.load(QUICK), {"k": "[/b] \x1b[31m"}, ["g[/b]"])
    (tmp_path / case.scene.hash).write_text("mine")
    console = Console(file=io.StringIO(), width=300)
    run_study([case], tmp_path, pool=Processes(1), console=console)
    said = console.file.getvalue()
    print(said)
    assert r"g[/b], k [/b] \x1b[31m: is a file" in said


@pytest.mark.parametrize("text", [*CONTROL, "x" * 10_000, "\x1b" * 10_000])
def test_an_error_is_short_and_printable(text):
    said = str(PockmarkError(f"{text}: {found(text)}, {text}"))
    print(said)
    assert said.isprintable()
    assert len(said) < 500


def test_what_is_shown_has_its_beginning_and_its_end():
    assert shown("a" * 300 + "z" * 300, 100) == "a" * 70 + " ... " + "z" * 25
    assert shown("\u00b5 \u6f22 \U0001f600 e\u0301") == "\u00b5 \u6f22 \U0001f600 e\u0301"


def test_faults_are_told_together_as_far_as_there_is_room():
    assert together(["a", "b", "a"]) == "a; b"
    many = together([f"{n}: " + "x" * 100 for n in range(9)])
    print(many)
    assert many.startswith("0: xxx")
    assert many.endswith("; and 6 more")


def test_check_and_run_print_any_title_and_name(tmp_path):
    text = "[/b] \\u001b[31m\\n\\u202e $\\\\frac{$"
    toml = QUICK.read_text().replace('name = "projectile"', f'name = "{text}"').replace('"60 ns"', '"1 ns"')
    toml = toml.replace('title = "', f'title = "{text} ').replace('radius = "10 um"', 'radius = "9.7 um"')
    toml = toml.replace('material = "al2024-liu2015"', f'material = "{text}"')
    path = tmp_path / "[b] \x1b[31mscene.toml"
    path.write_text(f'{toml}\n[materials."{text}"]\nbased_on = "al2024-liu2015"\n', encoding="utf-8")
    for command in (["check", path], ["run", path, "-o", tmp_path / "[b]", "--threads", "1"]):
        done = subprocess.run(
            [sys.executable, "-m", "pockmark", *map(str, command)],
            capture_output=True,
            text=True,
            check=False,
        )
        print(done.stdout, done.stderr)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.replace("\n", "").isprintable()
        wanted = text.encode().decode("unicode_escape")
        assert shown(wanted) in " ".join(done.stdout.split())
    assert {"crater.png", "history.png"} <= {p.name for p in (tmp_path / "[b]").iterdir()}


@pytest.mark.parametrize("command", ["check", "measure", "study"])
def test_a_name_of_a_file_is_no_escape_sequence(command, tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "pockmark", command, str(tmp_path / "no\x1b[31m\n[b]")],
        capture_output=True,
        text=True,
        check=False,
    )
    print(done.stderr)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.endswith("\n")
    assert done.stderr[:-1].isprintable()
    assert r"no\x1b[31m\n[b]" in done.stderr


def test_a_terminal_that_knows_no_umlauts_gets_escapes(tmp_path):
    (tmp_path / "a.toml").write_text(
        QUICK.read_text().replace('title = "', 'title = "\u00e9\u6f22 '), encoding="utf-8"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pockmark", "check", str(tmp_path / "a.toml")],
        capture_output=True,
        text=True,
        check=False,
        env={"PYTHONIOENCODING": "ascii", "PYTHONPATH": ":".join(sys.path)},
    )
    print(done.stdout, done.stderr)
    assert done.returncode == 0
    assert r"\xe9\u6f22" in done.stdout


@pytest.mark.parametrize("text", ["[/b]", r"cost $\frac{$", "_x", "\x1b[31m\n", "x" * 100_000], ids=ascii)
def test_pictures_show_titles_and_names_as_they_are(text):
    n = 4
    snapshot = {
        "position": np.random.default_rng(1).uniform(-1e-5, 0, (n, 3)) * [1, 0, 1],
        "body": np.array([0, 1, 0, 1]),
        "volume": np.full(n, 1e-18),
        "mass": np.full(n, 1e-15),
        "deviator": np.zeros((n, 6)),
        "pressure": np.zeros(n),
        "time": np.zeros(1),
    }
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = slice_figure(snapshot, Setup(1e-6, names=(text, "other")), crater=None, title=text)
        figure.savefig(io.BytesIO())
    legend = figure.axes[0].get_legend().get_texts()
    assert [t.get_text() for t in legend] == [shown(text, 40), "other"]
    assert figure.get_suptitle() == shown(text, 80)
    assert not legend[0].get_parse_math()
