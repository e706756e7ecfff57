"""A simulation that goes on from what another one has saved is the same to the last bit."""

import numpy as np
import pytest

from pockmark import PockmarkError
from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation, field_names

LEAVING = ("impact.speed=12000", "grid.upper=['100 um', '100 um', '21 um']")  # points fly through the lid
RUNS = {
    "usavg": (),
    "usavg single": ("numerics.precision=single",),
    "usavg quadratic": ("numerics.shape_functions=quadratic",),
    "usf": ("numerics.scheme=usf",),
    "musl": ("numerics.scheme=musl",),
    "usl quadratic": ("numerics.scheme=usl", "numerics.shape_functions=quadratic"),
    "contact": ("contact.friction=0.3", "grid.cell='15.3 um'"),
    "contact single quadratic": (
        "contact.friction=0.3",
        "numerics.precision=single",
        "numerics.shape_functions=quadratic",
    ),
    "pic": ("numerics.pic_fraction=0.02",),
    "cut-off": ("numerics.scheme=usf", "numerics.mass_cutoff=0.01"),
    "leaving": LEAVING,
    "filter": ("numerics.filter.interval=3", "contact.friction=0.3", "numerics.volumetric_strain=cells"),
    "node velocity": ("numerics.node_velocity=linear", "numerics.filter.interval=3", "contact.friction=0.3"),
    "axisymmetric": ("grid.geometry=axisymmetric", "impact.speed=12000"),
    "axisymmetric contact cells": (
        "grid.geometry=axisymmetric",
        "contact.friction=0.3",
        "numerics.volumetric_strain=cells",
    ),
}


def copied(parts):
    """Return what a file would hold: the views are of memory that changes."""
    return {name: np.array(part) if isinstance(part, np.ndarray) else part for name, part in parts.items()}


def assert_same(one, other):
    for name in field_names():
        assert np.array_equal(one.field(name), other.field(name)), name
    assert one.ledger() == other.ledger()
    assert one.counters() == other.counters()
    assert (one.time, one.steps, one.points) == (other.time, other.steps, other.points)


@pytest.mark.parametrize("driver", ["cpu", "plain"])
@pytest.mark.parametrize("name", RUNS)
def test_a_restored_run_goes_on_to_the_last_bit(name, driver):
    """Saved at any step, between sorts or after them, restored on another number of threads, saved and restored again."""
    points = 8000 if driver == "cpu" else 3000
    scene = bench_scene(points * 40 if "axisymmetric" in name else points, RUNS[name])  # fewer are rings
    rng = np.random.default_rng(list(RUNS).index(name))
    whole, resumed = (Simulation(scene, 1, driver=driver) for _ in range(2))
    for threads in (2, 1, 2):
        steps = int(rng.integers(1, 60 if driver == "cpu" else 8))
        for simulation in (whole, resumed):
            simulation.advance(1.0, max_steps=steps)
        resumed = Simulation(scene, threads, driver=driver, parts=copied(resumed.save()))
        assert_same(whole, resumed)
    for simulation in (whole, resumed):
        simulation.advance(1.0, max_steps=40 if driver == "cpu" else 6)
    print(f"{name}: {whole.steps} steps, {whole.sorts} sorts, {whole.counters()['left_points']} points left")
    assert_same(whole, resumed)


def test_what_sleeps_is_restored_asleep():
    scene = bench_scene(60_000, ("impact.speed=4000", "numerics.node_velocity=mean"))
    whole = Simulation(scene, 1, driver="cpu")
    whole.advance(1.0, max_steps=1)
    resumed = Simulation(scene, 2, driver="cpu", parts=copied(whole.save()))
    assert resumed.sleeping_points == whole.sleeping_points > 0
    for simulation in (whole, resumed):
        simulation.advance(1.0, max_steps=10)
    assert resumed.sleeping_points == whole.sleeping_points
    assert_same(whole, resumed)


def test_to_save_changes_nothing():
    scene = bench_scene(8000, LEAVING)
    saved, plain = (Simulation(scene, 1) for _ in range(2))
    for _ in range(60):
        saved.advance(1.0, max_steps=1)
        saved.save()
    plain.advance(1.0, max_steps=60)
    assert_same(saved, plain)


def test_parts_that_do_not_fit_are_refused_in_a_sentence():
    scene = bench_scene(5000)
    simulation = Simulation(scene, 1, driver="cpu")
    simulation.advance(1.0, max_steps=3)
    parts = copied(simulation.save())
    for name, part in parts.items():
        wrong = [{k: v for k, v in parts.items() if k != name}, parts | {name: "seven"}, parts | {name: None}]
        if isinstance(part, np.ndarray) and part.size:
            wrong += [parts | {name: part[:-1]}, parts | {name: part.astype(complex)}]
        for given in wrong:
            with pytest.raises(PockmarkError, match="what was saved does not fit the scene"):
                Simulation(scene, 1, driver="cpu", parts=given)
    with pytest.raises(PockmarkError, match="does not fit"):
        Simulation(bench_scene(9000), 1, driver="cpu", parts=parts)
