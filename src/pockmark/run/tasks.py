"""The tasks of a run: history and snapshots; and the progress bar, which is none."""

import time
from collections.abc import Mapping
from typing import Any

from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from ..base.ledger import LEDGER
from ..base.lengths import in_metres
from .doubts import Doubts
from .live import live_depth
from .simulation import LiveFields, Simulation
from .store import RunFolder


class History:
    """The task that writes a row of history.csv every `interval` seconds, or with the first step after.

    A row has the ledger, the depth, the largest compression and the counters.
    """

    exact = False

    def __init__(self, folder: RunFolder, interval: float) -> None:
        """Set the interval, in seconds of simulated time."""
        self.folder, self.interval = folder, interval
        self.doubts = Doubts()
        self._written = -1.0

    def act(self, simulation: Simulation) -> None:
        """Write a row, if there is none of this time yet."""
        if simulation.time == self._written:
            return
        ledger = simulation.ledger()
        row = {"time": simulation.time, "step": float(simulation.steps), "points": float(simulation.points)}
        row |= {key: ledger[key] for key in LEDGER}
        row["depth"] = live_depth(simulation).depth
        row["max_compression"] = simulation.max_compression
        row |= {key: float(value) for key, value in simulation.counters().items()}
        self.doubts.note(simulation, row)
        self.folder.append_history(row)
        self._written = simulation.time

    def state(self) -> dict[str, Any]:
        """Return the time of the last row (s), and the doubts so far."""
        return {"written": self._written, "doubts": self.doubts.state()}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Take up a state, to go on after its row."""
        self._written = state["written"]
        self.doubts.set_state(state["doubts"])


class Snapshots:
    """The task that writes a VTKHDF file every `interval` seconds, exactly."""

    exact = True

    def __init__(self, folder: RunFolder, interval: float) -> None:
        """Set the interval, in seconds of simulated time."""
        self.folder, self.interval = folder, interval
        self._written = -1.0

    def act(self, simulation: Simulation) -> None:
        """Write all fields of all points, unless those of this time are written."""
        if simulation.time == self._written:
            return
        # Field by field: all at once would double the memory of the run.
        self.folder.write_snapshot(LiveFields(simulation), simulation.time, simulation.steps)
        self._written = simulation.time

    def state(self) -> dict[str, Any]:
        """Return the time of the last snapshot, s."""
        return {"written": self._written}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Take up a state, to go on after its snapshot."""
        self._written = state["written"]


class ProgressBar:
    """A line on the terminal: simulated time, rate, time left and depth."""

    def __init__(self, simulation: Simulation) -> None:
        """Start the bar at once; call close() at the end."""
        end = simulation.end_time
        self._shown = float("-inf")
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.fields[state]}"),
        )
        self._task = self._bar.add_task("impact", total=end, state="")
        self._bar.start()

    def watch(self, simulation: Simulation) -> None:
        """Show where the run is, once a second. It is no task, for it must not change the steps."""
        if time.monotonic() - self._shown < 1.0 and simulation.time < simulation.end_time:
            return
        self._shown = time.monotonic()
        live = live_depth(simulation)
        crater = "perforated" if live.is_perforated else f"depth about {in_metres(live.depth, 3)}"
        state = f"{simulation.time * 1e9:.1f} ns  {simulation.rate / 1e6:.2f} M particle-steps/s  {crater}"
        self._bar.update(self._task, completed=simulation.time, state=state)

    def close(self) -> None:
        """Leave the terminal as it was."""
        self._bar.stop()
