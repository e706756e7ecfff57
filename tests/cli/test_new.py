"""`pockmark new` and `demo`: a scene to start from, a crater in seconds; and what comes with the package is what the checkout has."""

import re
import subprocess
import sys
import time
from pathlib import Path

import matplotlib.image
import pytest
import typer.main
from typer.testing import CliRunner

from pockmark import PockmarkError, Scene, measure
from pockmark.base.shipped import example, examples, shipped
from pockmark.cli import app
from pockmark.cli.demo import NEXT
from pockmark.scene.forecast import forecast
from pockmark.scene.warnings import warnings
from pockmark.study.campaign import cases, load

ROOT = Path(__file__).parents[2]
TEMPLATES = ["rings", "half", "oblique", "group"]


def said(*words):
    done = CliRunner().invoke(app, list(map(str, words)), catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


def test_the_examples_are_those_of_the_checkout():
    ours = {path.stem: path.read_text() for path in (ROOT / "examples").glob("*.toml")}
    assert {name: path.read_text() for name, path in examples().items()} == ours
    assert set(TEMPLATES) < set(ours)


def test_the_campaigns_are_those_of_the_checkout_and_load():
    """Their scenes are found from where they lie: in a wheel, too."""
    theirs = {path.parent.name for path in (ROOT / "studies").glob("*/campaign.toml")}
    ours = {path.parent.name for path in shipped("studies").glob("*/campaign.toml")}
    assert ours == theirs
    for name in ours:
        folder = shipped("studies") / name
        campaign = load(folder)
        assert cases(campaign, folder, quick=True, only=[])
        assert not campaign.report or (folder / campaign.report).is_file()


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_template_runs_as_it_is_without_a_warning(name):
    assert warnings(Scene.load(example(name))) == []


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_template_has_a_comment_on_most_of_its_lines(name):
    lines = [line for line in example(name).read_text().splitlines() if line]
    commented = sum("#" in line for line in lines)
    print(f"{name}: {commented} of {len(lines)} lines")
    assert commented > 0.4 * len(lines)


def test_a_new_scene_is_the_example_and_is_never_overwritten(tmp_path):
    path = tmp_path / "mine.toml"
    text = said("new", tmp_path / "mine")
    assert f"pockmark run {path}" in text
    assert path.read_text() == example("rings").read_text()
    path.write_text("# my work")
    with pytest.raises(PockmarkError, match=r"mine\.toml: is there, and is not overwritten"):
        said("new", path)
    assert path.read_text() == "# my work"


def test_a_link_that_leads_nowhere_is_not_followed(tmp_path):
    (tmp_path / "mine.toml").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PockmarkError, match=r"mine\.toml: "):
        said("new", tmp_path / "mine")
    assert not (tmp_path / "elsewhere").exists()


def test_a_slip_is_one_sentence(tmp_path):
    with pytest.raises(PockmarkError, match="obliq: is no example, nearest are oblique, "):
        said("new", tmp_path / "mine", "--from", "obliq")
    with pytest.raises(PockmarkError, match="No such file"):
        said("new", tmp_path / "nowhere" / "mine")
    assert not list(tmp_path.iterdir())


def test_the_examples_are_listed():
    text = said("new", "--list")
    assert all(name in text for name in examples())


def test_a_campaign_that_is_nowhere_is_one_sentence():
    with pytest.raises(
        PockmarkError, match=r"singl: is no folder with a .*, nor one of pockmark's: .*single-particle"
    ):
        said("study", "singl")


def test_the_table_of_pockmarks_own_campaign_is_written_to_the_user(tmp_path, monkeypatch):
    """Where the package lies nothing is written."""
    ours = tmp_path / "package" / "studies" / "small"
    ours.mkdir(parents=True)
    (ours / "scene.toml").write_text(example("quick").read_text())
    sweep = (
        'set = { "end_time" = "2 ns" }\n[[group]]\nname = "one"\nsweep = { "impact.speed" = ["3 km/s"] }\n'
    )
    (ours / "campaign.toml").write_text(f'scene = "scene.toml"\ncoarse = true\n{sweep}')
    monkeypatch.setattr("pockmark.cli.study.shipped", lambda kind: tmp_path / "package" / kind)
    monkeypatch.chdir(tmp_path)
    before = set((tmp_path / "package").rglob("*"))
    said("study", "small", "-o", "out")
    assert "3 km/s" in (tmp_path / "out" / "small" / "results.csv").read_text()
    assert set((tmp_path / "package").rglob("*")) == before


def test_the_demo_makes_a_crater_and_says_what_is_next(tmp_path):
    start = time.perf_counter()
    words = ("-m", "pockmark", "demo", "-o", "run", "--quiet", "--threads", "2")
    done = subprocess.run(
        [sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120
    )
    print(f"{time.perf_counter() - start:.1f} s")
    assert done.returncode == 0, done.stderr
    for part in ("depth C_p", "energy", "ledger error", "pockmark new my-impact.toml", "crater.png"):
        assert part in done.stdout.replace("energies", "energy")
    table = measure(tmp_path / "run")
    print(f"C_p {table['crater']['depth'] * 1e6:.2f} um, D_c {table['crater']['diameter'] * 1e6:.2f} um")
    assert table["warnings"] == table["doubts"] == []
    assert 10e-6 < table["crater"]["depth"] < 25e-6
    assert abs(table["crater"]["depth_change_last_tenth"]) < 0.01
    files = sum(file.stat().st_size for file in (tmp_path / "run").iterdir())
    at_most = forecast(Scene.load(tmp_path / "run" / "scene.toml"), 2).disk
    print(f"disk {files / 1e6:.2f} MB, forecast at most {at_most / 1e6:.2f} MB")
    assert files < at_most < 1.5 * files
    for name in ("crater.png", "history.png"):
        assert matplotlib.image.imread(tmp_path / "run" / name)[..., :3].std() > 0.1


def test_what_the_demo_names_is_there():
    known = typer.main.get_command(app).commands
    named = re.findall(r"pockmark (\w+)", NEXT)
    assert len(named) > 4
    assert set(named) <= set(known)
