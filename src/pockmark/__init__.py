"""Craters of micron-sized particles at kilometres per second, by the material point method.

`dir(pockmark)` names all that is public. docs/python.md shows how it is used.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .base.errors import PockmarkError
    from .base.shipped import example
    from .base.units import to_si
    from .run.frames import history_frame
    from .run.measured import measure
    from .run.pictures import plot_run as plot
    from .run.pipeline import resume_run, run_scene
    from .run.simulation import Simulation
    from .run.store import RunFolder
    from .run.task import KeptTask, Task
    from .scene import bodies
    from .scene.forecast import forecast
    from .scene.grid import Boundary, Grid
    from .scene.impact import Impact
    from .scene.materials import Material, material
    from .scene.numerics import Contact, Filter, Numerics, Output
    from .scene.scene import Scene
    from .study.frames import study_frame

__version__ = version("pockmark")
PHYSICS = 38
"""The number of entries under "Physics" in CHANGELOG.md. A run of another number may have other figures."""

__all__ = [
    "PHYSICS",
    "Boundary",
    "Contact",
    "Filter",
    "Grid",
    "Impact",
    "KeptTask",
    "Material",
    "Numerics",
    "Output",
    "PockmarkError",
    "RunFolder",
    "Scene",
    "Simulation",
    "Task",
    "__version__",
    "bodies",
    "example",
    "forecast",
    "history_frame",
    "material",
    "measure",
    "plot",
    "resume_run",
    "run_scene",
    "study_frame",
    "to_si",
]

# Where each public name is: a module, and the name there; a module itself has none.
_HOMES = {
    "Boundary": (".scene.grid", "Boundary"),
    "Contact": (".scene.numerics", "Contact"),
    "Filter": (".scene.numerics", "Filter"),
    "Grid": (".scene.grid", "Grid"),
    "Impact": (".scene.impact", "Impact"),
    "KeptTask": (".run.task", "KeptTask"),
    "Material": (".scene.materials", "Material"),
    "Numerics": (".scene.numerics", "Numerics"),
    "Output": (".scene.numerics", "Output"),
    "PockmarkError": (".base.errors", "PockmarkError"),
    "RunFolder": (".run.store", "RunFolder"),
    "Scene": (".scene.scene", "Scene"),
    "Simulation": (".run.simulation", "Simulation"),
    "Task": (".run.task", "Task"),
    "bodies": (".scene.bodies", ""),
    "example": (".base.shipped", "example"),
    "forecast": (".scene.forecast", "forecast"),
    "history_frame": (".run.frames", "history_frame"),
    "material": (".scene.materials", "material"),
    "measure": (".run.measured", "measure"),
    "plot": (".run.pictures", "plot_run"),
    "resume_run": (".run.pipeline", "resume_run"),
    "run_scene": (".run.pipeline", "run_scene"),
    "study_frame": (".study.frames", "study_frame"),
    "to_si": (".base.units", "to_si"),
}


if not TYPE_CHECKING:  # it would take any name

    def __getattr__(name: str) -> Any:
        """Import a public name when it is first asked for.

        The command line has to hear Ctrl-C before a second of imports.
        """
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        where, attribute = _HOMES[name]
        module = import_module(where, __name__)
        return getattr(module, attribute) if attribute else module


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
