"""The table of errors that a run is told by: made of what converges alone, and read back as it was made."""

import importlib.util
import tomllib
from pathlib import Path

import pytest

from pockmark import Scene, __version__
from pockmark.run.resolution import kind_of, resolution_of
from pockmark.study.convergence import cases_of, findings
from pockmark.study.levels import plan_of
from pockmark.study.runner import Outcome

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def make():
    spec = importlib.util.spec_from_file_location("make", ROOT / "studies" / "resolution" / "make.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_what_is_written_is_what_a_run_is_told(make):
    scene = Scene.load(make.SCENE)
    plan = plan_of(scene, most=4, budget=240.0, threads=2)
    outcomes = []
    for case, diameter in zip(cases_of(plan), (30e-6, 40e-6, 30e-6, 40e-6), strict=True):  # D_c has no limit
        share = case.scene.grid.cell / scene.grid.cell
        crater = {"depth": 20e-6 * (1 - 0.25 * share), "diameter": diameter}
        result = {"crater": crater, "energy": {"residual_internal": 0.9 + 0.05 * share**1.5}, "doubts": []}
        outcomes.append(Outcome(case, result))
    kept = make.converged(findings(plan, outcomes), [level.scene for level in plan.levels])
    assert kept.keys() == {"depth", "residual_internal"}
    study = {"speed": 2200.0, "geometry": "axisymmetric", "kind": kind_of(plan.levels[plan.own].scene)} | kept
    read = tomllib.loads(make.text_of([study]))
    assert read["study"] == [study]
    assert (read["version"], read["command"]) == (__version__, make.COMMAND)
    told = resolution_of(plan.levels[plan.own].scene, read["study"])
    print(told)
    finest = plan.levels[-1].cell / scene.grid.cell
    assert told["depth"] == pytest.approx((0.25**2 + (1.25 * 0.25 * finest) ** 2) ** 0.5, rel=1e-3)
    assert told["diameter"] is None
    assert told["studies"] == 1
