"""The C++ extension (core/bind/). `python tests/house/test_stub.py` writes this file."""

from collections.abc import Mapping, Sequence
import enum
from typing import Annotated, Any

import numpy
import numpy.typing
from numpy.typing import NDArray


class Face(enum.Enum):
    free = 0

    symmetry = 1

    fixed = 2

    transmitting = 3

class Scheme(enum.Enum):
    usf = 0

    musl = 1

    usl = 2

    usavg = 3

class ShapeFunction(enum.Enum):
    trilinear = 0

    quadratic = 1

class VolumetricStrain(enum.Enum):
    points = 0

    cells = 1

class AtNodes(enum.Enum):
    mean = 0

    linear = 1

class Options:
    def __init__(self, scheme: Scheme, shape: ShapeFunction, volumetric_strain: VolumetricStrain, node_velocity: AtNodes, cfl: float, strain_limit: float, pic_fraction: float, mass_cutoff: float, sleep: bool, filter_interval: int = 0, filter_order: int = 0, pressure_filter: float = 0.0) -> None: ...

class Material:
    """A material as it is written, SI."""

    def __init__(self, *, eos: Mapping[str, float | str], strength: Mapping[str, float | str], failure: Mapping[str, float | str], density: float, specific_heat: float, taylor_quinney: float, room_temperature: float, melt_temperature: float, q_quadratic: float, q_linear: float) -> None: ...

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus at rest, Pa."""

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at rest, Pa."""

    def eos_at(self, rows: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
        """
        Return rows of pressure, its slopes by mu and E, whether the compression is capped, temperature, phase, for rows of mu, E.

        Temperature and phase are nan where the law knows neither.
        """

    def strength_at(self, rows: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> NDArray[numpy.float64]:
        """
        Return rows of flow stress, its four slopes, least flow stress, shear modulus, for rows of plastic strain, rate, temperature, pressure, V/V0, damage.

        The slopes are those of `Flow` (core/strength/strength.hpp). A law that does not yield has an infinite flow stress.
        """

def laws() -> dict[str, list[dict[str, Any]]]:
    """
    Return what each law declares of itself, by kind: eos, strength, failure.
    """

def failure_fault(law: Mapping[str, float | str]) -> str:
    """Say why a failure law never acts; nothing where it does."""

def failure_caution(law: Mapping[str, float | str]) -> str:
    """
    Say what is to be known of a failure law's constants; nothing where nothing is.
    """

class Solver:
    def __init__(self, lower: Sequence[float], cell: float, cells: Sequence[int], faces: Sequence[Face], materials: Sequence[Material], options: Options, threads: int, axisymmetric: bool = False) -> None: ...

    def set_contact(self, in_second: Sequence[int], friction: float) -> None:
        """
        Give the bodies for which `in_second` a velocity field of their own, before any point is added.
        """

    def let_fly(self, flies: Sequence[int]) -> None:
        """Name the bodies that transmitting faces let pass, before `initialize`."""

    @property
    def cells(self) -> int:
        """Cells of the grid."""

    def reserve(self, points: int) -> None:
        """Make room for a number of points."""

    def add_points(self, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], body: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)]) -> None:
        """Add points, before `initialize`."""

    @property
    def points(self) -> int:
        """Points that have not left."""

    def field(self, name: str) -> numpy.typing.NDArray[Any]:
        """
        Return a field of the points that have not left, SI; also `body` and `id`.
        """

    def set_field(self, name: str, values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Change a field of the points that have not left, SI."""

    def volume_fraction(self, counts: Sequence[int]) -> NDArray[numpy.float32]:
        """
        Return the share of the space around each node, the rim of nodes included, that some bodies fill.
        """

    def initialize(self) -> None:
        """Prepare the first step, once all points are there."""

    def advance(self, max_steps: int, end_time: float, pause: float = float('inf')) -> int:
        """
        Step to `end_time`, landing on it, unless `max_steps` or the first step at or beyond `pause` comes before, and return the steps done.
        """

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def dt(self) -> float:
        """Length of the last step, s."""

    @property
    def cycle(self) -> int:
        """Steps done."""

    def ledger(self) -> dict[str, float]:
        """
        Return where energy (J), momentum (kg m/s) and mass (kg) are, and where they went.
        """

    def counters(self) -> dict[str, int]:
        """Return how often each clamp, floor and loss happened."""

    def impossible(self) -> dict[str, tuple[int, list[float], list[float]]]:
        """
        Return the points that are in an impossible state now, by the counter of it: how many, and the corners of a box around them, m.
        """

    def max_compression(self) -> float:
        """Return the largest rho/rho0 of any point so far."""

    @property
    def sorts(self) -> int:
        """How often the points were sorted by cell."""

    @property
    def sleeping_points(self) -> int:
        """Points that steps pass over, for they and all around them are at rest."""

    def timers(self) -> dict[str, float]:
        """Return the seconds that each phase of the steps took."""

    def memory_bytes(self) -> dict[str, int]:
        """Return the bytes of points and of the grid."""

    def save(self) -> dict[str, Any]:
        """
        Return all that a step reads of the steps before it, by name; long arrays are views of the solver's memory.
        """

    def restore(self, parts: Mapping[str, Any]) -> None:
        """Take back what `save` returned, in a solver that never had points."""

class SolverSingle:
    def __init__(self, lower: Sequence[float], cell: float, cells: Sequence[int], faces: Sequence[Face], materials: Sequence[Material], options: Options, threads: int, axisymmetric: bool = False) -> None: ...

    def set_contact(self, in_second: Sequence[int], friction: float) -> None:
        """
        Give the bodies for which `in_second` a velocity field of their own, before any point is added.
        """

    def let_fly(self, flies: Sequence[int]) -> None:
        """Name the bodies that transmitting faces let pass, before `initialize`."""

    @property
    def cells(self) -> int:
        """Cells of the grid."""

    def reserve(self, points: int) -> None:
        """Make room for a number of points."""

    def add_points(self, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], body: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)]) -> None:
        """Add points, before `initialize`."""

    @property
    def points(self) -> int:
        """Points that have not left."""

    def field(self, name: str) -> numpy.typing.NDArray[Any]:
        """
        Return a field of the points that have not left, SI; also `body` and `id`.
        """

    def set_field(self, name: str, values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Change a field of the points that have not left, SI."""

    def volume_fraction(self, counts: Sequence[int]) -> NDArray[numpy.float32]:
        """
        Return the share of the space around each node, the rim of nodes included, that some bodies fill.
        """

    def initialize(self) -> None:
        """Prepare the first step, once all points are there."""

    def advance(self, max_steps: int, end_time: float, pause: float = float('inf')) -> int:
        """
        Step to `end_time`, landing on it, unless `max_steps` or the first step at or beyond `pause` comes before, and return the steps done.
        """

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def dt(self) -> float:
        """Length of the last step, s."""

    @property
    def cycle(self) -> int:
        """Steps done."""

    def ledger(self) -> dict[str, float]:
        """
        Return where energy (J), momentum (kg m/s) and mass (kg) are, and where they went.
        """

    def counters(self) -> dict[str, int]:
        """Return how often each clamp, floor and loss happened."""

    def impossible(self) -> dict[str, tuple[int, list[float], list[float]]]:
        """
        Return the points that are in an impossible state now, by the counter of it: how many, and the corners of a box around them, m.
        """

    def max_compression(self) -> float:
        """Return the largest rho/rho0 of any point so far."""

    @property
    def sorts(self) -> int:
        """How often the points were sorted by cell."""

    @property
    def sleeping_points(self) -> int:
        """Points that steps pass over, for they and all around them are at rest."""

    def timers(self) -> dict[str, float]:
        """Return the seconds that each phase of the steps took."""

    def memory_bytes(self) -> dict[str, int]:
        """Return the bytes of points and of the grid."""

    def save(self) -> dict[str, Any]:
        """
        Return all that a step reads of the steps before it, by name; long arrays are views of the solver's memory.
        """

    def restore(self, parts: Mapping[str, Any]) -> None:
        """Take back what `save` returned, in a solver that never had points."""

class PlainSolver:
    def __init__(self, lower: Sequence[float], cell: float, cells: Sequence[int], faces: Sequence[Face], materials: Sequence[Material], options: Options, threads: int, axisymmetric: bool = False) -> None: ...

    def set_contact(self, in_second: Sequence[int], friction: float) -> None:
        """
        Give the bodies for which `in_second` a velocity field of their own, before any point is added.
        """

    def let_fly(self, flies: Sequence[int]) -> None:
        """Name the bodies that transmitting faces let pass, before `initialize`."""

    @property
    def cells(self) -> int:
        """Cells of the grid."""

    def reserve(self, points: int) -> None:
        """Make room for a number of points."""

    def add_points(self, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], body: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)]) -> None:
        """Add points, before `initialize`."""

    @property
    def points(self) -> int:
        """Points that have not left."""

    def field(self, name: str) -> numpy.typing.NDArray[Any]:
        """
        Return a field of the points that have not left, SI; also `body` and `id`.
        """

    def set_field(self, name: str, values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Change a field of the points that have not left, SI."""

    def volume_fraction(self, counts: Sequence[int]) -> NDArray[numpy.float32]:
        """
        Return the share of the space around each node, the rim of nodes included, that some bodies fill.
        """

    def initialize(self) -> None:
        """Prepare the first step, once all points are there."""

    def advance(self, max_steps: int, end_time: float, pause: float = float('inf')) -> int:
        """
        Step to `end_time`, landing on it, unless `max_steps` or the first step at or beyond `pause` comes before, and return the steps done.
        """

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def dt(self) -> float:
        """Length of the last step, s."""

    @property
    def cycle(self) -> int:
        """Steps done."""

    def ledger(self) -> dict[str, float]:
        """
        Return where energy (J), momentum (kg m/s) and mass (kg) are, and where they went.
        """

    def counters(self) -> dict[str, int]:
        """Return how often each clamp, floor and loss happened."""

    def impossible(self) -> dict[str, tuple[int, list[float], list[float]]]:
        """
        Return the points that are in an impossible state now, by the counter of it: how many, and the corners of a box around them, m.
        """

    def max_compression(self) -> float:
        """Return the largest rho/rho0 of any point so far."""

    @property
    def sorts(self) -> int:
        """How often the points were sorted by cell."""

    @property
    def sleeping_points(self) -> int:
        """Points that steps pass over, for they and all around them are at rest."""

    def timers(self) -> dict[str, float]:
        """Return the seconds that each phase of the steps took."""

    def memory_bytes(self) -> dict[str, int]:
        """Return the bytes of points and of the grid."""

    def save(self) -> dict[str, Any]:
        """
        Return all that a step reads of the steps before it, by name; long arrays are views of the solver's memory.
        """

    def restore(self, parts: Mapping[str, Any]) -> None:
        """Take back what `save` returned, in a solver that never had points."""

class PlainSolverSingle:
    def __init__(self, lower: Sequence[float], cell: float, cells: Sequence[int], faces: Sequence[Face], materials: Sequence[Material], options: Options, threads: int, axisymmetric: bool = False) -> None: ...

    def set_contact(self, in_second: Sequence[int], friction: float) -> None:
        """
        Give the bodies for which `in_second` a velocity field of their own, before any point is added.
        """

    def let_fly(self, flies: Sequence[int]) -> None:
        """Name the bodies that transmitting faces let pass, before `initialize`."""

    @property
    def cells(self) -> int:
        """Cells of the grid."""

    def reserve(self, points: int) -> None:
        """Make room for a number of points."""

    def add_points(self, position: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], velocity: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], mass: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], volume: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)], body: Annotated[NDArray[numpy.uint8], dict(order='C', device='cpu', writable=False)]) -> None:
        """Add points, before `initialize`."""

    @property
    def points(self) -> int:
        """Points that have not left."""

    def field(self, name: str) -> numpy.typing.NDArray[Any]:
        """
        Return a field of the points that have not left, SI; also `body` and `id`.
        """

    def set_field(self, name: str, values: Annotated[NDArray[numpy.float64], dict(order='C', device='cpu', writable=False)]) -> None:
        """Change a field of the points that have not left, SI."""

    def volume_fraction(self, counts: Sequence[int]) -> NDArray[numpy.float32]:
        """
        Return the share of the space around each node, the rim of nodes included, that some bodies fill.
        """

    def initialize(self) -> None:
        """Prepare the first step, once all points are there."""

    def advance(self, max_steps: int, end_time: float, pause: float = float('inf')) -> int:
        """
        Step to `end_time`, landing on it, unless `max_steps` or the first step at or beyond `pause` comes before, and return the steps done.
        """

    @property
    def time(self) -> float:
        """Simulated time, s."""

    @property
    def dt(self) -> float:
        """Length of the last step, s."""

    @property
    def cycle(self) -> int:
        """Steps done."""

    def ledger(self) -> dict[str, float]:
        """
        Return where energy (J), momentum (kg m/s) and mass (kg) are, and where they went.
        """

    def counters(self) -> dict[str, int]:
        """Return how often each clamp, floor and loss happened."""

    def impossible(self) -> dict[str, tuple[int, list[float], list[float]]]:
        """
        Return the points that are in an impossible state now, by the counter of it: how many, and the corners of a box around them, m.
        """

    def max_compression(self) -> float:
        """Return the largest rho/rho0 of any point so far."""

    @property
    def sorts(self) -> int:
        """How often the points were sorted by cell."""

    @property
    def sleeping_points(self) -> int:
        """Points that steps pass over, for they and all around them are at rest."""

    def timers(self) -> dict[str, float]:
        """Return the seconds that each phase of the steps took."""

    def memory_bytes(self) -> dict[str, int]:
        """Return the bytes of points and of the grid."""

    def save(self) -> dict[str, Any]:
        """
        Return all that a step reads of the steps before it, by name; long arrays are views of the solver's memory.
        """

    def restore(self, parts: Mapping[str, Any]) -> None:
        """Take back what `save` returned, in a solver that never had points."""

def fields() -> list[dict[str, Any]]:
    """Return the fields of the points: name, components, unit, description."""

def build_info() -> dict[str, Any]:
    """
    Return the compiler, its flags, the instruction set, and what they allow.
    """

def supported_isas() -> list[str]:
    """
    Return the instruction sets that pockmark is built for and this processor has, the best first.
    """

def copy_bandwidth(threads: int) -> float:
    """Return the bytes read and written a second by copies of long arrays."""

DRIVER: str

def solver(
    *, single: bool, driver: str = ...
) -> type[Solver] | type[SolverSingle] | type[PlainSolver] | type[PlainSolverSingle]:
    """Return the class of the solvers of a precision and a driver, "cpu" or "plain"."""
