"""From a scene to a measured run folder, through Python and the command line."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene, Simulation, measure
from pockmark.run.bench import bench_scene
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import resume_run, run_scene
from pockmark.run.setup import setup_of
from pockmark.run.simulation import LiveFields
from pockmark.run.snapshot import write_snapshot
from pockmark.run.store import RunFolder, Snapshot
from pockmark.scene.forecast import BYTES_PER_POINT_KEPT, forecast

EXAMPLES = Path(__file__).parents[2] / "examples"
QUICK = EXAMPLES / "quick.toml"


def pockmark(*arguments, **kwargs):
    return subprocess.run(
        [sys.executable, "-m", "pockmark", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        **kwargs,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One finished quick run, made by the command line."""
    path = tmp_path_factory.mktemp("runs") / "quick"
    done = pockmark("run", QUICK, "-o", path, "--threads", 1)
    print(done.stdout)
    assert done.returncode == 0, done.stderr
    return path


def test_the_run_folder_is_complete(folder):
    names = {p.name for p in folder.iterdir()}
    assert {"scene.toml", "manifest.json", "history.csv", "crater.png", "history.png"} <= names
    assert len(RunFolder.open(folder).snapshots()) == 4
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["status"] == "finished"
    assert manifest["scene_hash"] == Scene.load(QUICK).hash
    assert manifest["machine"]["processor"]


def test_measure_has_stable_keys_in_si(folder):
    done = pockmark("measure", folder, "--json")
    result = json.loads(done.stdout)
    print(done.stdout)
    assert 5e-6 < result["crater"]["depth"] < 25e-6
    assert 10e-6 < result["crater"]["diameter"] < 60e-6
    assert result["crater"]["volume"] > 0
    assert 0.7 < result["energy"]["residual_internal"] < 1.0
    assert abs(result["energy"]["ledger_error"]) < 1e-10  # USAVG: round-off
    for key in ("points", "cells", "steps", "particle_steps_per_second"):
        assert result["run"][key] > 0
    assert result["run"]["failure_treatment"] == "al2024-liu2015: no_damage"
    assert measure(folder) == result


def test_a_quarter_model_gives_the_half_model_s_crater(folder, tmp_path):
    half, table = measure(folder), Scene.load(QUICK).to_dict()
    table["grid"]["lower"][0] = table["body"][0]["lower"][0] = 0.0
    table["boundary"]["x_lower"] = "symmetry"
    run_scene(Scene.from_dict(table), tmp_path / "quarter", threads=1, progress=False)
    quarter = measure(tmp_path / "quarter")
    # Equally deep columns left and right of x = 0: which is taken moves the fitted bottom by 0.6 %.
    for key, close in (("depth", 0.01), ("diameter", 1e-3), ("volume", 1e-3)):
        print(key, half["crater"][key], quarter["crater"][key])
        assert quarter["crater"][key] == pytest.approx(half["crater"][key], rel=close)
    assert quarter["energy"]["residual_internal"] == pytest.approx(
        half["energy"]["residual_internal"], rel=1e-4
    )


def test_history_closes_its_ledger(folder):
    history = RunFolder.open(folder).history()
    total = sum(
        history[k]
        for k in ("kinetic", "internal", "absorbed", "left_kinetic", "left_internal", "pic", "contact")
    )
    assert np.allclose(total - history["initial"], history["error"], atol=1e-9 * history["initial"][0])
    assert np.all(np.diff(history["time"]) > 0)
    assert history["time"][-1] == Scene.load(QUICK).end_time


def test_vtk_reads_a_snapshot(folder):
    vtk_io = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    path = RunFolder.open(folder).snapshots()[-1]
    reader = vtk_io.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid, ours = reader.GetOutput(), Snapshot(path)
    assert grid.GetNumberOfPoints() == grid.GetNumberOfCells() == len(ours["mass"])
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), ours["position"])
    for name in ("pressure", "deviator", "effective_stress", "body", "damage"):
        assert np.array_equal(vtk_to_numpy(grid.GetPointData().GetArray(name)), ours[name])


def test_check_tells_the_size_before_anything_runs():
    done = pockmark("check", EXAMPLES / "normal-2200.toml")
    print(done.stdout)
    assert done.returncode == 0
    assert "252,112" in done.stdout
    assert "47,500" in done.stdout
    assert "1.3467" in done.stdout  # the triaxiality above which the paper's failure strain is <= 0


