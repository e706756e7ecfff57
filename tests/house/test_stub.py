"""src/pockmark/_core.pyi says what the compiled core has. `python tests/house/test_stub.py` writes it anew."""

from pathlib import Path

import pytest

import pockmark._core as core

STUB = Path(__file__).parents[2] / "src" / "pockmark" / "_core.pyi"

HEAD = '''"""The C++ extension (core/bind/). `python tests/house/test_stub.py` writes this file."""

'''
# What _core.py adds to the module of an instruction set.
CHOICE = '''
DRIVER: str

def solver(
    *, single: bool, driver: str = ...
) -> type[Solver] | type[SolverSingle] | type[PlainSolver] | type[PlainSolverSingle]:
    """Return the class of the solvers of a precision and a driver, "cpu" or "plain"."""
'''


def generated():
    """Return the stub of the core that is imported: the same for every instruction set."""
    stubgen = pytest.importorskip("nanobind.stubgen")
    stub = stubgen.StubGen(core._module)
    stub.put(core._module)
    return HEAD + stub.get() + CHOICE


def test_the_stub_says_what_the_core_has():
    assert STUB.read_text() == generated(), "run python tests/house/test_stub.py"


if __name__ == "__main__":
    STUB.write_text(generated())
