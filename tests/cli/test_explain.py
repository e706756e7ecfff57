"""`pockmark explain` and `materials`: what a person and a program read there, and one sentence for what is not there."""

import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from pockmark.base.errors import PockmarkError
from pockmark.cli import app
from pockmark.scene.materials import library


def said(*words):
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


def test_a_key_is_told_in_full():
    text = said("explain", "impact.angle")
    for part in ("normal of the surface", "rad", "0 rad", "more than -90 deg, less than 90 deg"):
        assert part in text


def test_all_keys_are_listed():
    text = said("explain")
    for part in (
        "the scene",
        "numerics.filter",
        "body (sphere)",
        "end_time",
        "materials.NAME.eos (tillotson)",
    ):
        assert part in text


def test_a_program_reads_a_key():
    keys = json.loads(said("explain", "cfl", "--json"))
    assert [(key["path"], key["default"]) for key in keys] == [("numerics.cfl", "0.5")]


def test_each_material_is_listed_with_its_source():
    text = said("materials")
    for name, table in library().items():
        assert name in text
        assert table["source"].split()[0] in text


def test_a_material_has_its_constants():
    text = said("materials", "cu-ofhc-spall")
    for part in ("failure.pressure", "1.35e+09 Pa", "no primary source", 'based_on = "cu-ofhc-spall"'):
        assert part in text


def test_a_program_reads_a_material():
    table = json.loads(said("materials", "cu-ofhc", "--json"))["cu-ofhc"]
    assert table["density"] == 8930.0
    assert table["at_rest"]["yield_strength"] == pytest.approx(90e6)


@pytest.mark.parametrize("words", [("explain", "impact.sped"), ("materials", "al2024")])
def test_what_is_not_there_is_one_sentence(words):
    with pytest.raises(PockmarkError, match="nearest are"):
        CliRunner().invoke(app, words, catch_exceptions=False)
    done = subprocess.run(
        [sys.executable, "-m", "pockmark", *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
