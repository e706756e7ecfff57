"""The lock of a run folder, so that one process at a time runs in it.

The process holds it while its run lasts. It ends with the process.
"""

import fcntl
import os
import platform
import re
import time
from pathlib import Path

from ..base.errors import PockmarkError
from ..base.files import open_regular, told

LOCK = "run.lock"
TRIES, PAUSE = 10, 0.05  # s; a process that looks whether the lock is held holds it for a moment itself


class Lock:
    """A folder's lock, held until release() or the end of the process."""

    def __init__(self, folder: Path) -> None:
        """Take the lock. Raises PockmarkError naming the process that holds it."""
        self._path = folder / LOCK
        for n in range(TRIES):
            if n:
                time.sleep(PAUSE)
            if (taken := self._take()) is not None:
                self._descriptor = taken
                break
        else:
            raise PockmarkError(f"{folder}: {holder(folder) or 'another process'} runs in it now")
        note = f"process {os.getpid()} on {platform.node()} since {time.strftime('%Y-%m-%dT%H:%M:%SZ', time.gmtime())}\n"
        with told(self._path):
            os.ftruncate(self._descriptor, 0)
            os.write(self._descriptor, note.encode())

    def release(self) -> None:
        """Remove the lock and give it up."""
        with told(self._path):
            self._path.unlink(missing_ok=True)
            os.close(self._descriptor)

    def _take(self) -> int | None:
        """Return the descriptor of the locked file, None if another process has it."""
        descriptor = open_regular(self._path, os.O_RDWR | os.O_CREAT)
        with told(self._path):
            if _flocked(descriptor, fcntl.LOCK_EX) and _is_at(descriptor, self._path):
                return descriptor
        os.close(descriptor)
        return None


def holder(folder: Path) -> str | None:
    """Return who runs in the folder now ("process 7 on host since ..."); None if nobody does."""
    path = folder / LOCK
    if not os.path.lexists(path):
        return None
    descriptor = open_regular(path, os.O_RDONLY)
    try:
        with told(path):
            if _flocked(descriptor, fcntl.LOCK_SH):
                return None
            note = os.read(descriptor, 200).decode(errors="replace")
    finally:
        os.close(descriptor)
    return (
        note.strip() if re.fullmatch(r"process \d+ on [\w.-]+ since [\d:TZ-]+\n", note) else "another process"
    )


def _flocked(descriptor: int, kind: int) -> bool:
    """Lock an open file, and return whether that was possible: another process may hold it."""
    try:
        fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _is_at(descriptor: int, path: Path) -> bool:
    """Return whether an open file is still the one at `path`: its last holder may have removed it."""
    try:
        return os.path.samestat(os.fstat(descriptor), os.lstat(path))
    except FileNotFoundError:
        return False
