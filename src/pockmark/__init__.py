"""Craters of micron-sized particles at kilometres per second, by the material point method."""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .base.errors import PockmarkError
    from .run.measured import measure_run as measure
    from .run.pipeline import resume_run, run_scene
    from .run.simulation import Simulation
    from .scene.scene import Scene

__version__ = version("pockmark")
# The number of entries under "Physics" in CHANGELOG.md. A run of another number may have other figures.
PHYSICS = 32

__all__ = [
    "PHYSICS",
    "PockmarkError",
    "Scene",
    "Simulation",
    "__version__",
    "measure",
    "resume_run",
    "run_scene",
]

_HOMES = {
    "PockmarkError": (".base.errors", "PockmarkError"),
    "Scene": (".scene.scene", "Scene"),
    "Simulation": (".run.simulation", "Simulation"),
    "measure": (".run.measured", "measure_run"),
    "resume_run": (".run.pipeline", "resume_run"),
    "run_scene": (".run.pipeline", "run_scene"),
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for.

    The command line has to hear Ctrl-C before a second of imports.
    """
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, attribute = _HOMES[name]
    return getattr(import_module(module, __name__), attribute)
