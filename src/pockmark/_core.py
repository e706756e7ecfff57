"""The compiled core for this processor: AVX-512, AVX2 or scalar. POCKMARK_ISA=avx512|avx2|scalar forces one."""

import importlib
import os
import sys

# A thread that waits for the others looks again for some microseconds and then sleeps. Spinning for longer, as OpenMP does
# unless told, takes the core from the thread that is waited for wherever something else runs too: ten times slower on a
# busy machine. Read when the library is loaded; GOMP_SPINCOUNT is GCC's.
if "OMP_WAIT_POLICY" not in os.environ:
    os.environ["OMP_WAIT_POLICY"] = "passive"
    os.environ.setdefault("GOMP_SPINCOUNT", "1000")

from . import _core_scalar

_supported = _core_scalar.supported_isas()


def _choose() -> str:
    forced = os.environ.get("POCKMARK_ISA", "")
    if forced and forced not in _supported:
        allowed = ", ".join(_supported)
        print(
            f"pockmark: POCKMARK_ISA: '{forced}' found, allowed on this processor: {allowed}", file=sys.stderr
        )
        raise SystemExit(2)
    return forced or _supported[0]


globals().update(vars(importlib.import_module(f"pockmark._core_{_choose()}")))
