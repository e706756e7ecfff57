"""Files of a run folder, opened with distrust.

Each must be what it should be: a regular file of a sane size. What a link points to is never opened.
"""

import errno
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import PockmarkError, found

LARGEST_TEXT = 2**20  # bytes of a manifest or a scene of a run folder; theirs are kilobytes
AnyPath = str | os.PathLike[str]


def as_path(value: AnyPath) -> Path:
    """Return what a user gives as a path. Raises PockmarkError for what cannot be one."""
    try:
        path = Path(value)
    except TypeError:
        raise PockmarkError(f"{found(value)}, expected a path") from None
    if "\0" in str(path):
        raise PockmarkError(f"{path}: is no path, for it has a NUL character")
    return path


def open_regular(path: Path, flags: int, *, follow: bool = False) -> int:
    """Return a descriptor of a regular file.

    Raises PockmarkError at once for anything else. A link is something else, unless `follow` allows it.
    """
    try:
        # A pipe without a writer would keep a plain open() waiting.
        descriptor = os.open(
            path, flags | os.O_NONBLOCK | os.O_CLOEXEC | (0 if follow else os.O_NOFOLLOW), 0o666
        )
    except OSError as error:
        if error.errno in (errno.ELOOP, errno.ENXIO, errno.EISDIR):
            raise PockmarkError(f"{path}: is no regular file ({_what(path, follow)})") from None
        raise PockmarkError(
            f"{path}: cannot be read ({reason(error)})" if follow else f"{path}: {reason(error)}"
        ) from None
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise PockmarkError(f"{path}: is no regular file ({_what(path, follow)})")
    return descriptor


def read_text(path: Path, *, largest: int = LARGEST_TEXT, follow: bool = False) -> str:
    """Return a short file's text, UTF-8.

    Raises PockmarkError for more than `largest` bytes, for what is no text, and for what is no regular file.
    """
    with told(path), open(open_regular(path, os.O_RDONLY, follow=follow), "rb") as file:
        read = file.read(largest + 1)
    if len(read) > largest:
        raise PockmarkError(f"{path}: has more than {largest:,} bytes, which no file of pockmark's needs")
    try:
        return read.decode()
    except UnicodeDecodeError:
        raise PockmarkError(f"{path}: is not a text file") from None


@contextmanager
def replaced(path: Path) -> Iterator[int]:
    """Give the descriptor of a new file that takes the place of `path` at the end.

    A failure leaves the old file whole. A link at `path` is replaced, not followed.
    """
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    with told(path):
        part.unlink(missing_ok=True)  # of a process of the same number that was killed
        descriptor = os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            yield descriptor
            part.replace(path)
        finally:
            os.close(descriptor)
            part.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Replace a file by a text in one go. Raises PockmarkError."""
    write_bytes(path, text.encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Replace a file by a content in one go. Raises PockmarkError."""
    with replaced(path) as descriptor, open(descriptor, "wb", closefd=False) as file:
        file.write(content)


def cut_off(path: Path, size: int) -> None:
    """Remove what a file has beyond `size` bytes. Raises PockmarkError."""
    with told(path), open(open_regular(path, os.O_WRONLY), "wb", buffering=0) as file:
        file.truncate(size)


def remove(path: Path) -> None:
    """Remove a file, if it is there. Raises PockmarkError."""
    with told(path):
        path.unlink(missing_ok=True)


def numbered(folder: Path, name: re.Pattern[str]) -> dict[Path, int]:
    """Return the paths in a folder whose names match, with the number that is the pattern's group, in its order.

    Raises PockmarkError.
    """
    with told(folder):
        found = {path: int(match[1]) for path in folder.iterdir() if (match := name.fullmatch(path.name))}
    return dict(sorted(found.items(), key=lambda entry: entry[1]))


@contextmanager
def told(path: str | Path) -> Iterator[None]:
    """Turn a failure of the system into a PockmarkError of one sentence about `path`."""
    try:
        yield
    except OSError as error:
        raise PockmarkError(f"{path}: {reason(error)}") from None


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, unless they are there. Raises PockmarkError, also for a file in their place."""
    with told(path):
        try:
            path.mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            file = next(one for one in (path, *path.parents) if one.exists() or one.is_symlink())
            raise PockmarkError(f"{file}: is {_what(file, True)}, expected a folder") from None


def reason(error: Exception) -> str:
    """Return on one line what the system says. HDF5 hides the error's number in the middle of a message."""
    if number := re.search(r"errno = (\d+)", str(error)):
        return os.strerror(int(number[1]))
    return (isinstance(error, OSError) and error.strerror) or " ".join(str(error).split())


def _what(path: Path, follow: bool) -> str:
    """Return the name of the kind of thing at a path."""
    try:
        mode = os.stat(path, follow_symlinks=follow).st_mode
    except OSError:
        return "a link to itself"
    kinds = {
        stat.S_IFLNK: "a symbolic link, which is not followed",
        stat.S_IFDIR: "a folder",
        stat.S_IFREG: "a file",
        stat.S_IFIFO: "a pipe",
        stat.S_IFSOCK: "a socket",
    }
    return kinds.get(stat.S_IFMT(mode), "a device")
