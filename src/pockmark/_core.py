"""The compiled core for this processor: AVX-512, AVX2 or scalar.

POCKMARK_ISA=avx512|avx2|scalar forces one. POCKMARK_DRIVER=plain takes the plain driver instead of the CPU's. The
plain driver is slow; the CPU's is tested against it.
"""

import importlib.util
import os
import sys
from typing import Any

# A thread that waits for the others looks again for some microseconds and then sleeps. Spinning for longer, as OpenMP does
# unless told, takes the processor from the thread that is waited for: ten times slower on a busy machine. OpenMP reads the
# variables when it is loaded. GOMP_SPINCOUNT is that of GCC's library.
if "OMP_WAIT_POLICY" not in os.environ:
    os.environ["OMP_WAIT_POLICY"] = "passive"
    os.environ.setdefault("GOMP_SPINCOUNT", "1000")

from . import _core_scalar

# What the processor has, of what was built: POCKMARK_ISAS of CMakeLists.txt may leave some out.
_supported = [
    isa for isa in _core_scalar.supported_isas() if importlib.util.find_spec(f"pockmark._core_{isa}")
]


def _choose(variable: str, allowed: list[str]) -> str:
    """Return what a variable of the environment says; the first of those allowed where it is not set."""
    forced = os.environ.get(variable, "")
    if forced and forced not in allowed:
        print(
            f"pockmark: {variable}: '{forced}' found, allowed on this processor: {', '.join(allowed)}",
            file=sys.stderr,
        )
        raise SystemExit(2)
    return forced or allowed[0]


DRIVER = _choose("POCKMARK_DRIVER", ["cpu", "plain"])
_module = importlib.import_module(f"pockmark._core_{_choose('POCKMARK_ISA', _supported)}")
globals().update(vars(_module))


def solver(*, single: bool, driver: str = DRIVER) -> Any:
    """Return the class of solvers of a precision and a driver, "cpu" or "plain"."""
    name = ("PlainSolver" if driver == "plain" else "Solver") + ("Single" if single else "")
    return getattr(_module, name)
