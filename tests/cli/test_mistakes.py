"""What a user's slip, a full disk or a torn file may do: one sentence, and nothing of the user's lost."""

import json
import resource
import signal

import numpy as np
import pytest
from processes import QUICK, short_run

from pockmark import PockmarkError, Scene, Simulation, measure
from pockmark.run.pipeline import run_scene
from pockmark.run.store import RunFolder, Snapshot
from pockmark.scene.forecast import forecast

ALUMINIUM = "materials.al2024-liu2015"

SLIPS = [
    ("grid.lower=[nan, 0.0, 0.0]", "grid.lower[0]: found nan, expected a finite number"),
    ("grid.upper=['inf m', '50 um', '30 um']", "grid.upper[0]: found 'inf m', expected a finite number"),
    ("grid.cell=1e-30", "grid: a cell of 1e-30 m makes"),
    ("end_time=inf", "end_time: found inf"),
    ("impact.speed=inf", "impact.speed: found inf"),
    ("title='\udcff'", "found '\\udcff' in a text, expected Unicode"),
    ("grid.cell=1e-99", "grid: a cell of 1e-99 m makes"),
    ("grid.cell=1e-300", "grid.cell: found 1e-300, nearer to 0 than any quantity: write 0"),
    (f"{ALUMINIUM}.viscosity.linear=6e-302", "viscosity.linear: found 6e-302, nearer to 0 than any quantity"),
    ("grid.upper=['50 um', '50 um', '1e9 um']", "grid: a cell of 5e-06 m makes"),
    (f"end_time={'9' * 400}", "end_time: found 9999"),
    (
        "body.1.spacing='1e-6 um'",
        "body[1] 'projectile': a spacing of 1e-12 m makes 4.19e+21 points, at most 4294967294 fit",
    ),
    ("body.0.spacing=1e-99", "body[0] 'target': a spacing of 1e-99 m makes"),
    ("body.1.spacing='30 um'", "body[1] 'projectile': a spacing of 3e-05 m leaves it without points"),
    (
        "body.0={name='t', shape='block', lower=['-50 um', '0 um', '-50 um'], upper=['50 um', '50 um', '0 um'], "
        "spacing='200 um', material='al2024-liu2015', rounded=true}",
        "body[0] 't': a spacing of 0.0002 m leaves it without points",
    ),
    (f"{ALUMINIUM}.density=1e-300", f"{ALUMINIUM}.density: found 1e-300, allowed is 10 to 30000 kg/m^3"),
    ("end_time='1000 s'", "steps with waves of"),
    (
        "output.history='1e-9 ns'",
        "output.history: found 1e-18 s, at least end_time/1e+06 = 6e-14 s is needed",
    ),
    ("output.snapshots=1e-99", "output.snapshots: found 1e-99 s"),
    ("contact.friction=11", "contact.friction: found 11, input should be less than or equal to 10"),
    ("contact.friction=-0.1", "contact.friction: found -0.1, input should be greater than or equal to 0"),
    ("contact=3", "contact: found 3, expected a table"),
    ("materials=3", "materials: found 3, expected a table"),
    (f"{ALUMINIUM}=3", f"{ALUMINIUM}: found 3, expected a table"),
    (f"{ALUMINIUM}.based_on=['a']", f"{ALUMINIUM}.based_on: found"),
    (f"{ALUMINIUM}.thermal.melt_temperature='200 K'", "t_melt must exceed t_room"),
    (f"{ALUMINIUM}.failure.triaxiality_min=5", "triaxiality_max must exceed triaxiality_min"),
]


@pytest.mark.parametrize(("override", "sentence"), SLIPS)
def test_a_slip_is_one_sentence(override, sentence):
    with pytest.raises(PockmarkError) as caught:
        Scene.load(QUICK, [override])
    message = str(caught.value)
    print(message)
    assert message.startswith(f"{QUICK}: ")
    assert sentence in message
    assert "\n" not in message


def test_bodies_are_not_too_many():
    table = Scene.load(QUICK).to_dict()
    table["body"] = [table["body"][0] | {"name": str(i)} for i in range(256)]
    with pytest.raises(PockmarkError, match="scene: body: found 256 bodies, at most 255 are allowed"):
        Scene.from_dict(table)


@pytest.mark.parametrize("threads", [-1, 100_000, 10**30])
def test_threads_are_bounded(threads):
    with pytest.raises(PockmarkError, match=f"threads: found {threads}, allowed are 1 to "):
        Simulation(Scene.load(QUICK), threads)


WITHOUT_OPTIONS = '{"scene_hash": "0", "run": {}, "options": {}, "ledger": {}, "counters": {}}'


def test_another_model_replaces_the_library_s():
    elastic = f"{ALUMINIUM}.strength={{model='elastic', shear_modulus='27 GPa'}}"
    scene = Scene.load(QUICK, [elastic, f"{ALUMINIUM}.failure.treatment=inactive"])
    assert scene.materials["al2024-liu2015"].strength.model == "elastic"


