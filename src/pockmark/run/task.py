"""What a task is: an action that happens during a run."""

import math
import numbers
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from ..base.errors import PockmarkError, found

if TYPE_CHECKING:
    from .simulation import Simulation


@runtime_checkable
class Task(Protocol):
    """An action that happens during a run every `interval` seconds of simulated time."""

    interval: float
    exact: bool  # whether steps must end exactly at its times, which costs about a step each

    def act(self, simulation: "Simulation") -> None:
        """Act at time 0, at each multiple of the interval or with the first step beyond, and at the end."""


@runtime_checkable
class KeptTask(Task, Protocol):
    """A task with a state that a checkpoint keeps, such as JSON can hold."""

    def state(self) -> dict[str, Any]:
        """Return what the task needs to go on."""

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Take up a state, to go on from there."""


class _Stateless:
    """A task that needs no state to go on."""

    def __init__(self, task: Task) -> None:
        self.interval, self.exact, self.act = task.interval, task.exact, task.act

    def state(self) -> dict[str, Any]:
        """Return no state."""
        return {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Take up no state."""


def kept(task: Task) -> KeptTask:
    """Return a task as one that a checkpoint keeps."""
    return task if isinstance(task, KeptTask) else _Stateless(task)


def require_tasks(tasks: Sequence[Task]) -> None:
    """Raise PockmarkError for what is no task, or would act without an end."""
    for task in tasks:
        if not isinstance(task, Task):
            raise PockmarkError(f"tasks: {found(task)}, expected an object with interval, exact and act()")
        if not (isinstance(task.interval, numbers.Real) and 0 < task.interval < math.inf):
            raise PockmarkError(
                f"tasks: {found(task.interval)} as interval, expected a finite number of seconds above 0"
            )
