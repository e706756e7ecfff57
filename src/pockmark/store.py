"""The run folder: scene.toml, manifest.json, history.csv and snapshot-NNNN.vtkhdf files that ParaView opens."""

import csv
import json
import math
import os
import platform
import re
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import PockmarkError
from .scene import Scene

MANIFEST = "manifest.json"
HISTORY = "history.csv"
# What pockmark writes into a run folder: --force removes these and nothing else.
OWN_FILES = (
    "scene.toml",
    HISTORY,
    "snapshot-*.vtkhdf",
    "snapshot-*.part",
    "crater.png",
    "history.png",
    MANIFEST,
)


class RunFolder:
    """One run on disk."""

    def __init__(self, path: Path) -> None:
        """Wrap a path; nothing is touched."""
        self.path = path

    @classmethod
    def create(cls, path: str | Path, scene: Scene, *, force: bool = False) -> "RunFolder":
        """Make the folder for a new run. Raises PockmarkError if something else is there."""
        folder = cls(Path(path))
        with told(path):
            if folder.path.exists() and not folder.path.is_dir():
                raise PockmarkError(f"{path}: is a file, expected a folder to write the run to")
            if folder.path.exists() and any(folder.path.iterdir()):
                is_run = folder.is_run()
                if not (is_run and force):
                    what = "holds a run (--force replaces it)" if is_run else "is not empty and holds no run"
                    raise PockmarkError(f"{path}: {what}")
                folder.clear()
            folder.path.mkdir(parents=True, exist_ok=True)
            scene.save(folder.path / "scene.toml")
            folder.write_manifest({"status": "running", "scene_hash": scene.hash})
        return folder

    @classmethod
    def open(cls, path: str | Path) -> "RunFolder":
        """Open an existing run. Raises PockmarkError if it is none."""
        folder = cls(Path(path))
        if not (folder.path / MANIFEST).is_file():
            raise PockmarkError(f"{path}: is not a run folder (it has no {MANIFEST})")
        if "scene_hash" not in folder.manifest():
            raise PockmarkError(f"{path}: is not a run folder (its {MANIFEST} is not pockmark's)")
        return folder

    def is_run(self) -> bool:
        """Whether the folder holds a run of pockmark's, and not just some manifest.json."""
        try:
            RunFolder.open(self.path)
        except PockmarkError:
            return False
        return True

    def clear(self) -> None:
        """Remove what pockmark wrote; files of the user's stay."""
        for pattern in OWN_FILES:
            for file in self.path.glob(pattern):
                file.unlink()

    def scene(self) -> Scene:
        """The scene of the run."""
        return Scene.load(self.path / "scene.toml")

    def manifest(self) -> dict[str, Any]:
        """manifest.json as a dictionary."""
        with told(self.path / MANIFEST):
            try:
                manifest = json.loads((self.path / MANIFEST).read_text(encoding="utf-8"))
            except ValueError as error:
                raise PockmarkError(f"{self.path / MANIFEST}: is not JSON ({error})") from None
        if not isinstance(manifest, dict):
            raise PockmarkError(f"{self.path / MANIFEST}: found no table, expected a manifest of pockmark's")
        return manifest

    def write_manifest(self, manifest: Mapping[str, Any]) -> None:
        """Replace manifest.json in one go."""
        with _replaced(self.path / MANIFEST) as part:
            part.write_text(to_json(manifest) + "\n", encoding="utf-8")

    def append_history(self, row: Mapping[str, float]) -> None:
        """Add a row to history.csv; the first one writes the header."""
        path = self.path / HISTORY
        with told(path):
            is_new = not path.exists()
            with path.open("a", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, fieldnames=list(row))
                if is_new:
                    writer.writeheader()
                writer.writerow(row)

    def history(self, *needed: str) -> dict[str, NDArray[np.float64]]:
        """Columns of history.csv. Raises PockmarkError if one that is `needed` is missing."""
        path = self.path / HISTORY
        with told(path), path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        try:
            columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
        except (IndexError, TypeError, ValueError):
            raise PockmarkError(f"{path}: is empty or torn, expected a number in each column") from None
        if missing := [name for name in needed if name not in columns]:
            raise PockmarkError(f"{path}: lacks the column {missing[0]}")
        return columns

    def snapshots(self) -> list[Path]:
        """Snapshot files in the order of time."""
        return sorted(self.path.glob("snapshot-*.vtkhdf"))

    def write_snapshot(self, fields: Mapping[str, NDArray[Any]], time_s: float, step: int) -> Path:
        """Write all fields of all points as the next VTKHDF file."""
        path = self.path / f"snapshot-{len(self.snapshots()):04d}.vtkhdf"
        with _replaced(path) as part:
            try:
                with h5py.File(part, "w") as file:
                    _write_vtkhdf(file, fields, time_s, step)
            except (OSError, RuntimeError) as error:  # HDF5 tells a full disk as either
                raise PockmarkError(f"{path}: cannot be written ({_reason(error)})") from None
        return path

    def last_snapshot(self) -> "Snapshot":
        """Fields of the last snapshot. Raises PockmarkError if there is none."""
        found = self.snapshots()
        if not found:
            raise PockmarkError(f"{self.path}: holds no snapshot")
        return Snapshot(found[-1])


