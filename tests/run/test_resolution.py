"""The error of a run's cells: from converged studies of its kind alone."""

from pathlib import Path

import pytest

from pockmark import Scene
from pockmark.run.resolution import MEASURES, kind_of, known_studies, resolution_of
from pockmark.view.report import _cell_error

EXAMPLES = Path(__file__).parents[2] / "examples"
NORMAL, GROUP = EXAMPLES / "normal-2200.toml", EXAMPLES / "group-4500.toml"
UNKNOWN = dict.fromkeys(MEASURES) | {"studies": 0}


def scene(*overrides, path=NORMAL):
    return Scene.load(path, overrides)


def study(speed=2200.0, scale=1.0, **changes):
    """Return a study of the example, whose error falls as 1/cells, from 40 % at 4 to 2.5 % at 64."""
    across = [4.0, 16.0, 64.0]
    errors = {
        "cells_across": across,
        "errors": [-1.6 * scale / n for n in across],
        "uncertainties": [0.0] * 3,
    }
    return {"kind": kind_of(scene()), "geometry": "axisymmetric", "speed": speed, "depth": errors} | changes


def told(run, *studies):
    found = resolution_of(run, studies)
    print(found, _cell_error(found))
    return found


def test_the_error_is_that_of_as_many_cells():
    assert told(scene(), study())["depth"] == pytest.approx(1.6 / 5)  # between 4 and 16 cells across
    assert told(scene("grid.cell='1.25 um'", *POINTS), study())["depth"] == pytest.approx(0.1)


POINTS = ("body.target.spacing='0.625 um'", "body.projectile.spacing='0.3125 um'")  # as many a cell as before


def test_a_study_s_own_uncertainty_is_in_it():
    sure = study()
    blurred = study(depth=sure["depth"] | {"uncertainties": [0.3, 0.075, 0.01875]})
    assert told(scene(), blurred)["depth"] == pytest.approx((0.32**2 + 0.24**2) ** 0.5, rel=1e-6)


def test_between_two_speeds_it_is_the_larger_error():
    run = scene("impact.speed='3 km/s'")
    assert told(run, study(), study(4500.0, 0.5)) == UNKNOWN | {"depth": pytest.approx(0.32), "studies": 2}
    assert told(run, study(), study(4500.0, 2.0))["depth"] == pytest.approx(0.64)
    # The next ones count, not those beyond.
    assert told(run, study(), study(4500.0), study(7000.0, 3.0), study(1000.0, 3.0))[
        "depth"
    ] == pytest.approx(0.32)


@pytest.mark.parametrize(
    "overrides",
    [
        ("impact.speed='2.3 km/s'",),  # faster than any study
        ("impact.speed='2.1 km/s'",),
        ("impact.angle='10 deg'",),
        ("numerics.scheme='usf'",),
        ("numerics.scheme='paper'",),
        ("numerics.volumetric_strain='points'",),
        ("numerics.cfl=0.3",),
        ("contact.friction=0.1",),
        (
            "grid.cell='8 um'",
            "body.target.spacing='4 um'",
            "body.projectile.spacing='2 um'",
        ),  # fewer cells than any study
        ("body.target.spacing='1 um'",),
        (
            "body.target.material='ofhc'",
            "materials.ofhc={based_on='al2024-liu2015', strength={model='elastic', shear_modulus='26 GPa'}, failure={model='none'}}",
        ),
    ],
)
def test_a_run_of_another_kind_is_unknown(overrides):
    assert told(scene(*overrides), study()) == UNKNOWN | {"studies": int("grid.cell='8 um'" in overrides)}


def test_the_precision_and_the_constants_of_a_law_make_no_other_kind():
    run = scene(
        "numerics.precision='single'",
        "materials.al2024-liu2015={based_on='al2024-liu2015', strength={A='300 MPa'}}",
    )
    assert told(run, study())["depth"] == pytest.approx(0.32)


def test_a_study_in_3d_says_nothing_of_an_axisymmetric_run():
    run = scene("grid.geometry='axisymmetric'", "body.target.rounded=false")
    in_3d = study(geometry="3d")
    assert kind_of(run) == in_3d["kind"]
    assert told(run, in_3d) == UNKNOWN
    assert told(run, study())["depth"] == pytest.approx(0.32)
    assert told(scene(), in_3d)["depth"] == pytest.approx(0.32)


def test_a_group_is_of_no_kind():
    assert kind_of(scene(path=GROUP)) is None
    assert told(scene(path=GROUP), study(kind=None)) == UNKNOWN


def test_a_measure_that_one_study_lacks_is_unknown():
    both = study(diameter=study()["depth"])
    assert told(scene(), both)["diameter"] == pytest.approx(0.32)
    assert told(scene("impact.speed='3 km/s'"), both, study(4500.0))["diameter"] is None


def test_the_table_says_it_in_words():
    assert _cell_error(UNKNOWN).startswith("their error is unknown")
    known = {"depth": 0.058, "diameter": None, "residual_internal": 0.012, "studies": 2}
    assert _cell_error(known) == "their error is about C_p 5.8 %, E_i^r 1.2 %, from 2 converged studies"
    assert _cell_error(known | {"studies": 1}).endswith("from 1 converged study")


def test_the_studies_that_come_with_pockmark_are_whole():
    """None is known until `python studies/resolution/make.py` has run; then each has what a run is compared by."""
    for known in known_studies():
        assert known["kind"].keys() == kind_of(scene()).keys()
        assert known["geometry"] in ("3d", "axisymmetric")
        assert known["speed"] > 0
        for name in set(MEASURES) & known.keys():
            columns = [known[name][key] for key in ("cells_across", "errors", "uncertainties")]
            assert len({len(column) for column in columns}) == 1
            assert len(columns[0]) >= 3
    assert resolution_of(scene()).keys() == UNKNOWN.keys()
