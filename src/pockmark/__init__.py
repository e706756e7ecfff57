"""pockmark: craters of micron-sized particles at kilometres per second, by the material point method."""

from importlib.metadata import version

__version__ = version("pockmark")

from .errors import PockmarkError
from .run import measure_run as measure
from .run import run_scene
from .scene import Scene
from .simulation import Simulation

__all__ = ["PockmarkError", "Scene", "Simulation", "__version__", "measure", "run_scene"]
