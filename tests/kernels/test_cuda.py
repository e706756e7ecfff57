"""The physics headers as CUDA: the laws of random points on a GPU against the same headers on the CPU."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "cuda" / "laws.cu"


@pytest.mark.skipif(
    not (shutil.which("nvcc") and shutil.which("nvidia-smi")), reason="needs nvcc and an NVIDIA GPU"
)
def test_the_laws_are_the_same_on_a_gpu(tmp_path):
    program = tmp_path / "laws"
    # Products and sums are not fused, as on the CPU: then every bit must be the same.
    options = ["-std=c++20", "-O3", "-arch=native", "--expt-relaxed-constexpr", "--fmad=false"]
    subprocess.run(["nvcc", *options, SOURCE, "-o", program], check=True, timeout=300)
    done = subprocess.run([program], capture_output=True, text=True, check=True, timeout=60)
    print(done.stdout)
    for found in json.loads(done.stdout).values():
        points, plastic = found.pop("points"), found.pop("plastic_points")
        assert 0.1 * points < plastic < points
        assert found.pop("points_per_second") > 0
        assert len(found) == 10
        assert all(difference == 0 for difference in found.values())
