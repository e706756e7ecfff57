"""A run that goes on from a checkpoint is, to the last bit, the run that never stopped."""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from kills import differences, trial, whole

from pockmark import PockmarkError, Scene, _core, resume_run, run_scene
from pockmark.run import checkpoint as format_of
from pockmark.run import keeper, pipeline
from pockmark.run.checkpoint import read_checkpoint, write_checkpoint
from pockmark.run.keeper import checkpoints
from pockmark.run.simulation import Simulation
from pockmark.run.store import RunFolder

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
SMALL = ("grid.cell='10 um'", "body.target.spacing='5 um'", "body.projectile.spacing='2.5 um'")
SHORT = (*SMALL, "end_time='40 ns'", "output.snapshots='10 ns'", "output.checkpoints='1 us'")
VARIANTS = {
    "double": (),
    "single": ("numerics.precision='single'",),
    "quadratic": ("numerics.shape_functions='quadratic'",),
    "contact": ("contact.friction=0.2",),
    "leaving": ("impact.speed='12 km/s'", "grid.upper=['50 um', '50 um', '25 um']"),
}


def scene_of(*changes):
    """The quick scene, small and short, with changes."""
    return Scene.load(QUICK, [*SHORT, *changes])


def run(folder, scene, **how):
    """Run a scene quietly."""
    return run_scene(scene, folder, threads=1, progress=False, coarse=True, **how)


def resume(folder, **how):
    """Go on quietly."""
    return resume_run(folder, progress=False, **{"threads": 1, **how})


class StopAt:
    """Raises an error, or presses Ctrl-C, when a run reaches a time."""

    def __init__(self, monkeypatch, moment, error=KeyboardInterrupt):
        """Watch every run from now on."""
        watch = keeper.Keeper.watch

        def watch_and_stop(kept, simulation):
            watch(kept, simulation)
            if simulation.time >= moment:
                raise error

        self.patch = monkeypatch
        monkeypatch.setattr(keeper.Keeper, "watch", watch_and_stop)

    def over(self):
        """Stop no more."""
        self.patch.undo()


@pytest.fixture(scope="module")
def wholes(tmp_path_factory):
    """Runs that nobody stopped, by their variant."""
    made = {}

    def of(variant):
        if variant not in made:
            made[variant] = tmp_path_factory.mktemp("whole") / "run"
            run(made[variant], scene_of(*VARIANTS[variant]))
        return made[variant]

    return of


@pytest.fixture
def stopped(tmp_path, monkeypatch):
    """A run that was stopped at 25 ns, with its last two checkpoints."""
    stop = StopAt(monkeypatch, 25e-9)
    run(tmp_path / "run", scene_of())
    stop.over()
    return tmp_path / "run"


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_stopped_run_goes_on_to_the_last_bit(variant, wholes, tmp_path, monkeypatch):
    folder, rng = tmp_path / "run", random.Random(variant)
    moments = sorted(rng.uniform(1e-9, 39e-9) for _ in range(3))
    stop = StopAt(monkeypatch, moments[0])
    assert not run(folder, scene_of(*VARIANTS[variant]))[1]
    stop.over()
    for n, moment in enumerate(moments[1:]):
        assert RunFolder(folder).manifest()["status"] == "interrupted"
        stop = StopAt(monkeypatch, moment)
        assert not resume(folder, threads=1 + n).is_finished
        stop.over()
    resumed = resume(folder, threads=2)
    assert resumed.is_finished
    assert resumed.told == []
    assert differences(wholes(variant), folder) == []
    known = RunFolder(folder).manifest()
    assert [round(place["time"], 12) for place in known["resumed"]] == sorted(
        round(place["time"], 12) for place in known["resumed"]
    )
    assert len(known["resumed"]) == 3
    assert len(checkpoints(folder)) == 1


