"""The series of a run's snapshots: one file by which ParaView and PyVista open them all, with a time axis in seconds."""

import json
from pathlib import Path

from ..base.errors import PockmarkError
from ..base.files import numbered, remove, write_text
from .snapshot import FILE, Snapshot

SERIES = "snapshots.vtkhdf.series"


class Series:
    """The series of a run folder, as it grows. It knows the times that it was told; others it reads once."""

    def __init__(self, folder: Path) -> None:
        """Begin without a time."""
        self._folder = folder
        self._times: dict[str, float | None] = {}

    def note(self, path: Path, time_s: float) -> None:
        """Note the time (s) of a new snapshot, and write the series."""
        self._times[path.name] = time_s
        self.write()

    def write(self) -> None:
        """Write what is there: a snapshot that cannot be read is left out. Without any there is no file."""
        times = [(path.name, self._time_of(path)) for path in numbered(self._folder, FILE)]
        files = [{"name": name, "time": time} for name, time in times if time is not None]
        if files:
            text = json.dumps({"file-series-version": "1.0", "files": files}, indent=1)
            write_text(self._folder / SERIES, f"{text}\n")
        else:
            remove(self._folder / SERIES)

    def _time_of(self, path: Path) -> float | None:
        """Return the time of a snapshot, s; None of one that cannot be read."""
        if path.name not in self._times:
            try:
                self._times[path.name] = float(Snapshot(path)["time"][0])
            except PockmarkError:
                self._times[path.name] = None
        return self._times[path.name]
