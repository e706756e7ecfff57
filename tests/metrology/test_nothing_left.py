"""What is left of an impact may be anything, or nothing: every snapshot is measured and drawn, and says what it lacks."""

import io
import json
import math
import warnings

import numpy as np
import pytest
from rich.console import Console

from pockmark import Scene, Simulation, measure
from pockmark.base.json import finite, to_json
from pockmark.base.ledger import LEDGER as KEYS
from pockmark.cli import main
from pockmark.metrology.measures import measures
from pockmark.metrology.results import crater_of, depth_change, filling_of
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.points import make_points
from pockmark.run.resolution import resolution_of
from pockmark.run.setup import setup_of
from pockmark.run.store import RunFolder
from pockmark.view.plots import HISTORY_COLUMNS, history_figure, slice_figure
from pockmark.view.report import report

LEDGER = dict.fromkeys(KEYS, 0.0) | {"initial": 1.0}
RUN = {"status": "finished", "end_time": 1e-8, "time": 1e-8, "max_compression": 1.0, "points": 1, "steps": 1}
RUN |= {
    "torn_rows": 0,
    "failure_treatment": "",
    "scheme": "",
    "shape_functions": "",
    "particle_steps_per_second": 1.0,
}
BALL = '{name = "ball", shape = "sphere", center = ["0 um", "0 um", "6 um"], radius = "6 um", spacing = "2 um", material = "al2024-liu2015", projectile = true}'
SWARM = BALL.replace(
    'shape = "sphere", center = ["0 um", "0 um", "6 um"]',
    'shape = "swarm", lower = ["-24 um", "0 um"], upper = ["24 um", "24 um"], height = "8 um", pitch = "16 um"',
)
SCENE = """
end_time = "8 ns"
impact = {{speed = "3 km/s"}}
grid = {{lower = ["-32 um", "0 um", "-24 um"], upper = ["32 um", "32 um", "32 um"], cell = "4 um"}}
boundary = {{z_lower = "{z_lower}"}}
body = [
  {{name = "target", shape = "block", lower = ["-32 um", "0 um", "{bottom} um"], upper = ["32 um", "32 um", "0 um"], spacing = "2 um", material = "al2024-liu2015"}},
  {ball},
]
"""


def scene_of(tmp_path, ball=BALL, bottom=-24, z_lower="transmitting"):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.format(ball=ball, bottom=bottom, z_lower=z_lower))
    return Scene.load(path)


def state(scene):
    """A snapshot at time 0."""
    pieces = list(make_points(scene))
    fields = {
        name: np.concatenate([getattr(piece, name) for piece in pieces])
        for name in ("position", "velocity", "mass", "volume", "body")
    }
    n = len(fields["mass"])
    return fields | {"deviator": np.zeros((n, 6)), "pressure": np.zeros(n), "time": np.zeros(1)}


def only(snapshot, kept):
    return {name: values[kept] if name != "time" else values for name, values in snapshot.items()}


def measured(snapshot, scene):
    """What `measure` prints, where a warning of NumPy's is a fault."""
    history = {name: np.array([0.0, np.nan]) for name in HISTORY_COLUMNS}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = measures(snapshot, setup_of(scene), LEDGER, RUN, {}, history)
        table = dict(finite(table | {"doubts": [], "resolution": resolution_of(scene)}))
    json.loads(to_json(table))
    Console(quiet=True).print(report(table))
    return table


