"""The provenance of a run: the machine, the build, the commit, the time."""

import os
import platform
import subprocess
import time
from pathlib import Path
from typing import Any

from .. import _core


def machine() -> dict[str, Any]:
    """Return the machine and the build: processor, cores, compiler."""
    model = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "build": dict(_core.build_info()),
    }


def commit() -> str | None:
    """Return the git commit of the pockmark tree around this file; None if there is none.

    It ends in "-dirty" if the tree's code has changed since.
    """
    # A virtual environment inside somebody's own repository must not give that repository's commit.
    if _git("ls-files", "--error-unmatch", ":/src/pockmark/run/provenance.py") is None:
        return None
    head = _git("rev-parse", "HEAD")
    changed = _git("status", "--porcelain", "--", ":/src", ":/core", ":/CMakeLists.txt")
    return f"{head}-dirty" if head and changed else head


def _git(*arguments: str) -> str | None:
    """Return the output of git in this file's folder; None if git fails or is missing."""
    try:
        out = subprocess.run(
            ["git", *arguments],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return out.stdout.strip() if out.returncode == 0 else None


def now() -> str:
    """Return the time, UTC, ISO 8601."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
