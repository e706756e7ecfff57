"""The page of a run, of several and of a campaign: the numbers of the run folder, nothing from outside, no mistake a traceback."""

import html
import io
import json
import re
import shutil
import subprocess
import sys

import pytest
from pages import Page
from rich.console import Console
from rings import small_rings

from pockmark import PHYSICS, PockmarkError, RunFolder, __version__, measure, run_scene
from pockmark.cli.report import report
from pockmark.run.compared import compared
from pockmark.run.reported import cautions
from pockmark.study.campaign import cases, load
from pockmark.study.processes import Processes
from pockmark.study.runner import run_study, write_results
from pockmark.view.report import parts

pytest.importorskip("jinja2")
HOSTILE = "<script>alert(1)</script><img src=http://a.b/c.png>"
LARGEST = 15e6  # bytes of a page


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Two runs that differ in speed; the title of one is hostile."""
    place = tmp_path_factory.mktemp("runs")
    scene = small_rings("4 ns")
    for name, changes in {"slow": {"title": HOSTILE}, "fast": {"impact.speed": "3 km/s"}}.items():
        run_scene(scene.with_(changes), place / name, threads=1, progress=False)
    return place


def page_of(*folders, output):
    report([*folders], output)
    return output.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def slow(original):
    """The page of a run."""
    return page_of(original / "slow", output=original / "slow.html")


def is_offline(text):
    """Return whether a page loads nothing but what is in it, its frames' pages included."""
    page = Page(text)
    loads = [load for one in (page, *page.frames) for load in one.loads]
    assert not [load for load in loads if not load.startswith("data:")]
    assert "@import" not in text
    assert not re.search(r"url\(\s*['\"]?https?:", text)
    assert "kitware.github.io/vtk-js/icon" not in text
    assert "default-src 'none'" in text
    return True


def test_the_page_has_the_numbers_that_are_measured(original, slow):
    result, page = measure(original / "slow"), Page(slow)
    for rows in parts(result).values():
        for name, value in rows:
            place = [n for n, cell in enumerate(page.cells) if cell == name]
            assert any(page.cells[n + 1] == value for n in place), (name, value)
    scene = RunFolder.open(original / "slow").scene()
    depth, shape = compared(scene, result)
    assert depth.value == result["crater"]["depth_over_projectile_diameter"]
    assert page.beside("this run") == f"{depth.value:.4g}"
    for claim in (*depth.claims, *shape.claims):
        assert page.beside(claim.source) == f"{claim.low:.4g}" + (
            f" to {claim.high:.4g}" if claim.high > claim.low else ""
        )
    joules = RunFolder.open(original / "slow").record(scene.grid.cell_count).joules
    assert page.beside("internal") == f"{joules['internal']:.4g}"
    print(f"C_p/d_p {depth.value:.3f}, {len(page.cells)} cells, {len(slow.encode()) / 1e6:.1f} MB")


def test_warnings_stand_before_all_numbers(original, slow):
    for text in measure(original / "slow")["warnings"]:
        assert 0 < slow.index(text[:20]) < slow.index("depth C_p")


def test_a_page_is_offline_and_not_too_large(slow):
    assert is_offline(slow)
    assert len(slow.encode()) < LARGEST


def test_a_page_says_how_to_make_the_run_again(original, slow):
    manifest = RunFolder.open(original / "slow").manifest()
    for key in ("scene_hash", "pockmark", "commit"):
        assert str(manifest[key]) in Page(slow).cells
    assert "pockmark run scene.toml -o slow-again" in slow
    shown = re.findall(r"<pre>(.*?)</pre>", slow, flags=re.S)[-1]
    assert html.unescape(shown) == (original / "slow" / "scene.toml").read_text()


def test_a_hostile_title_is_a_text(slow):
    pytest.importorskip("trame_vtk")
    page = Page(slow)
    assert page.headings[:2] == [HOSTILE, HOSTILE]
    assert page.tags.count("script") == 1  # the one that shows parts of the view
    assert slow.count("<script") == 1


def test_runs_beside_one_another_are_marked_where_they_differ(original, tmp_path):
    text = page_of(original / "slow", original / "fast", output=tmp_path / "page.html")
    assert is_offline(text)
    page, tables = Page(text), [parts(measure(original / name)) for name in ("slow", "fast")]
    for part in tables[0]:
        for (name, one), (_, other) in zip(*(table[part] for table in tables), strict=True):
            n = next(n for n, cell in enumerate(page.cells) if cell == name and page.cells[n + 1] == one)
            assert page.cells[n + 2] == other
    marked = re.findall(r'<tr class="differs"><th scope="row">(.*?)</th>', text)
    assert {"speed", "impact.speed", "depth C_p"} <= set(marked)
    assert not {"angle from the normal", "cells"} & set(marked)


CAMPAIGN = """
title = "two speeds"
scene = "scene.toml"

[[group]]
name = "speeds"
sweep = { "impact.speed" = ["3 km/s", "900 m/s"], "impact.angle" = ["0 deg"] }
"""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """The folder of a campaign, with its table and runs."""
    folder = tmp_path_factory.mktemp("campaign")
    small_rings("8 ns").save(folder / "scene.toml")
    (folder / "campaign.toml").write_text(CAMPAIGN)
    every = cases(load(folder), folder, quick=False, only=[])
    outcomes = run_study(every, folder, pool=Processes(1), console=Console(file=io.StringIO()))
    write_results(outcomes, folder, folder / "results.csv")
    return folder