def test_a_run_goes_on_past_its_end_as_one_that_ended_later(tmp_path, wholes):
    folder = tmp_path / "run"
    run(folder, scene_of("end_time='20 ns'"))
    assert resume(folder, end_time=40e-9).is_finished
    assert differences(wholes("double"), folder) == []
    assert RunFolder(folder).scene().end_time == 40e-9
    assert RunFolder(folder).manifest()["scene_hash"] == scene_of().hash


def test_a_run_that_goes_on_past_its_end_can_be_stopped_and_go_on(tmp_path, wholes, monkeypatch):
    folder = tmp_path / "run"
    run(folder, scene_of("end_time='20 ns'"))
    stop = StopAt(monkeypatch, 31e-9)
    assert not resume(folder, end_time=40e-9).is_finished
    stop.over()
    assert resume(folder).is_finished
    assert differences(wholes("double"), folder) == []


@pytest.mark.parametrize("moment", ["manifest", "scene", "history"])
def test_killed_while_it_goes_back_a_run_goes_on(moment, tmp_path, wholes, monkeypatch):
    """The process ends between two writes; what it would still have done is not done."""
    folder = tmp_path / "run"
    run(folder, scene_of("end_time='20 ns'"))

    def gone(*_, **__):
        raise SystemExit

    match moment:
        case "manifest":
            monkeypatch.setattr(RunFolder, "change_end", gone)
        case "scene":
            monkeypatch.setattr(pipeline, "cut_back", gone)
        case "history":
            monkeypatch.setattr(pipeline, "_run_into", gone)
    with pytest.raises(SystemExit):
        resume(folder, end_time=40e-9)
    monkeypatch.undo()
    # Of a process that is gone, the lock is gone too.
    (folder / "run.lock").unlink(missing_ok=True)
    assert resume(folder, end_time=40e-9).is_finished
    assert differences(wholes("double"), folder) == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_leaves_a_checkpoint(number, tmp_path):
    """Although the clock would not have asked for one."""
    folder = tmp_path / "run"
    code = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from pockmark import Scene, run_scene
from pockmark.run import keeper
watch = keeper.Keeper.watch
def watch_and_signal(kept, simulation):
    watch(kept, simulation)
    if simulation.time > 15e-9:
        os.kill(os.getpid(), int(sys.argv[3]))