# Prints the peak of a command, bytes. From a small process: what starts a command counts as a part of it.
PEAK = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_snapshot_in_which_everything_moves_is_as_large_as_forecast(precision, tmp_path):
    simulation = Simulation(bench_scene(60_000, (f"numerics.precision={precision}",)), 1)
    simulation.advance(1.0, max_steps=200)
    write_snapshot(tmp_path / "x", LiveFields(simulation), 0.0, 200, "0" * 16)
    per_point = (tmp_path / "x").stat().st_size / simulation.points
    print(f"{per_point:.1f} bytes a point")
    assert per_point == pytest.approx(BYTES_PER_POINT_KEPT[precision], rel=0.1)


@pytest.mark.parametrize(("points", "precision"), [(60_000, "double"), (250_000, "single")])
def test_the_memory_and_the_disk_are_as_forecast(points, precision, tmp_path):
    """Of the whole command: running, measuring, drawing. Millions of points: benchmarks/README.md."""
    short = ("end_time='1 ns'", "output.snapshots='0.3 ns'", f"numerics.precision={precision}")
    scene = bench_scene(points, short)
    scene.save(tmp_path / "scene.toml")
    words = ["run", tmp_path / "scene.toml", "-o", tmp_path / "run", "--quiet", "--coarse", "--threads", "1"]
    command = [sys.executable, "-c", PEAK, sys.executable, "-m", "pockmark", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    peak = int(done.stdout.split()[-1])
    disk = sum(file.stat().st_size for file in (tmp_path / "run").iterdir())
    expected = forecast(scene, 1)
    print(f"peak {peak / 2**20:.0f} MiB, forecast {expected.memory / 2**20:.0f} MiB; disk {disk}")
    assert expected.memory == pytest.approx(peak, rel=0.15)
    assert disk < expected.disk  # most of it is at rest yet


def test_forecast_warns():
    scene = Scene.load(QUICK, ["grid.cell='2.5 um'"])
    text = " ".join(forecast(scene, 1).warnings)
    assert "1 points a cell" in text
    coarse = Scene.load(EXAMPLES / "group-4500.toml").to_dict()
    coarse["body"][1]["spacing"] = 6e-6
    assert any("fewer than 4 points" in w for w in forecast(Scene.from_dict(coarse), 1).warnings)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ([], None),
        (["impact.speed=0"], "impact.speed is 0: nothing moves"),
        (["body.1.projectile=false"], "no body is marked projectile = true"),
        (["body.0.upper=['50 um', '50 um', '-5 um']"], "no target's top lies at z = 0"),
        (
            ["body.0.projectile=true"],
            "no target's top lies at z = 0, where the crater is measured from (found no target)",
        ),
        (["grid.lower=['-50 um', '0 um', '-35 um']"], "35 um from the face z_lower"),
        (["grid.lower=['-45 um', '0 um', '-50 um']"], "35 um from the face x_lower"),
    ],
)
def test_check_warns_of_a_scene_that_measures_something_else(changes, sentence):
    table = Scene.load(QUICK, [f"grid.lower={[-50e-6, 0.0, -50e-6]}"]).to_dict()
    table["body"][0]["lower"] = [-45e-6, 0.0, -35e-6]
    said = forecast(Scene.from_dict(table, overrides=changes), 1).warnings
    print(said)
    assert (
        any(sentence in w for w in said) if sentence else not any("face" in w or "moves" in w for w in said)
    )


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run", "nowhere.toml"], "nowhere.toml: cannot be read"),
        (["run", QUICK, "--set", "grid.cell='1 kg'"], "grid.cell: found '1 kg', expected a quantity in m"),
        (["run", QUICK, "--threads", "-2"], "threads: found -2, allowed are 1 to"),
        (["run", QUICK, "-o", "{taken}"], "is not empty and holds no run"),
        (["measure", "{taken}"], "is not a run folder"),
        (["plot", "{taken}"], "is not a run folder"),
        (["check", QUICK, "--set", "body.0=1"], "body"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(arguments, sentence, tmp_path):
    taken = tmp_path / "taken"
    taken.mkdir()
    (taken / "mine.txt").write_text("mine")
    done = pockmark(*(str(a).format(taken=taken) for a in arguments), cwd=tmp_path)
    print(done.stderr)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["taken"]
    assert (taken / "mine.txt").read_text() == "mine"


def test_a_run_is_not_overwritten_unasked(folder):
    scene = Scene.load(QUICK)
    with pytest.raises(PockmarkError, match="--force"):
        run_scene(scene, folder, progress=False)


def test_an_interrupted_run_keeps_what_there_is(tmp_path, monkeypatch):
    calls = iter(range(1000))
    original = Simulation.advance

    def advance(self, *args, **kwargs):
        if next(calls) == 3:
            raise KeyboardInterrupt
        return original(self, *args, **kwargs)

    monkeypatch.setattr(Simulation, "advance", advance)
    folder, finished = run_scene(Scene.load(QUICK), tmp_path / "cut", threads=1, progress=False)
    assert not finished
    assert folder.manifest()["status"] == "interrupted"
    result = measure(folder.path)
    assert 0 < result["run"]["time"] < 60e-9
    assert len(folder.snapshots()) == 2


def test_python_and_toml_give_the_identical_run(tmp_path):
    scene = Scene.load(QUICK, ["end_time='5 ns'"])
    scene.save(tmp_path / "again.toml")
    runs = []
    for s in (scene, Scene.load(tmp_path / "again.toml")):
        simulation = Simulation(s, threads=1)
        simulation.run()
        runs.append(simulation.snapshot())
    assert all(np.array_equal(runs[0][k], runs[1][k]) for k in runs[0])


def test_a_collapsed_step_ends_the_run_and_says_so(tmp_path):
    """USL takes its strain from nodes that hold slivers of mass: its step falls without end."""
    scene = Scene.load(EXAMPLES / "group-4500.toml", ["numerics.scheme=usl", "end_time='1 ns'"])
    with pytest.raises(PockmarkError, match="time step fell to a thousandth of the first one"):
        run_scene(scene, tmp_path / "usl", progress=False)
    folder = RunFolder.open(tmp_path / "usl")
    assert folder.manifest()["status"] == "failed"
    assert len(folder.history()["time"]) > 0


def test_the_progress_bar_changes_nothing(tmp_path):
    scene = Scene.load(QUICK)
    for progress in (False, True):
        run_scene(scene, tmp_path / str(progress), threads=1, progress=progress)
    quiet, shown = (RunFolder.open(tmp_path / str(p)).path / "history.csv" for p in (False, True))
    assert quiet.read_bytes() == shown.read_bytes()


def test_a_denser_history_moves_no_step(tmp_path):
    rows = {}
    for interval in ("1 ns", "7 ns"):
        scene = Scene.load(
            QUICK, [f"output.history={interval!r}", "end_time='20 ns'", "output.snapshots='20 ns'"]
        )
        folder, _ = run_scene(scene, tmp_path / interval, threads=1, progress=False)
        history = folder.history()
        # A row belongs to the last multiple of the interval (or the end) that its step reached.
        due = np.append(np.arange(0, 19.99e-9, scene.output.history), 20e-9)
        of = np.searchsorted(due, history["time"] * (1 + 1e-12), side="right") - 1
        assert np.array_equal(of, range(len(due)))
        rows[interval] = dict(zip(history["step"], history["error"], strict=True))
    common = rows["1 ns"].keys() & rows["7 ns"].keys()
    assert len(common) >= 3
    assert all(rows["1 ns"][step] == rows["7 ns"][step] for step in common)


def test_snapshots_are_exactly_on_time(tmp_path):
    scene = Scene.load(QUICK, ["end_time='20 ns'", "output.snapshots='6 ns'"])
    folder, _ = run_scene(scene, tmp_path / "run", threads=1, progress=False)
    times = [float(Snapshot(path)["time"][0]) for path in folder.snapshots()]
    assert times == [0.0, *(n * scene.output.snapshots for n in (1, 2, 3)), scene.end_time]


def test_an_axisymmetric_run_is_measured_drawn_and_resumed(tmp_path):
    scene = Scene.load(QUICK, ["grid.geometry=axisymmetric"])
    folder, finished = run_scene(scene, tmp_path / "rings", threads=1, progress=False)
    assert finished
    result = measure(tmp_path / "rings")
    crater, ejecta, run = result["crater"], result["ejecta"], result["run"]
    assert crater["major_axis"] == crater["minor_axis"] == crater["diameter"]
    assert (crater["bottom_x"], crater["e1"], crater["e2"], crater["uncertainty"]["e2"]) == (0, 0, 0, 0)
    assert crater["depth"] == pytest.approx(15e-6, rel=0.1)
    assert ejecta["left_momentum"][:2] == [0, 0]
    assert run["points"] == forecast(scene, 1).points
    mass = folder.history("mass")["mass"]  # of the whole impact, mirror images or not
    assert mass[0] == pytest.approx(2770 * np.pi * (50e-6) ** 3 + setup_of(scene).projectile_mass)
    plot_run(tmp_path / "rings", tmp_path)
    assert (tmp_path / "crater.png").exists()
    resume_run(tmp_path / "rings", end_time=80e-9, threads=1, progress=False)
    at_once, _ = run_scene(
        Scene.load(QUICK, ["grid.geometry=axisymmetric", "end_time='80 ns'"]),
        tmp_path / "80",
        threads=1,
        progress=False,
    )
    last = [one.last_snapshot() for one in (folder, at_once)]
    assert np.array_equal(*(snapshot["position"] for snapshot in last))
