"""Tasks of a user's own: in memory, in a run folder, and after a checkpoint; and measures without a folder."""

import math

import numpy as np
import pytest
from rings import small_rings

from pockmark import PockmarkError, Simulation, measure, resume_run, run_scene
from pockmark.run.keeper import Keeper
from pockmark.view.report import report

SCENE = small_rings("4 ns")


class Times:
    """Notes the times at which it acts."""

    def __init__(self, interval, exact):
        self.interval, self.exact = interval, exact
        self.times = []

    def act(self, simulation):
        self.times.append(simulation.time)


class Counter(Times):
    """Counts how often it acts, across a checkpoint."""

    count = 0

    def act(self, simulation):
        super().act(simulation)
        self.count += 1

    def state(self):
        return {"count": self.count}

    def set_state(self, state):
        self.count = state["count"]


def run(path, **how):
    return run_scene(SCENE, path, threads=1, progress=False, **how)


def test_a_task_acts_at_its_times_in_memory_and_in_a_folder(tmp_path):
    for start in (
        lambda tasks: Simulation(SCENE, 1).run(tasks),
        lambda tasks: run(tmp_path / "run", tasks=tasks),
    ):
        exact, near = Times(2e-9, True), Times(3e-9, False)
        start([exact, near])
        np.testing.assert_allclose(exact.times, np.arange(5) * 2e-9, rtol=1e-12)
        assert near.times[0] == 0
        assert near.times[-1] == SCENE.end_time
        for multiple, acted in zip((3e-9, 6e-9), near.times[1:3], strict=True):
            assert multiple <= acted < multiple + 0.5e-9


def test_a_task_that_is_not_exact_changes_nothing_that_is_computed(tmp_path):
    run(tmp_path / "with", tasks=[Times(1e-9, False)])
    run(tmp_path / "without")
    one, other = ((tmp_path / name / "history.csv").read_bytes() for name in ("with", "without"))
    assert one == other


def test_a_task_goes_on_where_its_checkpoint_was(tmp_path, monkeypatch):
    watch = Keeper.watch

    def stop_in_the_middle(keeper, simulation):
        watch(keeper, simulation)
        if simulation.time >= 4e-9:
            raise KeyboardInterrupt

    monkeypatch.setattr(Keeper, "watch", stop_in_the_middle)
    _, is_finished = run(tmp_path / "run", tasks=[Counter(1e-9, True)])
    assert not is_finished
    monkeypatch.setattr(Keeper, "watch", watch)
    for tasks in ((), [Counter(1e-9, True), Counter(1e-9, True)]):
        with pytest.raises(
            PockmarkError, match=f"was run with tasks of its own, 1 of them, found {len(tasks)}: "
        ):
            resume_run(tmp_path / "run", progress=False, threads=1, tasks=tasks)
    late = Counter(1e-9, True)
    assert resume_run(tmp_path / "run", progress=False, threads=1, tasks=[late]).is_finished
    print(late.times, late.count)
    assert late.count == 9
    assert len(late.times) < 9
    assert late.times[-1] == SCENE.end_time


@pytest.mark.parametrize(
    ("task", "sentence"),
    [
        (3, "tasks: found 3, expected an object with interval, exact and act"),
        (Times(0.0, True), "tasks: found 0.0 as interval, expected a finite number of seconds above 0"),
        (Times(math.nan, True), "tasks: found nan as interval"),
        (Times("1 ns", True), "tasks: found '1 ns' as interval"),
    ],
)
def test_what_is_no_task_is_refused_before_anything_is_written(task, sentence, tmp_path):
    with pytest.raises(PockmarkError, match=sentence):
        run(tmp_path / "run", tasks=[task])
    with pytest.raises(PockmarkError, match=sentence):
        Simulation(SCENE, 1).run([task])
    assert not (tmp_path / "run").exists()


def test_a_simulation_is_measured_as_its_folder_is(tmp_path):
    """But for what only a history has."""
    simulation = Simulation(SCENE, 1)
    simulation.run([Times(4e-9, True)])  # the times of its snapshots: so the steps are the same
    folder, _ = run(tmp_path / "run")
    ours, theirs = measure(simulation), measure(folder.path)
    assert ours.keys() == theirs.keys()
    told = 0
    for name, table in theirs.items():
        if not isinstance(table, dict):
            continue
        assert ours[name].keys() == table.keys()
        for key, value in table.items():
            if key in ("depth_change_last_tenth", "ledger_error_max", "particle_steps_per_second"):
                continue
            told += 1
            assert ours[name][key] == value, (name, key)
    print(f"{told} measures")
    assert told > 60
    assert ours["crater"]["depth_change_last_tenth"] is None
    assert report(ours).row_count == report(theirs).row_count


def test_a_simulation_is_measured_on_its_way():
    simulation = Simulation(SCENE, 1)
    simulation.run(end_time=4e-9)
    early = measure(simulation)
    simulation.run()
    assert early["crater"]["depth"] < measure(simulation)["crater"]["depth"]
    assert early["crater"]["time"] == pytest.approx(4e-9)
