"""Damaged run folders: a good one, in which the seed alone decides what is broken."""

import json
import os
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

FILES = ("manifest.json", "history.csv", "scene.toml", "snapshot")
# What every measure reads.
READ = ("VTKHDF/Points", "VTKHDF/PointData/volume", "VTKHDF/PointData/body", "VTKHDF/FieldData/time")
DATASETS = (*READ, "VTKHDF/PointData/deviator", "VTKHDF/PointData/pressure", "VTKHDF/PointData/velocity")
OUTSIDE = "outside"  # beside the run folder: nothing may be read from there, nothing written
JSON_VALUES: list[Any] = [
    None,
    [],
    {},
    "x",
    -1,
    1e308,
    True,
    "\x1b[31m",
    [[]],
    "x" * 100_000,
    10**30,
    [1, 2],
    {"a": {}},
]
CELLS = ("", "x", "nan", "-inf", "1e400", "\x00", "9" * 200_000, '"', "1,5", "\x1b[1m")


@dataclass(frozen=True)
class Damage:
    """What was done to a folder, and whether it must be refused."""

    text: str
    refused: bool = False


def damage(seed: int, folder: Path) -> Damage:
    """Break a run folder in the way of this seed. The files that lie OUTSIDE of it are made, too."""
    rng = random.Random(f"folder {seed}")
    folder = folder.resolve()  # links must not depend on where they are read from
    outside = folder.parent / OUTSIDE
    outside.mkdir()
    (outside / "text").write_bytes(b"somebody's\n")
    return rng.choices((_file, _manifest, _history, _scene, _dataset, _link), (4, 3, 2, 1, 5, 2))[0](
        rng, folder
    )


def _path(folder: Path, name: str) -> Path:
    """Return the file, the last one of the snapshots."""
    return sorted(folder.glob("snapshot-*"))[-1] if name == "snapshot" else folder / name


def _file(rng: random.Random, folder: Path) -> Damage:
    """Break any file as a whole."""
    path = _path(folder, rng.choice(FILES))
    old = path.read_bytes()
    kind = rng.choice(
        ("truncated", "flipped", "flipped", "empty", "deleted", "folder", "fifo", "loop", "zeros", "twice")
    )
    path.unlink()
    if kind == "folder":
        path.mkdir()
    elif kind == "fifo":
        os.mkfifo(path)
    elif kind == "loop":
        path.symlink_to(path.name)
    elif kind != "deleted":
        path.write_bytes(BROKEN[kind](rng, old))
    return Damage(f"{path.name} {kind}", refused=kind in ("fifo", "loop"))


def _flipped(rng: random.Random, data: bytes) -> bytes:
    """Return the bytes with up to 20 bits changed, half of them where the file says what it holds."""
    new = bytearray(data)
    for _ in range(rng.randint(1, 20)):
        new[rng.randrange(min(len(new), rng.choice((3000, len(new)))))] ^= 1 << rng.randrange(8)
    return bytes(new)


BROKEN: dict[str, Callable[[random.Random, bytes], bytes]] = {
    "truncated": lambda rng, data: data[: rng.randrange(len(data))],
    "flipped": _flipped,
    "empty": lambda _, data: b"",
    "zeros": lambda _, data: bytes(len(data)),
    "twice": lambda _, data: data + data,
}


def _manifest(rng: random.Random, folder: Path) -> Damage:
    """Put another value somewhere into the manifest, or another text in its place."""
    path = folder / "manifest.json"
    if rng.random() < 0.2:
        text = rng.choice(
            ("[" * 10_000, '{"a":' * 10_000, "[1, 2]", "null", '"x"', "{}", "1e999", "[" + "9" * 5000 + "]")
        )
        path.write_text(text)
        return Damage(f"manifest.json is {text[:20]!r}", refused=True)
    manifest = json.loads(path.read_text())
    holder, name = manifest, "manifest.json"
    while True:
        key = rng.choice(list(holder))
        name += f".{key}"
        if not isinstance(holder[key], dict) or not holder[key] or rng.random() < 0.3:
            break
        holder = holder[key]
    if rng.random() < 0.2:
        del holder[key]
    else:
        holder[key] = rng.choice(JSON_VALUES)
        name += f" = {str(holder[key])[:20]!r}"
    path.write_text(json.dumps(manifest))
    return Damage(name)


def _history(rng: random.Random, folder: Path) -> Damage:
    """Put another text into a cell of the history, or lose a part of it."""
    path = folder / "history.csv"
    rows = [line.split(",") for line in path.read_text().splitlines()]
    kind = rng.choice(("cell", "cell", "cell", "column", "row", "longer", "twice"))
    row, column = rng.randrange(len(rows)), rng.randrange(len(rows[0]))
    if kind == "cell":
        rows[row][column] = rng.choice(CELLS)
    elif kind == "column":
        rows = [[*cells[:column], *cells[column + 1 :]] for cells in rows]
    elif kind == "row":
        del rows[row:]
    elif kind == "longer":
        rows[row] += ["1"] * 3
    else:
        rows[0] = [rows[0][column]] * len(rows[0])
    path.write_text("\n".join(map(",".join, rows)) + "\n")
    return Damage(f"history.csv {kind} {row} {column}")