def draw(snapshot, scene):
    """What `plot` draws, where a warning is a fault."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        filling = filling_of(snapshot, setup_of(scene))
        crater = crater_of(filling.surface()) if filling else None
        figure = slice_figure(snapshot, setup_of(scene), crater=crater, title="")
        figure.draw_without_rendering()
    return figure


def has_no_crater(table):
    told = {"time", "holes", "perforated"}
    return all(value is None for key, value in table["crater"].items() if key not in told)


@pytest.mark.parametrize("ball", [BALL, SWARM])
def test_what_is_gone_is_named(tmp_path, ball):
    scene = scene_of(tmp_path, ball)
    start = state(scene)
    is_target = start["body"] == 0
    nothing, none = np.zeros(len(is_target), dtype=bool), "there is no crater to measure"
    rim = is_target & (np.abs(start["position"][:, 0]) > 28e-6) & (start["position"][:, 2] > -2e-6)
    above = start | {"position": start["position"] + [0, 0, 30e-6]}
    for kept, of, expected in (
        (nothing, start, f"no point of the target is left in the grid: {none}"),
        (~is_target, start, f"no point of the target is left in the grid: {none}"),
        (is_target, above, f"no point of the target is left below z = 0: {none}"),
        (is_target, start, ""),
        (~nothing, start, ""),
        (rim, start, "cannot be told"),
        (np.arange(len(is_target)) == 7, start, "cannot be told"),
    ):
        table = measured(only(of, kept), scene)
        print(kept.sum(), table["warnings"])
        assert has_no_crater(table)
        assert table["crater"]["perforated"] is (None if expected else False)
        assert expected in table["warnings"][0]


@pytest.mark.parametrize("what", ["nothing", "nowhere", "no volume"])
def test_what_is_not_there_is_not_drawn(tmp_path, what):
    scene = scene_of(tmp_path)
    snapshot = state(scene)
    if what == "nothing":
        snapshot = only(snapshot, np.zeros(len(snapshot["mass"]), dtype=bool))
    else:
        snapshot["position" if what == "nowhere" else "volume"][:] *= np.nan
    panel = draw(snapshot, scene).axes[0]
    assert [text.get_text() for text in panel.texts] == ["no point is left in this plane"]


def test_a_history_without_a_depth_is_drawn():
    for values in ([0.0], [0.0, np.nan], [np.nan, np.nan]):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            history_figure({name: np.array(values) for name in HISTORY_COLUMNS}).draw_without_rendering()


@pytest.mark.parametrize("field", ["position", "velocity", "volume", "mass"])
def test_what_is_no_number_is_counted_and_not_measured(tmp_path, field):
    scene = scene_of(tmp_path)
    snapshot = state(scene)
    for value in (np.nan, np.inf):
        snapshot[field][[3, 5, -1]] = value
        table = measured(snapshot, scene)
        assert has_no_crater(table)
        assert table["warnings"][0].startswith(
            "3 points have a place, velocity, volume or mass that is no number"
        )
        assert table["ejecta"]["mass"] is None


@pytest.mark.parametrize("seed", range(24))
def test_any_part_of_any_state_is_measured(tmp_path, seed):
    """Points at random of a carved, strained, scattered block or plate, of a ball or a swarm."""
    rng = np.random.default_rng(seed)
    ball, bottom = (BALL, SWARM)[seed % 2], (-24, -8, -4, -2)[seed // 2 % 4]
    scene = scene_of(tmp_path, ball, bottom, z_lower=("transmitting", "free", "symmetry")[seed % 3])
    snapshot = state(scene)
    n = len(snapshot["mass"])
    x = snapshot["position"]
    snapshot["position"] = x + rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-8, -5)
    snapshot["velocity"] = rng.normal(size=(n, 3)) * 1e3
    snapshot["volume"] = snapshot["volume"] * rng.uniform(0.3, 3, n)
    kept = rng.random(n) < rng.choice([0.01, 0.2, 0.7, 1.0])
    kept &= np.hypot(x[:, 0], x[:, 1]) > rng.uniform(0, 40e-6)
    table = measured(only(snapshot, kept), scene)
    depth = table["crater"]["depth"]
    assert depth is None or 0 < depth < 30e-6
    assert not (table["crater"]["perforated"] and depth)


def test_a_run_from_which_everything_leaves_ends_well(tmp_path, capsys, monkeypatch):
    scene = tmp_path / "alone.toml"
    lines = scene_of(tmp_path).to_dict()
    lines["body"] = lines["body"][1:]
    lines["end_time"] = 4e-8
    lines["boundary"]["z_lower"] = "free"
    scene.write_text(Scene.from_dict(lines).to_toml())
    monkeypatch.setattr(
        "sys.argv",
        ["pockmark", "run", str(scene), "-o", str(tmp_path / "run"), "--threads", "1", "--quiet", "--coarse"],
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    printed = capsys.readouterr().out
    assert "no target" in printed
    assert "Traceback" not in printed
    folder = RunFolder.open(tmp_path / "run")
    assert len(folder.last_snapshot()["mass"]) == 0
    result = measure(folder.path)
    assert has_no_crater(result)
    assert result["crater"]["time"] == result["run"]["time"] == 4e-8  # not of when the last point left
    assert (folder.path / "crater.png").exists()
    assert (folder.path / "history.png").exists()
    plot_run(folder.path, tmp_path)


def test_a_target_off_the_plane_is_not_measured(tmp_path):
    table = scene_of(tmp_path).to_dict()
    table["body"][0]["upper"][2] = -8e-6
    scene = Scene.from_dict(table)
    result = measured(state(scene), scene)
    assert has_no_crater(result)
    assert "has its top at z = 0" in result["warnings"][0]
    assert "-8 um" in result["warnings"][0]


def test_a_foil_of_one_point_is_not_measured(tmp_path):
    scene = scene_of(tmp_path, bottom=-2, z_lower="free")
    snapshot = state(scene)
    snapshot["position"][snapshot["body"] == 0, 2] -= 3e-6
    result = measured(snapshot, scene)
    assert has_no_crater(result)
    assert result["crater"]["perforated"] is None
    assert "one point thick" in result["warnings"][0]


def test_the_change_of_the_last_tenth():
    time = np.linspace(0, 100e-9, 101)
    assert depth_change(time, np.minimum(time, 50e-9)) == 0
    assert depth_change(time, 1e2 * time) == pytest.approx(0.1)
    assert depth_change(time, 1 + 0.05 * (time == time[95])) == pytest.approx(0.05)  # it rings
    assert depth_change(time[:31], time[:31]) == pytest.approx(0.1)  # interrupted
    for depth in (time * np.nan, np.where(time == time[95], np.nan, time), np.zeros(101), -time):
        assert depth_change(time, depth) is None
    assert depth_change(time[:1], time[:1]) is depth_change(time[:0], time[:0]) is None
    assert depth_change(np.zeros(3), np.ones(3)) is None


@pytest.mark.parametrize("stopped", [False, True])
def test_a_crater_that_still_grows_says_so_at_the_top(tmp_path, stopped, monkeypatch):
    scene = scene_of(tmp_path)
    advance = Simulation.advance

    def interrupted(self, *args, **kwargs):
        if self.time > 5e-9:
            raise KeyboardInterrupt
        return advance(self, *args, **kwargs)

    if stopped:
        monkeypatch.setattr(Simulation, "advance", interrupted)
    run_scene(scene, tmp_path / "run", threads=1, progress=False, coarse=True)
    result = measure(tmp_path / "run")
    assert result["run"]["status"] == ("interrupted" if stopped else "finished")
    assert math.isfinite(change := result["crater"]["depth_change_last_tenth"])
    assert change > 0.02
    console = Console(width=300, file=io.StringIO())
    console.print(report(result))
    text = console.file.getvalue()
    print(text)
    assert f"still changes by {change:.1%} in the last tenth" in text
    assert text.index("still changes") < text.index("depth C_p")
    assert text.index("3 cells across the projectile, fewer than 10") < text.index("depth C_p")
    assert "of the measure on these points alone" in text
    assert "3 cells across the projectile" in text