keeper.Keeper.watch = watch_and_signal
run_scene(Scene.load(sys.argv[1], sys.argv[4:]), sys.argv[2], threads=1, progress=False, coarse=True)
"""
    changes = [*SHORT, "output.checkpoints='1 h'"]
    subprocess.run([sys.executable, "-c", code, QUICK, folder, str(int(number)), *changes], check=True)
    assert RunFolder(folder).manifest()["status"] == "interrupted"
    (kept,) = checkpoints(folder)
    assert read_checkpoint(kept).time == RunFolder(folder).manifest()["run"]["time"]


@pytest.mark.parametrize("fault", ["torn", "altered", "empty", "pipe", "link"])
def test_a_damaged_checkpoint_is_told_and_the_one_before_is_used(fault, stopped, wholes):
    before, newest = checkpoints(stopped)
    content = newest.read_bytes()
    newest.unlink()
    match fault:
        case "torn":
            newest.write_bytes(content[: len(content) // 2])
        case "altered":
            middle = len(content) // 2
            newest.write_bytes(content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :])
        case "empty":
            newest.touch()
        case "pipe":
            os.mkfifo(newest)
        case "link":
            newest.symlink_to(before)
    step = read_checkpoint(before).step
    resumed = resume(stopped)
    (told,) = resumed.told
    print(told)
    assert told.startswith(f"{newest}: ")
    assert resumed.begun.step == step
    assert resumed.is_finished
    assert differences(wholes("double"), stopped) == []


def test_every_byte_of_a_checkpoint_counts(stopped):
    """Or is padding: what is read is what was written, whichever byte was altered."""
    newest = checkpoints(stopped)[-1]
    content, good = newest.read_bytes(), dict(read_checkpoint(newest).parts)
    rng, told = random.Random(1), 0
    for _ in range(60):
        place = rng.randrange(len(content))
        newest.write_bytes(content[:place] + bytes([content[place] ^ 16]) + content[place + 1 :])
        try:
            read = dict(read_checkpoint(newest).parts)
        except PockmarkError:
            told += 1
            continue
        assert read.keys() == good.keys()
        assert all(np.array_equal(read[name], good[name]) for name in good), place
    print(f"{told} of 60 told")
    assert told > 40


def refusal(folder, **how):
    """The sentence that a resume is refused with; the folder is as it was before."""
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(PockmarkError) as caught:
        resume(folder, **how)
    print(caught.value)
    assert "\n" not in str(caught.value)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    return str(caught.value)


def test_all_damaged_is_refused_and_nothing_is_lost(stopped):
    for path in checkpoints(stopped):
        path.write_bytes(path.read_bytes()[:1000])
    sentence = refusal(stopped)
    assert "has no checkpoint to go on from" in sentence
    assert str(checkpoints(stopped)[-1]) in sentence


def test_an_unknown_format_is_refused_by_name(stopped):
    newest = checkpoints(stopped)[-1]
    with h5py.File(newest, "r+") as file:
        file.attrs["format"] = 99
    assert refusal(stopped).endswith(f"{newest}: is a checkpoint of format 99, this pockmark reads format 1")


def test_another_physics_is_refused_by_name(stopped, monkeypatch):
    monkeypatch.setattr(format_of, "PHYSICS", 1000)
    assert "this pockmark has 1000" in refusal(stopped)


def test_a_checkpoint_of_another_scene_is_refused(stopped, tmp_path, monkeypatch):
    stop = StopAt(monkeypatch, 5e-9)
    other, _ = run(tmp_path / "other", scene_of("impact.speed='3 km/s'"))
    stop.over()
    shutil.copy(checkpoints(other.path)[-1], checkpoints(stopped)[-1])
    assert "is a checkpoint of another scene than this run's" in refusal(stopped)


def test_a_history_that_has_lost_rows_is_refused(stopped):
    history = stopped / "history.csv"
    history.write_bytes(history.read_bytes()[:500])
    with pytest.raises(PockmarkError, match=r"history\.csv: has lost what was there at the checkpoint"):
        resume(stopped)


@pytest.mark.parametrize("change", ["lost", "edited", "ends of lines"])
def test_a_refused_resume_changes_nothing(change, wholes, tmp_path):
    """Also not the standing of a run that has finished, past whose end one would go on."""
    folder = Path(shutil.copytree(wholes("double"), tmp_path / "run"))
    history = folder / "history.csv"
    match change:
        case "lost":
            history.unlink()
        case "edited":
            history.write_bytes(history.read_bytes().replace(b"\r\n0", b"\r\n00", 1))
        case "ends of lines":
            history.write_bytes(history.read_bytes().replace(b"\r\n", b"\n") + b" " * 10_000)
    assert str(history) in refusal(folder, end_time=60e-9)


def test_torn_checkpoints_of_a_killed_run_are_refused(stopped):
    """It was not killed before its first checkpoint: to begin anew would take its snapshots."""
    (stopped / "manifest.json").write_text(
        (stopped / "manifest.json").read_text().replace('"interrupted"', '"running"')
    )
    for path in checkpoints(stopped):
        path.write_bytes(path.read_bytes()[:1000])
    assert "has no checkpoint to go on from" in refusal(stopped)


def test_a_run_killed_before_its_first_checkpoint_begins_anew(stopped, wholes):
    (stopped / "manifest.json").write_text(
        (stopped / "manifest.json").read_text().replace('"interrupted"', '"running"')
    )
    for path in checkpoints(stopped):
        path.unlink()
    resumed = resume(stopped)
    assert resumed.begun is None
    assert resumed.is_finished
    assert differences(wholes("double"), stopped) == []


@pytest.mark.parametrize("number", ["0000", "9999", "that of the next", "that of the newest"])
def test_a_folder_named_as_a_checkpoint_is_none(number, stopped, wholes):
    newest = checkpoints(stopped)[-1]
    match number:
        case "that of the next":
            number = f"{int(newest.stem[-4:]) + 1:04d}"
        case "that of the newest":
            newest.unlink()
            number = newest.stem[-4:]
    (stopped / f"checkpoint-{number}.h5").mkdir()
    assert resume(stopped).is_finished
    assert differences(wholes("double"), stopped) == []


def test_a_lost_snapshot_is_told(stopped):
    (stopped / "snapshot-0000.vtkhdf").unlink()
    (told,) = resume(stopped).told
    assert told == f"{stopped}: has lost snapshot 0, which no resume brings back"


def test_another_core_is_told(stopped, monkeypatch):
    monkeypatch.setattr(pipeline, "core_name", lambda: "another, cpu driver")
    (told,) = resume(stopped).told
    print(told)
    assert "goes on by another, cpu driver: the last digits may differ" in told


@pytest.mark.skipif(_core.DRIVER == "plain", reason="is about another driver")
def test_a_run_of_the_plain_driver_goes_on_with_it_alone(tmp_path):
    """Its checkpoints have no order of the points, which the other one needs."""
    changes = [word for change in (*SHORT, "end_time='2 ns'") for word in ("--set", change)]
    command = [sys.executable, "-m", "pockmark", "run", QUICK, "-o", tmp_path / "run", "--coarse", "--quiet"]
    plain = os.environ | {"POCKMARK_DRIVER": "plain"}
    subprocess.run([*command, *changes], check=False, capture_output=True, env=plain)
    assert refusal(tmp_path / "run", end_time=4e-9).endswith("it goes on with POCKMARK_DRIVER=plain")


@pytest.mark.parametrize(
    ("interval", "first", "last"),
    [(20, 60, 80), (25, 325, 350), (5, 60, 85), (100, 1300, 1700), (10, 30, 40)],
)
def test_a_multiple_of_the_interval_is_the_end_itself(interval, first, last, tmp_path):
    """3 x 2e-8 is not 6e-8: there was a step of 1e-23 s, and a resumed run had it where the other had not."""
    tiny = (
        "impact.speed='10 m/s'",
        f"output.snapshots='{interval} ns'",
        "output.history='100 ns'",
        "grid.cell='20 um'",
        "grid.lower=['-60 um', '0 um', '-60 um']",
        "grid.upper=['60 um', '60 um', '40 um']",
        "body.target.lower=['-60 um', '0 um', '-60 um']",
        "body.target.upper=['60 um', '60 um', '0 um']",
        "body.target.spacing='10 um'",
        "body.projectile.spacing='5 um'",
    )
    for name, end in (("resumed", first), ("whole", last)):
        run(tmp_path / name, scene_of(*tiny, f"end_time='{end} ns'"))
        assert len(RunFolder(tmp_path / name).snapshots()) == end // interval + 1
    assert resume(tmp_path / "resumed", end_time=last * 1e-9).is_finished
    assert differences(tmp_path / "whole", tmp_path / "resumed") == []


@pytest.mark.parametrize(
    ("name", "value"),
    [("end_time", "120 ns"), ("end_time", None.__class__), ("threads", 1.5), ("threads", "2")],
)
def test_values_of_another_type_are_told(name, value, stopped):
    assert name in refusal(stopped, **{name: value})


def test_what_is_over_is_not_gone_on_with(wholes, tmp_path):
    folder = Path(shutil.copytree(wholes("double"), tmp_path / "run"))
    assert refusal(folder).endswith("has finished; --end-time goes on past its end")
    for end_time in (39e-9, -1.0, float("nan"), 0.0):
        assert "a later one is needed" in refusal(folder, end_time=end_time)
    assert "end_time" in refusal(folder, end_time=float("inf"))


def test_without_checkpoints_a_stopped_run_is_kept_as_it_is(tmp_path, monkeypatch):
    stop = StopAt(monkeypatch, 5e-9)
    folder, _ = run(tmp_path / "run", scene_of("output.checkpoints=0"))
    stop.over()
    assert checkpoints(folder.path) == []
    assert refusal(folder.path).endswith("has no checkpoint to go on from (output.checkpoints was 0)")


def test_checkpoints_change_neither_hash_nor_run(wholes, tmp_path):
    scene = scene_of("output.checkpoints=0")
    assert scene.hash == scene_of().hash
    run(tmp_path / "run", scene)
    assert differences(wholes("double"), tmp_path / "run") == []


def test_a_full_disk_stops_the_run_in_one_sentence_with_the_checkpoint_before_whole(
    tmp_path, monkeypatch, wholes
):
    """A limit of a file's size stands for the disk: in the midst of a checkpoint no byte more is taken."""
    folder, writes = tmp_path / "run", []
    write = keeper.write_checkpoint

    def fails_the_third_time(path, checkpoint):
        writes.append(path)
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        if len(writes) == 3:
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, hard))
        try:
            write(path, checkpoint)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    monkeypatch.setattr(keeper, "write_checkpoint", fails_the_third_time)
    with pytest.raises(PockmarkError) as caught:
        run(folder, scene_of())
    monkeypatch.undo()
    print(caught.value)
    assert str(caught.value) == f"{writes[2]}: cannot be written (File too large)"
    assert RunFolder(folder).manifest()["status"] == "failed"
    assert not list(folder.glob("*.part"))
    assert checkpoints(folder) == writes[:2]
    assert resume(folder).is_finished
    assert differences(wholes("double"), folder) == []


