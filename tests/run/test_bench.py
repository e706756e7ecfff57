"""`pockmark bench`: the figures hang together; the drivers agree. No speed is asserted."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pockmark.run.bench import bench_scene
from pockmark.run.simulation import Simulation


def test_bench_prints_figures_that_hang_together():
    command = [sys.executable, "-m", "pockmark", "bench", "--json", "--points", "5000", "--threads", "1"]
    result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    total = sum(phase["ns_per_point"] for phase in result["phases"].values())
    print(f"{result['particle_steps_per_second']:.3g} particle-steps/s on {result['isa']}")
    assert result["particle_steps_per_second"] == pytest.approx(1e9 / total, rel=1e-6)
    assert result["copy_bandwidth"] > 0
    assert result["share_of_copy_bandwidth"] == pytest.approx(result["traffic"] / result["copy_bandwidth"])
    assert result["over_plain"] > 0
    assert result["bytes_per_point"] <= 250
    assert set(result["phases"]) >= {"clear", "p2g", "boundary", "stress", "momentum", "g2p", "move", "sort"}


def test_a_scheme_that_blows_up_is_told_in_a_sentence():
    command = [sys.executable, "-m", "pockmark", "bench", "--points", "5000", "--threads", "1"]
    done = subprocess.run(
        [
            *command,
            *(
                f"--set={key}"
                for key in (
                    "numerics.scheme=usl",
                    "impact.speed=14 km/s",
                    "numerics.cfl=1",
                    "numerics.strain_limit=1",
                )
            ),
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("pockmark: bench: the run failed: ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
@pytest.mark.parametrize("scheme", ["usf", "musl", "usavg"])
@pytest.mark.parametrize(("precision", "tolerance"), [("double", 1e-12), ("single", 1e-4)])
def test_the_drivers_agree(scheme, shape, precision, tolerance):
    """A whole impact, with mixed bodies in a pack, odd runs, lone points and empty cells."""
    scene = bench_scene(
        5000,
        (
            f"numerics.scheme={scheme}",
            f"numerics.shape_functions={shape}",
            f"numerics.precision={precision}",
            "grid.cell='15.3 um'",
        ),
    )
    ends = []
    for driver in ("plain", "cpu"):
        simulation = Simulation(scene, 2, driver=driver)
        simulation.advance(1.0, max_steps=25)
        order = np.argsort(simulation.field("id"))
        ends.append({name: simulation.field(name)[order] for name in ("velocity", "energy", "deviator")})
        ends[-1]["ledger"] = np.array([simulation.ledger()[k] for k in ("internal", "kinetic", "absorbed")])
    for name, plain in ends[0].items():
        off = np.abs(ends[1][name] - plain).max() / np.abs(plain).max()
        print(f"{scheme}, {shape}, {precision}: {name} differs by {off:.1e} of its largest")
        assert off < tolerance


@pytest.mark.parametrize("what", ["cases", "growth"])
def test_the_benchmark_script_starts(what):
    """With no case to run: its imports and its tables' places."""
    script = Path(__file__).parents[2] / "benchmarks" / "run.py"
    subprocess.run([sys.executable, script, what, "--only", "nothing"], check=True, timeout=120)
