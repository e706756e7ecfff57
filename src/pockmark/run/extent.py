"""How far the files of a run folder are at a checkpoint, and the way back to there."""

import os
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..base.errors import PockmarkError
from ..base.files import cut_off, numbered, open_regular, remove, told
from .snapshot import FILE as SNAPSHOT
from .store import HISTORY, RunFolder

NOTHING: Mapping[str, Any] = {"history": 0, "history_sum": 0, "snapshots": []}  # of a run that has just begun


def extent_of(folder: RunFolder) -> dict[str, Any]:
    """Return the bytes of history.csv, their check sum, and the numbers of the snapshots, once they are on the disk."""
    history = folder.path / HISTORY
    extent = dict(NOTHING)
    if history.exists():
        content = _on_disk(history)
        extent |= {"history": len(content), "history_sum": zlib.crc32(content)}
    extent["snapshots"] = [*numbered(folder.path, SNAPSHOT).values()]
    return extent


def require_extent(folder: RunFolder, extent: Mapping[str, Any]) -> None:
    """Raise PockmarkError if history.csv has lost or altered what it had then: the run goes on with its rows."""
    history = folder.path / HISTORY
    content = _on_disk(history) if history.exists() else b""
    if len(content) < extent["history"]:
        raise PockmarkError(f"{history}: has lost what was there at the checkpoint")
    if zlib.crc32(content[: extent["history"]]) != extent["history_sum"]:
        raise PockmarkError(f"{history}: is not what it was at the checkpoint (its check sum differs)")


def lacking(folder: RunFolder, extent: Mapping[str, Any]) -> list[str]:
    """Return a sentence for snapshots that were there: nothing is computed from them, but they will be missed."""
    there = numbered(folder.path, SNAPSHOT).values()
    if lost := [number for number in extent["snapshots"] if number not in there]:
        return [
            f"{folder.path}: has lost snapshot {', '.join(map(str, lost[:10]))}, which no resume brings back"
        ]
    return []


def cut_back(folder: RunFolder, extent: Mapping[str, Any]) -> None:
    """Remove what was written since the files were as far as `extent`."""
    folder.clear_parts()
    history = folder.path / HISTORY
    if history.exists():
        cut_off(history, extent["history"])
    for path, number in numbered(folder.path, SNAPSHOT).items():
        if number not in extent["snapshots"]:
            remove(path)
    folder.series.write()


def _on_disk(path: Path) -> bytes:
    """Return the content of a file, once it is on the disk."""
    descriptor = open_regular(path, os.O_RDONLY)
    with told(path), open(descriptor, "rb") as file:
        os.fsync(descriptor)
        return file.read()
