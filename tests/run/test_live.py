"""The depth that is told while a run goes on: of the deepest column, wherever it is."""

from pathlib import Path

import numpy as np
import pytest

from pockmark import Scene, Simulation, measure, run_scene
from pockmark.run import tasks
from pockmark.run.live import Live, live_depth
from pockmark.run.store import RunFolder
from pockmark.run.tasks import ProgressBar

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
LONG = ["grid.upper=['100 um','50 um','30 um']", "body.target.upper=['100 um','50 um','0 um']"]


@pytest.mark.parametrize("change", ["impact.angle=0", "impact.angle='60 deg'", "grid.geometry=axisymmetric"])
def test_the_last_live_depth_is_the_crater_depth(change, tmp_path):
    """At 60 degrees the deepest column is a diameter off the projectile's axis."""
    scene = Scene.load(QUICK, [change, *LONG[: None if "angle" in change else 0]])
    run_scene(scene, tmp_path / "run", threads=1, progress=False)
    crater = measure(tmp_path / "run")["crater"]
    depth = RunFolder.open(tmp_path / "run").history("depth")["depth"]
    print(
        f"C_p {crater['depth'] * 1e6:.2f} um at x = {crater['bottom_x'] * 1e6:.1f}, live {depth[-1] * 1e6:.2f} um"
    )
    assert depth[-1] == pytest.approx(crater["depth"], rel=0.1)
    assert abs(depth[0]) < 1e-12
    assert np.isfinite(depth).all()


def simulation(*changes, threads=1):
    made = Simulation(Scene.load(QUICK, changes), threads)
    made.advance(2e-9)
    return made


@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["numerics.shape_functions='quadratic'"],
        ["numerics.precision='single'"],
        ["contact={friction=0.3}"],
    ],
)
def test_the_fraction_is_the_volume_around_each_node(changes):
    s = simulation(*changes)
    grid = s.scene.grid
    of_target = s.field("body") == 0
    x = (s.field("position")[of_target] - grid.lower) / grid.cell + 1
    share = s.field("volume")[of_target] / grid.cell**3
    exact = np.zeros([n + 3 for n in grid.cells])
    base = np.floor(x).astype(int)
    for i, j, k in np.ndindex(2, 2, 2):
        weight = np.prod(np.where([i, j, k], x - base, 1 - (x - base)), axis=1)
        np.add.at(exact, tuple((base + np.array([i, j, k])).T), share * weight)
    found = s.volume_fraction([0])
    print(f"off by {np.abs(found - exact).max():.1e}")
    assert found.shape == exact.shape
    assert np.abs(found - exact).max() < 1e-5
    assert exact.max() > 0.9
    assert np.abs(s.volume_fraction([0, 1]).sum() - found.sum()) > 1


def test_the_depth_does_not_depend_on_the_threads():
    one, two = (simulation(threads=n).volume_fraction([0]) for n in (1, 2))
    assert np.array_equal(one, two)


def plate(speed, time):
    wall = ["body.target.lower=['-50 um','0 um','-10 um']", "boundary.z_lower='free'"]
    s = Simulation(Scene.load(QUICK, [*wall, f"impact.speed='{speed}'"]), 1)
    s.advance(time)
    return s


def test_a_perforated_plate_says_so_in_the_progress_bar(capsys):
    s = plate("5 km/s", 25e-9)
    live = live_depth(s)
    assert live.is_perforated
    assert np.isnan(live.depth)
    bar = ProgressBar(s)
    bar.watch(s)
    bar.close()
    assert "perforated" in capsys.readouterr().out
    whole = live_depth(plate("500 m/s", 5e-9))
    assert not whole.is_perforated
    assert 1e-6 < whole.depth < 4e-6


@pytest.mark.parametrize(
    ("depth", "said"), [(0.01, "10 mm"), (14.62e-6, "14.6 um"), (-0.0, "0 um"), (np.nan, "nan um")]
)
def test_the_progress_bar_says_a_depth_in_a_unit_that_suits_it(depth, said, capsys, monkeypatch):
    s = plate("500 m/s", 1e-9)
    monkeypatch.setattr(tasks, "live_depth", lambda _: Live(depth))
    bar = ProgressBar(s)
    bar.watch(s)
    bar.close()
    assert f"about {said}" in " ".join(capsys.readouterr().out.split())


def test_a_crater_down_to_what_is_not_computed_has_no_depth():
    bottom = ["body.target.lower=['-50 um','0 um','-10 um']", "grid.lower=['-50 um','0 um','-10 um']"]
    s = Simulation(Scene.load(QUICK, [*bottom, "impact.speed='5 km/s'"]), 1)
    s.advance(25e-9)
    live = live_depth(s)
    assert np.isnan(live.depth)
    assert not live.is_perforated


def test_without_a_target_there_is_no_depth():
    table = Scene.load(QUICK).to_dict()
    table["body"] = table["body"][1:]
    assert np.isnan(live_depth(Simulation(Scene.from_dict(table), 1)).depth)
