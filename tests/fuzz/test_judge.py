"""The fuzzer's own eyes: each kind of fault is seen where it is, and nothing is seen in a good answer."""

import warnings
from types import SimpleNamespace

import numpy as np
import physics
import pytest
from judge import Verdict, absurd, answer, faults_of_command, faults_of_forecast

from pockmark import PockmarkError, Scene


def _refuse(text):
    error = PockmarkError("")
    error.args = (text,)  # as it would be if the error did not clean its sentence itself
    raise error


def kinds(faults):
    return sorted({fault.partition(":")[0] for fault in faults})


@pytest.mark.parametrize(
    ("ask", "outcome", "seen"),
    [
        (lambda: 1, "accepted", []),
        (lambda: _refuse("scene.toml: impact.speed: is missing"), "refused", []),
        (lambda: _refuse("a\nb"), "refused", ["more than a line"]),
        (lambda: _refuse("a\x1b[1m"), "refused", ["control character"]),
        (lambda: _refuse("x" * 501), "refused", ["long sentence"]),
        (lambda: _refuse(" "), "refused", ["empty sentence"]),
        (lambda: {}["a"], "traceback", ["traceback"]),
        (lambda: warnings.warn("w", stacklevel=1), "accepted", ["warning"]),
    ],
)
def test_an_answer_is_judged(ask, outcome, seen):
    verdict = Verdict()
    answer(verdict, ask)
    assert (verdict.outcome, kinds(verdict.faults)) == (outcome, seen)


@pytest.mark.parametrize(
    ("code", "out", "err", "seen"),
    [
        (0, "a table\n", "", []),
        (2, "", "pockmark: scene.toml: is missing\n", []),
        (1, "", "", ["exit code"]),
        (0, "a\x07\n", "", ["control character"]),
        (0, "", "a library's warning\n", ["noise"]),
        (2, "", "one\ntwo\n", ["more than a line"]),
    ],
)
def test_a_command_is_judged(code, out, err, seen):
    assert kinds(faults_of_command(code, out, err)) == seen


def test_absurd_numbers_are_seen():
    table = {"a": 1.0, "b": {"c": [0.0, -1e-7, 1e-150]}, "d": [{"e": 1e200}], "f": 1e30}
    assert list(absurd(table)) == ["absurd value: b.c = 1e-150", "absurd value: d.e = 1e+200"]


def test_a_forecast_is_judged():
    good = {"points": 1, "cells": 1, "steps": 1, "memory": 1.0, "seconds": 1.0, "warnings": ["a"]}
    assert not list(faults_of_forecast(SimpleNamespace(**good)))
    bad = good | {"seconds": float("nan"), "warnings": ["\x00"]}
    assert kinds(faults_of_forecast(SimpleNamespace(**bad))) == ["control character", "forecast"]


@pytest.fixture(scope="module")
def scene():
    table = {
        "end_time": "1 ns",
        "impact": {"speed": "2 km/s"},
        "grid": {"lower": ["-9 um", "0 um", "-9 um"], "upper": ["9 um", "9 um", "9 um"], "cell": "1 um"},
        "body": [
            {"name": "target", "shape": "block", "lower": ["-9 um", "0 um", "-9 um"], "upper": ["9 um", "9 um", "0 um"]},
            {"name": "ball", "shape": "sphere", "center": [0, 0, "3 um"], "radius": "3 um", "projectile": True},
        ],
    }  # fmt: skip
    table["body"] = [body | {"spacing": "1 um", "material": "al2024-liu2015"} for body in table["body"]]
    return Scene.from_dict(table)


def snapshot(**changed):
    """Two sound points of the target at rho/rho0 = 1.25, the second with what is changed."""
    volume, density = 1e-18, 2770.0
    fields = {name: np.ones((2, n)) for name, n in (("position", 3), ("velocity", 3), ("deviator", 6))}
    fields |= {name: np.ones(2) for name in physics.NEEDED if name not in fields}
    fields |= {
        "body": np.zeros(2, int),
        "mass": np.full(2, 1.25 * density * volume),
        "volume": np.full(2, volume),
    }
    fields |= {"energy": np.full(2, 1e9), "temperature": np.full(2, 300.0)}
    for name, value in changed.items():
        fields[name][1] = value
    return fields


@pytest.mark.parametrize(
    ("changed", "seen"),
    [
        ({}, []),
        ({"pressure": np.nan}, ["not finite"]),
        ({"volume": -1e-18}, ["no volume"]),
        ({"temperature": -1.0}, ["below 0 K"]),
        ({"volume": 0.25e-18}, ["beyond the strong-shock limit"]),  # 5; s/(s - 1) = 3.94
        ({"volume": 0.35e-18}, []),
        ({"energy": -1e7}, ["negative energy"]),  # 1.8e-3 of 5.54e9 J/m3
        ({"energy": -1e6}, []),
        ({"energy": -1e7, "volume": 1.5e-18}, []),  # not compressed
    ],
)
def test_impossible_points_are_seen(scene, changed, seen):
    assert kinds(physics.impossible_points(scene, snapshot(**changed))) == seen


@pytest.mark.parametrize(
    ("error", "densest", "seen"),
    [
        ([0, 0.009], 2.0, []),
        ([-0.011, 0], 2.0, ["ledger"]),
        ([0, np.nan], 2.0, ["ledger"]),
        ([0, 0], 4.0, ["beyond the strong-shock limit"]),
    ],
)
def test_an_impossible_history_is_seen(scene, error, densest, seen):
    history = {"error": np.array(error), "initial": np.ones(2), "max_compression": np.array([1.0, densest])}
    assert kinds(physics.impossible_history(scene, history)) == seen


@pytest.mark.parametrize(
    ("residual", "depth", "seen"),
    [
        (0.8, 4e-6, []),
        (0.8, None, []),
        (None, None, []),
        (-0.02, 4e-6, ["residual energy"]),
        (1.02, 4e-6, ["residual energy"]),
        (0.8, 9e-6, ["depth"]),  # the block's thickness
        (0.8, -1e-6, ["depth"]),
    ],
)
def test_an_impossible_result_is_seen(scene, residual, depth, seen):
    result = {"energy": {"residual_internal": residual}, "crater": {"depth": depth}, "warnings": []}
    assert kinds(physics.impossible_result(scene, result)) == seen
