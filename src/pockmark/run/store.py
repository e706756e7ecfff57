"""The run folder: scene.toml, manifest.json, history.csv and snapshot-NNNN.vtkhdf files that ParaView opens."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError
from ..base.files import AnyPath, as_path, make_folder, numbered, read_text, remove, told, write_text
from ..base.json import to_json
from ..base.toml import parse_toml
from ..scene.identity import hash_of
from ..scene.scene import Scene
from .history import Rows, append_row, last_time, read_rows
from .lock import LOCK, Lock, holder
from .manifest import Measured, parse_manifest, row_as_record, validated
from .provenance import commit, machine, now
from .series import SERIES, Series
from .snapshot import FILE as SNAPSHOT
from .snapshot import Snapshot, write_snapshot

MANIFEST = "manifest.json"
HISTORY = "history.csv"
# What pockmark writes into a run folder: --force removes these and nothing else.
OWN_FILES = (
    "scene.toml",
    HISTORY,
    "snapshot-*.vtkhdf",
    SERIES,
    "checkpoint-*.h5",
    "crater.png",
    "fields.png",
    "top.png",
    "history.png",
    "view.png",
    "view.gif",
    "view.mp4",
    "report.html",
    MANIFEST,
)
UNENDED = ("running", "killed")


class RunFolder:
    """A run on disk."""

    def __init__(self, path: AnyPath) -> None:
        """Wrap a path; nothing is touched. Raises PockmarkError for what cannot be a path."""
        self.path = as_path(path)
        self._lock: Lock | None = None
        self.series = Series(self.path)

    def __fspath__(self) -> str:
        """Return the path: a run folder may be given where a path is asked for."""
        return str(self.path)

    @classmethod
    def create(cls, path: AnyPath, scene: Scene, *, force: bool = False) -> "RunFolder":
        """Make the folder for a new run, and lock it until release().

        Raises PockmarkError if something else is there.
        """
        folder = cls(path)
        folder.require_free(force=force)
        make_folder(folder.path)
        folder.lock()
        try:
            folder.require_free(force=force)  # another process may have been and gone
            folder.clear()
            folder.write_manifest(_start(scene))  # first: killed now, it is a run that may be replaced
            write_text(folder.path / "scene.toml", scene.to_toml())
        except BaseException:
            folder.release()
            raise
        return folder

    @classmethod
    def open(cls, path: AnyPath) -> "RunFolder":
        """Open an existing run. Raises PockmarkError if it is none."""
        folder = cls(path)
        if not os.path.lexists(folder.path / MANIFEST):
            raise PockmarkError(f"{folder.path}: is not a run folder (it has no {MANIFEST})")
        folder.manifest()
        return folder

    def require_free(self, *, force: bool) -> None:
        """Raise PockmarkError unless a run may be written here.

        It may be written into an empty folder, and with `force` over a run that is over.
        """
        with told(self.path):
            if self.path.exists() and not self.path.is_dir():
                raise PockmarkError(f"{self.path}: is a file, expected a folder to write the run to")
            if not self.path.exists() or all(file.name == LOCK for file in self.path.iterdir()):
                return
        if not self._lock and (who := holder(self.path)):
            raise PockmarkError(f"{self.path}: {who} runs in it now")
        if not self.is_run():
            raise PockmarkError(f"{self.path}: is not empty and holds no run")
        if not force:
            raise PockmarkError(f"{self.path}: holds a run (--force replaces it)")

    def lock(self) -> None:
        """Keep other processes from running in the folder until release().

        Raises PockmarkError naming the one that runs in it.
        """
        self._lock = Lock(self.path)

    def release(self) -> None:
        """Let other processes run in the folder."""
        if self._lock:
            self._lock.release()
            self._lock = None

    def is_run(self) -> bool:
        """Return whether the folder holds a run of pockmark's, and not just some manifest.json."""
        try:
            RunFolder.open(self.path)
        except PockmarkError:
            return False
        return True

    def clear(self) -> None:
        """Remove what pockmark has written; other files stay."""
        self.clear_parts()  # first: a folder without a manifest is no run
        for pattern in OWN_FILES:
            for file in self.path.glob(pattern):
                remove(file)

    def clear_parts(self) -> None:
        """Remove what a process was writing when it was killed."""
        for pattern in OWN_FILES:
            for file in self.path.glob(f"{pattern}*.part"):
                remove(file)

    def scene(self) -> Scene:
        """Return the run's scene. Raises PockmarkError if scene.toml is not what the run was started with."""
        path = self.path / "scene.toml"
        table, known = parse_toml(read_text(path), path), self.manifest()
        # The title was part of the hash before the physics was counted.
        hashed = hash_of(table, titled=known.get("physics") is None)
        if hashed not in (known["scene_hash"], known.get("next_scene_hash")):
            raise PockmarkError(f"{path}: is not the scene of this run, whose hash {MANIFEST} has")
        return Scene.from_dict(table, source=str(path))

    def manifest(self) -> dict[str, Any]:
        """Return manifest.json as a dictionary. Raises PockmarkError if it is none of pockmark's."""
        path = self.path / MANIFEST
        text = read_text(path)
        try:
            return parse_manifest(text)
        except PockmarkError as error:
            raise PockmarkError(f"{path}: {error}") from None

    def status(self) -> str:
        """Return how the run stands: running, finished, interrupted, failed or killed.

        A killed run could not write that it was: its manifest says running, but nobody holds its lock.
        """
        status = str(self.manifest()["status"])
        return "killed" if status == "running" and holder(self.path) is None else status

    def live(self) -> tuple[str, float] | None:
        """Return who runs in the folder now, and the time that the run has reached, s; None if nobody does.

        Raises PockmarkError.
        """
        who = holder(self.path)
        return None if who is None else (who, last_time(self.path / HISTORY))

    def record(self, cells: int) -> Measured:
        """Return what the manifest says of the run's end.

        Of a run without an end it is what its last row says; `cells` is the number of the grid's cells. Raises
        PockmarkError.
        """
        ended = self.status() not in UNENDED
        table = self.manifest() if ended else row_as_record(self.rows().last, cells)
        try:
            return validated(Measured, table)
        except PockmarkError as error:
            raise PockmarkError(f"{self.path / (MANIFEST if ended else HISTORY)}: {error}") from None

    def write_manifest(self, table: Mapping[str, Any]) -> None:
        """Replace manifest.json in one go."""
        write_text(self.path / MANIFEST, to_json(table) + "\n")

    def change_end(self, scene: Scene) -> None:
        """Replace the scene by one that ends later.

        If this is killed at any moment, the folder holds one of the two.
        """
        known = self.manifest()
        earlier = [*known.get("earlier_scene_hashes", ()), known["scene_hash"]]
        self.write_manifest(known | {"next_scene_hash": scene.hash, "earlier_scene_hashes": earlier})
        write_text(self.path / "scene.toml", scene.to_toml())
        self.write_manifest(known | {"scene_hash": scene.hash, "earlier_scene_hashes": earlier})

    def append_history(self, row: Mapping[str, float]) -> None:
        """Add a row to history.csv. The first row writes the header."""
        append_row(self.path / HISTORY, row)

    def rows(self) -> Rows:
        """Return the rows of history.csv. Raises PockmarkError.

        A last row that is being written, or that was when the process was killed, is left out.
        """
        return read_rows(self.path / HISTORY, torn_end=self.status() in UNENDED)

    def history(self, *needed: str) -> dict[str, NDArray[np.float64]]:
        """Return the columns of history.csv. Raises PockmarkError if one of the `needed` is missing."""
        columns = self.rows().columns
        if missing := [name for name in needed if name not in columns]:
            raise PockmarkError(f"{self.path / HISTORY}: lacks the column {missing[0]}")
        return columns

    def snapshots(self) -> list[Path]:
        """Return the snapshot files in the order of time."""
        return list(numbered(self.path, SNAPSHOT))

    def write_snapshot(self, fields: Mapping[str, NDArray[Any]], time_s: float, step: int) -> Path:
        """Write all fields of all points as the next snapshot, and into the series. Return its file."""
        number = 1 + max(numbered(self.path, SNAPSHOT).values(), default=-1)
        path = self.path / f"snapshot-{number:04d}.vtkhdf"
        write_snapshot(path, fields, time_s, step, str(self.manifest()["scene_hash"]))
        self.series.note(path, time_s)
        return path

    def last_snapshot(self) -> Snapshot:
        """Return the last snapshot; of a killed run the last whole one. Raises PockmarkError."""
        found = self.snapshots()
        if not found:
            raise PockmarkError(f"{self.path}: holds no snapshot")
        if self.status() == "killed":
            for path in reversed(found):
                try:
                    Snapshot(path)
                except PockmarkError:  # it was being written
                    continue
                return self.snapshot(path)
        return self.snapshot(found[-1])

    def snapshot(self, path: Path) -> Snapshot:
        """Return one of the run's snapshots. Raises PockmarkError if it is none, or of another scene."""
        read = Snapshot(path)
        known = self.manifest()
        if read.scene_hash not in (None, known["scene_hash"], *known.get("earlier_scene_hashes", ())):
            raise PockmarkError(f"{path}: is a snapshot of another scene than this run's")
        return read


def _start(scene: Scene) -> dict[str, Any]:
    """Return the part of a run's manifest that is written at its start."""
    return {
        "status": "running",
        "pockmark": __version__,
        "physics": PHYSICS,
        "commit": commit(),
        "scene_hash": scene.hash,
        "started": now(),
        "machine": machine(),
        "options": scene.numerics.model_dump(),
    }