def test_a_campaign_has_its_table_and_the_slices_of_its_runs(campaign, tmp_path):
    text = page_of(campaign, output=tmp_path / "page.html")
    assert is_offline(text)
    page = Page(text)
    for case in cases(load(campaign), campaign, quick=False, only=[]):
        crater = measure(campaign / case.scene.hash)["crater"]
        n = page.cells.index(case.swept["impact.speed"])
        row = page.cells[n : n + 10]
        assert f"{crater['depth'] * 1e6:.4g}" in row
        assert f"{crater['depth_over_projectile_diameter']:.4g}" in row
    assert "2 of the 2 runs that lie beside the table" in text
    assert text.count('alt="measures against') == 1  # of the one key that has two values


def test_a_table_that_does_not_say_doubts_is_not_called_fine(campaign, tmp_path):
    lines = [line.split(",") for line in (campaign / "results.csv").read_text().splitlines()]
    kept = [
        n for n, name in enumerate(lines[0]) if name in ("impact.speed", "impact.angle", "groups", "scene")
    ]
    (tmp_path / "results.csv").write_text("".join(",".join(line[n] for n in kept) + "\n" for line in lines))
    page = Page(page_of(tmp_path, output=tmp_path / "page.html"))
    assert "an older pockmark wrote it" in page.said[0]


def pockmark(*words):
    return subprocess.run(
        [sys.executable, "-m", "pockmark", *map(str, words)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize(
    "mistake", ["no folder", "no run", "no snapshot", "campaign beside a run", "no table"]
)
def test_a_mistake_is_one_sentence(mistake, original, campaign, tmp_path):
    folder = tmp_path / "run"
    if mistake == "no run":
        folder.mkdir()
    elif mistake == "no snapshot":
        shutil.copytree(original / "slow", folder, ignore=shutil.ignore_patterns("*.vtkhdf*"))
    elif mistake == "no table":
        folder.mkdir()
        (folder / "results.csv").write_text("a,b\n1,2\n")
    beside = [campaign] if mistake == "campaign beside a run" else []
    if beside:
        folder = original / "slow"
    done = pockmark("report", folder, *beside, "-o", tmp_path / "page.html")
    print(done.stderr)
    assert done.returncode == 2
    assert done.stderr.startswith("pockmark: ")
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("place", [".", "there"])
def test_a_folder_is_no_place_for_a_page(place, original, tmp_path, monkeypatch):
    (tmp_path / "there").mkdir()
    monkeypatch.chdir(tmp_path)
    done = pockmark("report", original / "slow", "-o", place)
    assert done.returncode == 2
    assert done.stderr.startswith(f"pockmark: -o: {place}: is a folder, expected the file of the page")
    assert done.stderr.count("\n") == 1


def test_a_run_without_a_crater_has_a_page(tmp_path):
    run_scene(small_rings("8 ns").with_("impact.speed", 0), tmp_path / "run", threads=1, progress=False)
    text = page_of(tmp_path / "run", output=tmp_path / "page.html")
    assert Page(text).beside("crater") == "none"
    assert "There is no crater to show" in text


@pytest.mark.parametrize("made_by", [{"physics": PHYSICS + 1}, {"pockmark": "99.0"}])
def test_what_a_newer_pockmark_made_is_told(made_by):
    now = {"pockmark": __version__, "physics": PHYSICS}
    assert not cautions(now)
    assert "which is newer than this one" in cautions(now | made_by)[0]


DOUBT = "points had no volume left: 3 times in all"


@pytest.fixture(scope="module")
def worst(original, tmp_path_factory):
    """The page of a doubtful run of a newer pockmark, of which one snapshot is left, where trame-vtk is missing."""
    folder = tmp_path_factory.mktemp("worst") / "run"
    shutil.copytree(original / "slow", folder)
    for name in ("snapshot-0000.vtkhdf", "snapshot-0001.vtkhdf"):
        (folder / name).unlink()
    manifest = json.loads((folder / "manifest.json").read_text())
    changed = manifest | {"physics": PHYSICS + 1, "doubts": [DOUBT]}
    (folder / "manifest.json").write_text(json.dumps(changed))
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "trame_vtk.modules.vtk", None)
        return page_of(folder, output=folder / "page.html")


def test_a_newer_pockmark_and_doubts_stand_first(worst):
    said = Page(worst).said
    assert "which is newer than this one" in said[0]
    assert said[1] == f"doubtful: {DOUBT}"


def test_a_run_with_one_snapshot_says_so(worst, slow):
    assert "one snapshot: there is nothing to animate" in worst
    assert "image/gif" not in worst
    assert "image/gif" in slow


def test_without_trame_the_page_says_what_to_install(worst, slow):
    pytest.importorskip("trame_vtk")
    assert "pip install &#39;pockmark[report]&#39;" in worst
    assert not Page(worst).frames
    assert len(Page(slow).frames) == 1


def test_a_run_that_was_killed_while_it_wrote_has_a_page_of_what_is_whole(original, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(original / "slow", folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps(manifest | {"status": "running"}))
    with (folder / "snapshot-0002.vtkhdf").open("r+b") as file:
        file.truncate(3000)
    text = page_of(folder, output=tmp_path / "page.html")
    assert "killed at 8 ns; the last snapshot is of 4 ns" in text
    assert "2 of 3 snapshots" in text


def test_without_jinja_it_is_one_sentence(original, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(PockmarkError, match=r"Jinja2 is not installed: pip install 'pockmark\[report\]'"):
        report([original / "slow"], tmp_path / "page.html")
