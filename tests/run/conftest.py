"""A run folder to alter."""

import shutil
from pathlib import Path

import pytest
from altered import QUICK

from pockmark import Scene, measure
from pockmark.run.pipeline import run_scene


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """A run of 2,000 points with three snapshots, and what it measures."""
    path = tmp_path_factory.mktemp("original") / "run"
    coarse = ["grid.cell='10 um'", "body.target.spacing='5 um'", "body.projectile.spacing='2.5 um'"]
    short = ["end_time='8 ns'", "output.snapshots='4 ns'"]
    run_scene(Scene.load(QUICK, [*coarse, *short]), path, threads=1, progress=False, coarse=True)
    return path, measure(path)


@pytest.fixture
def folder(original, tmp_path):
    """A copy of it."""
    return Path(shutil.copytree(original[0], tmp_path / "run"))