def test_check_tells_what_was_fitted_or_rounded():
    """A spacing that does not divide a size gets smaller, or, rounded, changes the mass."""
    scene = Scene.load(QUICK).to_dict()
    scene["body"][0]["spacing"] = 1.45e-6  # 50 um: 34.5 layers
    for rounded, sentence in (
        (False, "body[0] 'target': its points lie 1.429 um apart, not 1.45 um, so that a whole number fits"),
        (True, "body[0] 'target': rounded to whole spacings, it has 0.973 times the mass"),
    ):
        scene["body"][0]["rounded"] = rounded
        said = forecast(Scene.from_dict(scene), 1).warnings
        print(said)
        assert any(sentence in w for w in said)
    assert not any("target" in w for w in forecast(Scene.load(QUICK), 1).warnings if "apart" in w)


def test_force_spares_what_is_not_pockmarks(tmp_path):
    scene, folder = Scene.load(QUICK), tmp_path / "run"
    RunFolder.create(folder, scene).release()
    (folder / "notes.txt").write_text("mine")
    (folder / "snapshot-0000.vtkhdf").write_bytes(b"old")
    with pytest.raises(PockmarkError, match="--force"):
        RunFolder.create(folder, scene)
    RunFolder.create(folder, scene, force=True).release()
    assert sorted(p.name for p in folder.iterdir()) == ["manifest.json", "notes.txt", "scene.toml"]


def test_force_does_not_take_a_strangers_manifest_for_a_run(tmp_path):
    (tmp_path / "manifest.json").write_text('{"name": "my web page"}')
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(PockmarkError, match="holds no run"):
        RunFolder.create(tmp_path, Scene.load(QUICK), force=True)
    assert (tmp_path / "thesis.tex").read_text() == "mine"


@pytest.mark.parametrize(
    "manifest", ["", "[1]", "{}", '{"scene_hash": "0"}', WITHOUT_OPTIONS, WITHOUT_OPTIONS.replace("{}", "3")]
)
def test_a_torn_manifest_is_told(manifest, tmp_path):
    Scene.load(QUICK).save(tmp_path / "scene.toml")
    (tmp_path / "manifest.json").write_text(manifest)
    with pytest.raises(PockmarkError) as caught:
        measure(tmp_path)
    assert str(tmp_path) in str(caught.value)


def _finished(folder):
    (folder / "manifest.json").write_text('{"scene_hash": "0", "status": "finished"}')


@pytest.mark.parametrize("text", ["", "time,error\n", "time,error\n1,2\n3\n", "time,error\n1,x\n"])
def test_a_torn_history_is_told(text, tmp_path):
    _finished(tmp_path)
    (tmp_path / "history.csv").write_text(text)
    with pytest.raises(PockmarkError, match=r"history\.csv: is empty or torn"):
        RunFolder(tmp_path).history()


def test_a_history_without_a_column_is_told(tmp_path):
    _finished(tmp_path)
    (tmp_path / "history.csv").write_text("time,depth\n1,2\n")
    with pytest.raises(PockmarkError, match=r"history\.csv: lacks the column error"):
        RunFolder(tmp_path).history("time", "error")


def test_a_strangers_hdf5_file_is_told(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["a"] = 1
    with pytest.raises(PockmarkError, match="is not a snapshot"):
        Snapshot(tmp_path / "other.h5")


def _small_files():
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))


def test_a_full_disk_is_one_sentence_and_leaves_no_half_file(tmp_path):
    run = short_run(tmp_path / "run", "--set", "end_time='1 ns'", preexec_fn=_small_files)
    _, said = run.communicate(timeout=60)
    print(said)
    assert run.returncode == 2
    assert len(said.strip().splitlines()) == 1
    assert "snapshot-0000.vtkhdf: cannot be written (File too large)" in said
    assert sorted(p.name for p in (tmp_path / "run").iterdir()) == [
        "history.csv",
        "manifest.json",
        "scene.toml",
    ]
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["status"] == "failed"


def test_measure_tells_the_largest_ledger_error(tmp_path):
    folder, _ = run_scene(Scene.load(QUICK, ["end_time='4 ns'"]), tmp_path / "run", threads=1, progress=False)
    history, energy = folder.history(), measure(folder.path)["energy"]
    assert energy["ledger_error_max"] == np.abs(history["error"]).max() / history["initial"][0]
    assert energy["ledger_error_max"] >= abs(energy["ledger_error"]) * (1 - 1e-9)


def test_contact_needs_two_sides():
    with pytest.raises(PockmarkError, match="contact: needs a body with projectile = true and one without"):
        Scene.load(QUICK, ["contact.friction=0.3", "body.projectile.projectile=false"])