class Snapshot(Mapping[str, NDArray[Any]]):
    """The fields of a snapshot file, each read when it is first asked for; `time` is an array of one."""

    def __init__(self, path: Path) -> None:
        """Raises PockmarkError if the file is not a snapshot."""
        self._path = path
        self._read: dict[str, NDArray[Any]] = {}
        with self._root() as root:
            self._places = {name: f"PointData/{name}" for name in root["PointData"]}
        self._places |= {"position": "Points", "time": "FieldData/time"}

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A field by its name."""
        if name not in self._read:
            place = self._places[name]
            with self._root() as root:
                self._read[name] = np.asarray(root[place])
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter(self._places)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._places)

    @contextmanager
    def _root(self) -> Iterator[h5py.Group]:
        with told(self._path):
            try:
                with h5py.File(self._path, "r") as file:
                    yield file["VTKHDF"]
            except KeyError:
                raise PockmarkError(f"{self._path}: is not a snapshot of pockmark's") from None


def _write_vtkhdf(file: h5py.File, fields: Mapping[str, NDArray[Any]], time_s: float, step: int) -> None:
    """The points as an unstructured grid of vertices (VTKHDF 2.2)."""
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = (2, 2)
    root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
    n = len(fields["position"])
    for name, count in (("NumberOfPoints", n), ("NumberOfCells", n), ("NumberOfConnectivityIds", n)):
        root.create_dataset(name, data=np.array([count], dtype=np.int64))
    root.create_dataset("Points", data=fields["position"])
    root.create_dataset("Connectivity", data=np.arange(n, dtype=np.int64), compression=1, shuffle=True)
    root.create_dataset("Offsets", data=np.arange(n + 1, dtype=np.int64), compression=1, shuffle=True)
    root.create_dataset("Types", data=np.full(n, 1, dtype=np.uint8), compression=1, shuffle=True)
    data = root.create_group("PointData")
    for name in fields:
        if name == "position":
            continue
        values = fields[name]  # asked for once: the fields of a simulation are copies
        data.create_dataset(name, data=values)
        if name == "deviator":
            data.create_dataset("effective_stress", data=effective_stress(values))
    extra = root.create_group("FieldData")
    extra.create_dataset("time", data=np.array([time_s]))
    extra.create_dataset("step", data=np.array([step], dtype=np.int64))


def effective_stress(deviator: NDArray[np.float64]) -> NDArray[np.float64]:
    """von Mises effective stress (n,) of deviators (n, 6) in the order xx, yy, zz, xy, yz, zx, Pa."""
    twice = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # off the diagonal each component stands twice in s:s
    return np.asarray(np.sqrt(1.5 * np.einsum("ij,ij,j->i", deviator, deviator, twice)))


def machine() -> dict[str, Any]:
    """The machine and the build: processor, cores, compiler."""
    model = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    return {
        "processor": model,
        "cores": os.cpu_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "build": dict(_core.build_info()),
    }


def commit() -> str | None:
    """The git commit of the pockmark tree around this file ("-dirty" if its code changed since), or None."""
    # A virtual environment inside somebody's own repository must not give that repository's commit.
    if _git("ls-files", "--error-unmatch", ":/src/pockmark/store.py") is None:
        return None
    head = _git("rev-parse", "HEAD")
    changed = _git("status", "--porcelain", "--", ":/src", ":/core", ":/CMakeLists.txt")
    return f"{head}-dirty" if head and changed else head


def _git(*arguments: str) -> str | None:
    """Output of git in this file's folder, None if it fails or there is no git."""
    try:
        out = subprocess.run(
            ["git", *arguments],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return out.stdout.strip() if out.returncode == 0 else None


def now() -> str:
    """UTC, ISO 8601."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())


def finite(value: Any) -> Any:
    """The value, with None for what is no number (nan, inf) anywhere in its tables and lists: JSON has no word for it."""
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def to_json(value: Any) -> str:
    """JSON that every reader reads."""
    return json.dumps(finite(value), indent=2, allow_nan=False)


@contextmanager
def told(path: str | Path) -> Iterator[None]:
    """Turn a failure of the system into one sentence about `path`."""
    try:
        yield
    except OSError as error:
        raise PockmarkError(f"{path}: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """What the system says, on one line; HDF5 hides its number in the middle of a message."""
    if number := re.search(r"errno = (\d+)", str(error)):
        return os.strerror(int(number[1]))
    return (isinstance(error, OSError) and error.strerror) or " ".join(str(error).split())


@contextmanager
def _replaced(path: Path) -> Iterator[Path]:
    """Write a file under another name first, so that a failure leaves the old one whole."""
    part = path.with_name(path.name + ".part")
    with told(path):
        try:
            yield part
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
