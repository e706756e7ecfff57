"""What is done with each kind of case, and judged: a case is its kind and its seed."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

from damage import OUTSIDE, damage
from hostile import hostile_campaign, hostile_scene
from impacts import impact
from judge import Verdict, absurd, answer, command, faults_of_command, faults_of_forecast
from physics import impossible_history, impossible_points, impossible_result

from pockmark import Scene
from pockmark.base.json import to_json
from pockmark.run.measured import measure_run
from pockmark.run.pictures import plot_run
from pockmark.run.pipeline import run_scene
from pockmark.run.snapshot import Snapshot
from pockmark.run.store import RunFolder
from pockmark.scene.forecast import forecast
from pockmark.study import campaign
from pockmark.view.report import report

COMMANDS = 3  # one case in so many goes through the command line too
PICTURES = 2  # one in so many is drawn, which takes the longest


def scene_case(seed: int) -> Verdict:
    """Load a hostile scene and forecast it."""
    hostile, path, verdict = hostile_scene(seed), Path("scene.toml"), Verdict()
    path.write_bytes(hostile.text)
    if scene := answer(verdict, lambda: Scene.load(path, hostile.overrides)):
        verdict.faults += absurd(scene.to_dict())
        if expected := answer(verdict, lambda: forecast(scene, 1)):
            verdict.faults += faults_of_forecast(expected)
        if answer(verdict, lambda: _saved(scene)) != scene:
            verdict.faults.append("another scene: what is saved is not what was loaded")
    if seed % COMMANDS == 0:
        given = [f"--set={text}" for text in hostile.overrides]
        if answered := answer(verdict, lambda: command(["check", str(path), *given, "--threads", "1"])):
            verdict.faults += faults_of_command(*answered)
            verdict.faults += _title_kept(scene, answered[1])
    return verdict


def _saved(scene: Scene) -> Scene:
    """Return the scene as it is read again."""
    scene.save("saved.toml")
    return Scene.load("saved.toml")


def _title_kept(scene: Scene | None, out: str) -> Iterator[str]:
    """Yield a fault if a short title is not printed as it is written, as where it is taken for markup."""
    if (
        scene
        and scene.title.isprintable()
        and len(scene.title) < 40
        and "".join(scene.title.split()) not in "".join(out.split())
    ):
        yield f"title: {scene.title!r} is not shown"


def campaign_case(seed: int) -> Verdict:
    """Load a hostile campaign and list its runs, none of which is started."""
    folder, verdict = Path("campaign"), Verdict()
    folder.mkdir()
    for name, text in hostile_campaign(seed).items():
        (folder / name).write_bytes(text)
    loaded = answer(verdict, lambda: campaign.load(folder))
    for quick in (False, True) if loaded else ():
        answer(verdict, lambda quick=quick: campaign.cases(loaded, folder, quick=quick, only=[]))
    if seed % COMMANDS == 0 and (
        answered := answer(verdict, lambda: command(["study", str(folder), "--only", "-"]))
    ):
        verdict.faults += faults_of_command(*answered)
    return verdict


class FolderCases:
    """Measures and draws damaged copies of one run, made once."""

    def __init__(self) -> None:
        """Run the smallest of the examples, coarser still."""
        quick = Path(__file__).parents[2] / "examples" / "quick.toml"
        coarse = ["end_time='12 ns'", "output.snapshots='6 ns'", "body.target.spacing='5 um'"]
        self.sound = Path("sound")
        run_scene(
            Scene.load(quick, [*coarse, "body.projectile.spacing='2.5 um'"]),
            self.sound,
            threads=1,
            progress=False,
        )
        plot_run(self.sound)
        self.sound = self.sound.resolve()

    def __call__(self, seed: int) -> Verdict:
        """Break a copy, and ask for everything that reads it."""
        folder, verdict = Path("run"), Verdict()
        shutil.copytree(self.sound, folder)
        done = damage(seed, folder)
        outside = _contents(Path(OUTSIDE))
        measured = answer(verdict, lambda: measure_run(folder))
        if measured is not None:
            answer(verdict, lambda: (json.loads(to_json(measured)), report(measured)))
            if done.refused:
                verdict.faults.append(f"taken for good: {done.text}")
        if seed % PICTURES == 0:
            answer(verdict, lambda: plot_run(folder))
        answer(verdict, lambda: _rewritten(folder))
        if seed % COMMANDS == 0 and (answered := answer(verdict, lambda: command(["measure", str(folder)]))):
            verdict.faults += faults_of_command(*answered)
        if _contents(Path(OUTSIDE)) != outside:
            verdict.faults.append(f"written outside: {done.text}")
        verdict.faults = [f"{fault} ({done.text})" for fault in verdict.faults]
        return verdict


def _rewritten(folder: Path) -> None:
    """Write the manifest anew, as a run does at its end."""
    opened = RunFolder.open(folder)
    opened.write_manifest(opened.manifest())


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def run_case(seed: int) -> Verdict:
    """Run a valid scene, measure and draw it, and look for what is impossible and not said."""
    verdict, folder = Verdict(), Path("run")
    scene = answer(verdict, lambda: Scene.from_dict(impact(seed)))
    if scene is None:
        return verdict
    if (
        answer(
            verdict,
            lambda: run_scene(scene, folder, threads=1, progress=False, coarse=True),
            otherwise="stopped",
        )
        is None
    ):
        return verdict
    result = answer(verdict, lambda: measure_run(folder))
    if seed % PICTURES == 0:
        answer(verdict, lambda: plot_run(folder))
    there = RunFolder.open(folder)
    nonsense = [fault for path in there.snapshots() for fault in impossible_points(scene, Snapshot(path))]
    nonsense += impossible_history(scene, there.history())
    if result is not None:
        nonsense += impossible_result(scene, result)
    if there.manifest().get("doubts"):
        verdict.ends("doubtful" if nonsense else "doubtful, nothing found")
    else:
        verdict.faults += [f"unmarked {text}" for text in dict.fromkeys(nonsense)]
    return verdict
