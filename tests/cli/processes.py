"""Commands in a process of their own, for the tests of this folder."""

import subprocess
import sys
from pathlib import Path

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"


def short_run(output, *more, **kwargs):
    """Start `pockmark run` of the quick scene."""
    command = [
        sys.executable,
        "-m",
        "pockmark",
        "run",
        QUICK,
        "-o",
        output,
        "--quiet",
        "--threads",
        "1",
        *more,
    ]
    return subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **kwargs
    )
