"""The C++ extension (core/bindings.cpp), untyped here: simulation.py and materials.py are its only users."""

from typing import Any

def __getattr__(name: str) -> Any: ...
