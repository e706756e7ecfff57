"""What is printed and written as JSON: whole, honest about what is missing, and adding up."""

import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from pockmark import PockmarkError, Scene, Simulation, measure
from pockmark.base.counters import COUNTERS
from pockmark.base.json import to_json
from pockmark.base.ledger import DRAWN, LEDGER, LEFT_ENERGIES, LEFT_MOMENTUM, SHARES
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder
from pockmark.view.report import report

ROOT = Path(__file__).parents[2]
QUICK = ROOT / "examples" / "quick.toml"


def printed(result):
    console = Console(width=120, file=io.StringIO())
    console.print(report(result))
    return console.file.getvalue()


def short(path, *changes):
    run_scene(Scene.load(QUICK, ["end_time='4 ns'", *changes]), path, threads=1, progress=False)
    return measure(path)


def test_a_run_without_projectile_energy_or_crater_is_printed(tmp_path):
    result = short(tmp_path / "run", "impact.speed=0")
    assert result["crater"]["depth"] is None
    assert set(result["energy"].values()) == {None}
    assert "none" in printed(result)
    plot_run(tmp_path / "run")


@pytest.mark.parametrize(
    "missing", ["diameter", "volume", "depth_over_projectile_diameter", "depth_over_diameter"]
)
def test_what_is_not_known_is_a_dash(missing, tmp_path):
    result = short(tmp_path / "run")
    result["crater"] |= dict.fromkeys(("depth", "diameter", "volume"), 1e-6) | {missing: None}
    print(text := printed(result))
    assert " - " in text


def test_no_number_is_null_in_json():
    value = {"a": [math.nan, 1.0], "b": {"c": -math.inf}, "d": np.float64("nan"), "e": True}
    assert json.loads(to_json(value)) == {"a": [None, 1.0], "b": {"c": None}, "d": None, "e": True}


def test_a_manifest_with_null_is_measured(tmp_path):
    short(tmp_path / "run")
    folder = RunFolder.open(tmp_path / "run")
    manifest = folder.manifest()
    manifest["ledger"]["internal"] = math.nan
    manifest["run"]["max_compression"] = math.inf
    folder.write_manifest(manifest)
    result = measure(folder.path)
    assert result["energy"]["residual_internal"] is result["run"]["max_compression"] is None
    assert "-" in printed(json.loads(to_json(result)))


def test_a_failed_run_is_measured_at_one_time_and_says_so(tmp_path, monkeypatch):
    calls = iter(range(1000))
    advance = Simulation.advance

    def break_down(self, *args, **kwargs):
        if next(calls) == 5:
            raise RuntimeError("the time step is no longer a number")
        return advance(self, *args, **kwargs)

    monkeypatch.setattr(Simulation, "advance", break_down)
    with pytest.raises(PockmarkError, match=r"the run stopped at 1\.\d+e-08 s: the time step"):
        run_scene(Scene.load(QUICK), tmp_path / "run", threads=1, progress=False)
    result = measure(tmp_path / "run")
    print(text := printed(result))
    assert result["run"]["status"] == "failed"
    assert 0 < result["crater"]["time"] == result["run"]["time"] < 60e-9
    assert RunFolder.open(tmp_path / "run").history()["time"][-1] == result["run"]["time"]
    assert "failed (to end at 60 ns)" in text
    stopped = f"{result['run']['time'] * 1e9:.4g} ns"
    assert text.count(stopped) == 2  # of the crater, of the energies


def test_points_that_are_nowhere_make_no_crater(tmp_path, monkeypatch):
    field = Simulation.field

    def lost(self, name):
        return field(self, name) * (np.nan if name == "position" else 1)

    monkeypatch.setattr(Simulation, "field", lost)
    assert short(tmp_path / "run")["crater"]["depth"] is None


def test_the_energies_that_are_shown_add_up_when_points_leave(tmp_path):
    """A block flies out of the grid and takes its energy with it."""
    table = Scene.load(QUICK).to_dict()
    table["grid"]["upper"][2] = 20e-6
    table["body"][1]["center"][2] = 10e-6
    table["impact"] |= {"speed": 2200.0, "angle": 1.55}  # sideways, out of the free face
    table["boundary"]["x_upper"] = "free"
    table["numerics"]["pic_fraction"] = 0.01
    run_scene(Scene.from_dict(table), tmp_path / "run", threads=1, progress=False)
    result = measure(tmp_path / "run")
    energy = result["energy"]
    print(printed(result))
    assert energy["left_kinetic"] > 0.1
    assert energy["left"] == pytest.approx(energy["left_kinetic"] + energy["left_internal"])
    parts = ("residual_internal", "kinetic", "left_kinetic", "absorbed", "pic", "contact")
    assert sum(energy[key] for key in parts) == pytest.approx(1 + energy["ledger_error"], abs=1e-12)
    assert RunFolder.open(tmp_path / "run").history()["left_momentum_x"][-1] > 0


def test_every_column_of_the_history_is_explained(tmp_path):
    document = (ROOT / "docs" / "output.md").read_text()
    short(tmp_path / "run")
    for name in RunFolder.open(tmp_path / "run").history():
        prefix, _, axis = name.rpartition("_")
        assert f"`{name}`" in document or (axis in ("y", "z") and f"`{prefix}_x`, `_y`, `_z`" in document)


def test_every_counter_is_explained():
    document = (ROOT / "docs" / "output.md").read_text()
    assert all(f"| `{name}` | {counter.what} |" in document for name, counter in COUNTERS.items())
    assert list(COUNTERS) == list(Simulation(Scene.load(QUICK), threads=1).counters())


def test_every_key_of_the_ledger_is_explained():
    document = (ROOT / "docs" / "output.md").read_text()
    assert all(f"| `{name}` | {text} |" in document for name, text in LEDGER.items())
    assert LEDGER.keys() <= Simulation(Scene.load(QUICK), threads=1).ledger().keys()
    assert LEDGER.keys() >= {*SHARES, *DRAWN, *LEFT_ENERGIES, *LEFT_MOMENTUM}
