"""A simulation: the core's solver, stepped from event to event."""

import math
import numbers
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..base.errors import PockmarkError, found
from ..scene.scene import Scene
from .points import make_points
from .task import Task, require_tasks


class Simulation:
    """The state of a scene as it is stepped.

    What is returned of its points are copies in SI, in the core's present order.
    """

    def __init__(
        self,
        scene: Scene,
        threads: int | None = None,
        *,
        parts: Mapping[str, Any] | None = None,
        driver: str = _core.DRIVER,
        sleep: bool = True,
    ) -> None:
        """Make the points and the grid, or restore the `parts` that another simulation of the scene has saved.

        `threads` None takes every core. `driver="plain"` steps a point at a time on one thread: the reference.
        `sleep=False` steps what is at rest, too, with the same result. Raises PockmarkError for a body without
        points, for too many threads, and for parts that do not fit.
        """
        self.scene = scene
        self.threads = thread_count(threads)
        self.end_time = scene.end_time  # s, at which the run ends
        self.acted: list[int] = []  # how often each task of the run has acted
        self.stepping_seconds = 0.0
        self.point_steps = 0
        self._solver = _make_solver(scene, self.threads, driver, sleep=sleep)
        if parts is None:
            self._solver.reserve(sum(scene.count(body) for body in scene.body))
            for piece in make_points(scene):
                self._solver.add_points(piece.position, piece.velocity, piece.mass, piece.volume, piece.body)
            self._solver.initialize()
            return
        try:
            self._solver.restore(parts)
        except ValueError as error:
            raise PockmarkError(f"what was saved does not fit the scene: {error}") from None

    def save(self) -> dict[str, Any]:
        """Return all that a step reads of the steps before it: numbers, and arrays (n,).

        Long arrays are views of the solver's memory. A simulation of the same scene that is made of these parts goes
        on as this one does, to the last bit, on any number of threads.
        """
        return dict(self._solver.save())

    @property
    def time(self) -> float:
        """Return the simulated time, s."""
        return float(self._solver.time)

    @property
    def steps(self) -> int:
        """Return the number of steps done."""
        return int(self._solver.cycle)

    @property
    def points(self) -> int:
        """Return the number of material points in the grid."""
        return int(self._solver.points)

    @property
    def rate(self) -> float:
        """Return the particle-steps a second of stepping; 0 before the first step."""
        return self.point_steps / self.stepping_seconds if self.stepping_seconds > 0 else 0.0

    def field(self, name: str) -> NDArray[Any]:
        """Return a field of the points, (n,) or (n, components), SI. `field_names` has the names."""
        return np.asarray(self._solver.field(name))

    def set_field(self, name: str, values: NDArray[Any]) -> None:
        """Change a field of the points, in SI and in the shape and order in which `field` returns it.

        What the ledger calls initial stays what the scene began with. Raises ValueError for an unknown name, for
        another number of values, and for `position`.
        """
        self._solver.set_field(name, np.ascontiguousarray(values, dtype=np.float64))

    def volume_fraction(self, bodies: Sequence[int]) -> NDArray[np.float32]:
        """Return the share of the space around each node that the points of some bodies fill.

        The array has cells + 3 nodes along each axis: those of the grid, and one beyond each face. At a face only
        half of the space can be filled.
        """
        return np.asarray(self._solver.volume_fraction([i in bodies for i in range(len(self.scene.body))]))

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """Return all fields of all points, by their names."""
        return {name: self.field(name) for name in field_names()}

    def ledger(self) -> dict[str, float]:
        """Return the ledger: where energy (J), momentum (kg m/s) and mass (kg) are."""
        return dict(self._solver.ledger())

    def counters(self) -> dict[str, int]:
        """Return how often each clamp, floor and loss has happened."""
        return dict(self._solver.counters())

    def impossible(self) -> dict[str, tuple[int, list[float], list[float]]]:
        """Return the points that are in an impossible state now, by the names of the counters.

        Each value holds how many they are, and the lower and the upper corner of a box around them, m.
        """
        return dict(self._solver.impossible())

    def timers(self) -> dict[str, float]:
        """Return the seconds spent in each phase of the step."""
        return dict(self._solver.timers())

    @property
    def sorts(self) -> int:
        """Return how often the points were put in the order of the cells."""
        return int(self._solver.sorts)

    @property
    def sleeping_points(self) -> int:
        """Return the number of points that a step passes over, because nothing near them has moved yet."""
        return int(self._solver.sleeping_points)

    def memory(self) -> dict[str, int]:
        """Return the bytes of the points and of the grid."""
        return dict(self._solver.memory_bytes())

    @property
    def max_compression(self) -> float:
        """Return the largest rho/rho0 of any point so far."""
        return float(self._solver.max_compression())

    def advance(self, end_time: float, max_steps: int = 2**62, pause: float = math.inf) -> int:
        """Step until `end_time` (s) or `pause` (s), at most `max_steps` times. Return the number of steps done.

        The end is hit exactly. The pause is hit or passed.
        """
        start = time.perf_counter()
        points = self.points
        steps = int(self._solver.advance(max_steps=max_steps, end_time=end_time, pause=pause))
        self.stepping_seconds += time.perf_counter() - start
        self.point_steps += points * steps
        return steps

    def run(
        self,
        tasks: Sequence[Task] = (),
        end_time: float | None = None,
        watch: Callable[["Simulation"], None] | None = None,
        acted: Sequence[int] | None = None,
    ) -> None:
        """Step to the end, and let each task act at its times.

        The end, and the times of `exact` tasks, are hit exactly. `end_time` (s) may be another than the scene's.
        `watch` is called every second or so, and must change nothing. `acted` says how often each task has acted
        before, in a run that goes on. KeyboardInterrupt comes through between steps. Raises PockmarkError where the
        end is no finite time, and for what is no task.
        """
        require_tasks(tasks)
        end = self.scene.end_time if end_time is None else end_time
        if not math.isfinite(end):
            raise PockmarkError(f"end_time: {found(end)}, expected a finite time in s")
        end = self.end_time = rounded_time(end)
        counts = self.acted = [*acted] if acted else [0] * len(tasks)
        while True:
            for i, task in enumerate(tasks):
                if self.time >= min(rounded_time(counts[i] * task.interval), end):
                    task.act(self)
                    counts[i] += 1
            if self.time >= end:
                return
            due = [
                (rounded_time(n * task.interval), task.exact) for n, task in zip(counts, tasks, strict=True)
            ]
            target = min([end, *(time for time, exact in due if exact)])
            pause = min([end, *(time for time, exact in due if not exact)])
            while self.time < min(target, pause):
                # Few steps a call, so that Ctrl-C is heard within a second or so.
                self.advance(target, max_steps=max(1, 2_000_000 // max(self.points, 1)), pause=pause)
                if watch:
                    watch(self)


def rounded_time(time_s: float) -> float:
    """Return a time (s) in twelve digits: so the third multiple of 20 ns is 60 ns, and no step is a sliver between the two."""
    return float(f"{time_s:.12g}")


def core_name() -> str:
    """Return what computes: the instruction set and the driver. Another one differs in the last digits."""
    return f"{_core.build_info()['isa']}, {_core.DRIVER} driver"


def thread_count(asked: int | None) -> int:
    """Return the number of threads to use: every core for 0 or None.

    Raises PockmarkError for more than four a core, which would only be in each other's way.
    """
    cores = len(os.sched_getaffinity(0))
    most = 4 * cores
    if not (asked is None or isinstance(asked, numbers.Integral)) or not 0 <= (asked or 0) <= most:
        raise PockmarkError(
            f"threads: found {asked}, allowed are 1 to {most} (four a core), and 0 for every core"
        )
    return asked or cores


class LiveFields(Mapping[str, NDArray[Any]]):
    """The fields of a simulation as they are now. Each is copied when it is asked for."""

    def __init__(self, simulation: Simulation) -> None:
        """Wrap a simulation, which must not step while its fields are read."""
        self._simulation = simulation

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return a field by its name. Raises KeyError for no name of a field."""
        if name not in field_names():
            raise KeyError(name)
        return self._simulation.field(name)

    def __iter__(self) -> Iterator[str]:
        """Return the names of the fields."""
        return iter(field_names())

    def __len__(self) -> int:
        """Return the number of fields."""
        return len(field_names())


def field_names() -> list[str]:
    """Return the names of all point fields, `body` and `id` included."""
    return [*(f["name"] for f in _core.fields()), "body", "id"]


def _make_solver(scene: Scene, threads: int, driver: str, *, sleep: bool) -> Any:
    """Return the core's solver of a scene, without points."""
    numerics = scene.numerics
    solver = _core.solver(single=numerics.precision == "single", driver=driver)(
        lower=scene.grid.lower,
        cell=scene.grid.cell,
        cells=scene.grid.cells,
        faces=[getattr(_core.Face, kind) for kind in scene.boundary.faces],
        materials=[scene.materials[b.material].to_core() for b in scene.body],
        options=_core.Options(
            scheme=getattr(_core.Scheme, numerics.scheme),
            shape=getattr(_core.ShapeFunction, numerics.shape_functions),
            volumetric_strain=getattr(_core.VolumetricStrain, numerics.volumetric_strain),
            node_velocity=getattr(_core.AtNodes, numerics.node_velocity),
            cfl=numerics.cfl,
            strain_limit=numerics.strain_limit,
            pic_fraction=numerics.pic_fraction,
            filter_interval=numerics.filter.interval,
            filter_order=numerics.filter.order,
            pressure_filter=numerics.filter.pressure,
            mass_cutoff=numerics.mass_cutoff,
            sleep=sleep,
        ),
        threads=threads,
        axisymmetric=scene.grid.is_axisymmetric,
    )
    solver.let_fly([b.projectile or b.velocity is not None for b in scene.body])
    if scene.contact:
        solver.set_contact([b.projectile for b in scene.body], scene.contact.friction)
    return solver