def test_the_parts_of_a_checkpoint_are_read_one_by_one(stopped):
    """All at once would double the memory that a run needs to go on."""
    found = read_checkpoint(checkpoints(stopped)[-1])
    assert not any(isinstance(value, np.ndarray) for value in vars(found.parts).values())
    given = Simulation(RunFolder(stopped).scene(), 1, parts=found.parts)
    assert given.steps == found.step


def test_a_part_that_vanishes_is_told(stopped, tmp_path):
    found = read_checkpoint(checkpoints(stopped)[-1])
    checkpoints(stopped)[-1].write_bytes(b"")
    with pytest.raises(PockmarkError, match="is no whole checkpoint"):
        Simulation(RunFolder(stopped).scene(), 1, parts=found.parts)


def test_what_was_killed_while_it_wrote_leaves_no_half_file_for_long(stopped):
    part = stopped / "checkpoint-0009.h5.1.part"
    part.write_bytes(b"half")
    assert resume(stopped).is_finished
    assert not part.exists()


def test_a_scene_s_checkpoints_must_be_a_time():
    for value in ("-1", "'5 um'", "'often'", "inf"):
        with pytest.raises(PockmarkError, match=r"output\.checkpoints"):
            Scene.load(QUICK, [f"output.checkpoints={value}"])


def test_runs_killed_without_warning_go_on_to_the_same_crater(tmp_path):
    """Four of the kills of tests/run/kills.csv, the writes of checkpoints among them."""
    rng = random.Random(2)
    seconds = whole(tmp_path / "whole", "contact")
    rows = []
    for n in range(12):
        if row := trial(tmp_path / "whole", seconds, tmp_path / f"run-{n}", "contact", rng):
            rows.append(row)
        if sum(row["kills"] for row in rows) >= 4:
            break
    print(json.dumps(rows, indent=1))
    assert {row["differences"] for row in rows} == {"none"}
    assert sum(row["kills"] for row in rows) >= 4


def test_a_checkpoint_is_written_beside_and_renamed(stopped, tmp_path):
    found = read_checkpoint(checkpoints(stopped)[-1])
    place = tmp_path / "checkpoint-0001.h5"
    place.write_bytes(b"old")
    write_checkpoint(place, found)
    again = read_checkpoint(place)
    assert (again.step, again.time, again.files) == (found.step, found.time, found.files)
    assert all(np.array_equal(again.parts[name], found.parts[name]) for name in found.parts)