def _scene(rng: random.Random, folder: Path) -> Damage:
    """Change the scene to another valid one: the manifest keeps the hash of what was run."""
    path = folder / "scene.toml"
    text = path.read_text()
    old, new = rng.choice(
        (
            ("speed = 2200.0", "speed = 1100.0"),
            ("angle = 0.0", "angle = 0.1"),
            ("density = 27", "density = 37"),
        )
    )
    assert old in text, f"{old} is not in the run's scene"
    path.write_text(text.replace(old, new))
    return Damage(f"scene.toml: {new}", refused=True)


def _dataset(rng: random.Random, folder: Path) -> Damage:
    """Put something else in the place of a dataset of the last snapshot."""
    path, name, kind = (
        _path(folder, "snapshot"),
        rng.choice(DATASETS),
        rng.choice((*DATA, *["elsewhere"] * 6)),
    )
    outside = folder.parent / OUTSIDE / "data.h5"
    with h5py.File(path, "r+") as file:
        old = file[name][...]
        del file[name]
        if kind == "elsewhere":
            kind = rng.choice(list(ELSEWHERE))
            ELSEWHERE[kind](file, name, old, outside)
            return Damage(f"{name} by {kind}", refused=name in READ)
        if (new := DATA[kind](rng, old)) is not None:
            file[name] = new
    return Damage(f"{name} {kind}", refused=name in READ and kind in ("deleted", "text", "group"))


def _spoilt(rng: random.Random, old: Any, value: float) -> Any:
    new = old.astype(float)
    new.reshape(-1)[rng.randrange(new.size) :: rng.choice((1, 7, new.size))] = value
    return new


DATA: dict[str, Callable[[random.Random, Any], Any]] = {
    "deleted": lambda rng, old: None,
    "short": lambda rng, old: old[: len(old) // 2],
    "none": lambda rng, old: old[:0],
    "flat": lambda rng, old: old.reshape(-1),
    "turned": lambda rng, old: old.T,
    "deeper": lambda rng, old: old[None],
    "one": lambda rng, old: old.reshape(-1)[0],
    "text": lambda rng, old: b"text",
    "complex": lambda rng, old: old + 1j,
    "whole": lambda rng, old: np.asarray(old).astype("i8"),
    "nan": lambda rng, old: _spoilt(rng, old, np.nan),
    "infinite": lambda rng, old: _spoilt(rng, old, np.inf),
    "huge": lambda rng, old: _spoilt(rng, old, 1e300),
    "negative": lambda rng, old: -np.asarray(old).astype(float) - 1,
    "same": lambda rng, old: np.zeros_like(old),
}


def _external(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    with h5py.File(outside, "w") as other:
        other["data"] = old
    file[name] = h5py.ExternalLink(outside, "data")


def _storage(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    outside.write_bytes(old.tobytes())
    place = [(str(outside), 0, h5py.h5f.UNLIMITED)]
    file.create_dataset(name, shape=old.shape, dtype=old.dtype, external=place)


def _virtual(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    with h5py.File(outside, "w") as other:
        other["data"] = old
    layout = h5py.VirtualLayout(shape=old.shape, dtype=old.dtype)
    layout[...] = h5py.VirtualSource(str(outside), "data", shape=old.shape)
    file.create_virtual_dataset(name, layout)


def _nowhere(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    file[name] = h5py.SoftLink("/nowhere")


def _circle(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    file[name] = h5py.SoftLink(f"/{name}")


def _group(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    file.create_group(name)


def _vast(file: h5py.File, name: str, old: Any, outside: Path) -> None:
    file.create_dataset(name, shape=(10**12, *old.shape[1:]), dtype=old.dtype, chunks=(1000, *old.shape[1:]))


ELSEWHERE: dict[str, Callable[[h5py.File, str, Any, Path], None]] = {
    "external link": _external,
    "external storage": _storage,
    "virtual dataset": _virtual,
    "soft link to nowhere": _nowhere,
    "soft link to itself": _circle,
    "group": _group,
    "a shape of 1e12": _vast,
}


def _link(rng: random.Random, folder: Path) -> Damage:
    """Put a symbolic link to a file outside in the place of what pockmark writes or reads."""
    name = rng.choice((*("crater.png", "history.png", "crater.png.part", "manifest.json.part"), *FILES))
    path = _path(folder, name)
    target = folder.parent / OUTSIDE / "text"
    if name in FILES:
        target = target.with_name(path.name)
        path.rename(target)
    path.unlink(missing_ok=True)
    path.symlink_to(target)
    return Damage(f"{name} is a link to outside")
