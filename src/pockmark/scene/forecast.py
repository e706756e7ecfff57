"""The forecast of a run: its size, memory, disk and time, before it starts."""

import math
from dataclasses import dataclass, field
from pathlib import Path

from .. import _core
from .prospect import impact_rows
from .scene import Scene
from .warnings import cells_across, warnings

# Peak of the resident memory, measured (benchmarks/README.md, "Memory"). The core keeps numbers (8 or 4 bytes) and bytes:
NUMBERS_PER_POINT, BYTES_PER_POINT = 21, 22  # fields, the sort's scratch; body, id, cell, order, runs
NUMBERS_PER_NODE, BYTES_PER_NODE = 16, 4
# While a snapshot is written: the deviator as doubles, the effective stress and its terms.
BYTES_PER_POINT_WRITTEN = 72
BYTES_PER_POINT_MEASURED = 140  # when the core is gone: the fields that are read, and the crater's arrays
# Bytes: Python and the libraries; the same while a picture is drawn.
RUNNING, DRAWING = 148 * 2**20, 222 * 2**20
# On the disk, in a snapshot once everything moves; before, and where much stays at rest, it compresses to less.
BYTES_PER_POINT_KEPT = {"double": 82, "single": 69}
BYTES_PER_ROW = 520  # in the history
NUMBERS_IN_CHECKPOINT = 20  # for a point
BYTES_PER_SNAPSHOT, BYTES_OF_PICTURES = 40_000, 1_250_000
# Particle-steps a second a core, measured with the default scheme (benchmarks/README.md).
TYPICAL_RATE = {"avx512": 19e6, "avx2": 15e6, "scalar": 4e6}
CARRYING = 0.4  # steps more that one with velocities carried to the nodes takes


@dataclass(frozen=True)
class Forecast:
    """The figures that a run will have, as far as they are known before it starts."""

    points: int
    cells: int
    steps: int
    memory: float  # bytes: the peak of `pockmark run`, its measuring and drawing included
    disk: float  # bytes of the run folder, at most
    seconds: float
    cells_across: float | None  # how many cells lie across the smallest projectile
    impact: tuple[tuple[str, str], ...] = ()  # what hits, and how hard: names and values
    warnings: list[str] = field(default_factory=list)


def forecast(scene: Scene, threads: int) -> Forecast:
    """Return points, cells, steps, memory, disk and time that a scene will take, with warnings."""
    points = sum(scene.count(body) for body in scene.body)
    steps = math.ceil(scene.steps_about)
    slower = 2.8 if scene.numerics.shape_functions == "quadratic" else 1.0
    slower += 0.3 if scene.numerics.volumetric_strain == "cells" else 0.0
    slower += CARRYING if scene.numerics.node_velocity == "linear" else 0.0
    # Rings share a stencil with half as many others, so fewer lanes are filled (model 1 on cells of 1 um).
    slower *= 2.5 if scene.grid.is_axisymmetric else 1.0
    rate = TYPICAL_RATE[_core.build_info()["isa"]] * threads
    memory = _peak(scene, points)
    return Forecast(
        points=points,
        cells=scene.grid.cell_count,
        steps=steps,
        memory=memory,
        disk=_disk(scene, points),
        seconds=points * steps * slower / rate,
        cells_across=cells_across(scene),
        impact=tuple(impact_rows(scene)),
        warnings=warnings(scene) + _memory_warning(memory, available_memory()),
    )


def available_memory() -> float | None:
    """Return the memory that is free without swapping, bytes; None if the system does not tell."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    found = [line.split()[1] for line in lines if line.startswith("MemAvailable:")]
    return 1024.0 * float(found[0]) if found else None


def _peak(scene: Scene, points: int) -> float:
    """Return the largest resident memory, bytes.

    It is reached while a snapshot is written, or while the crater is measured and drawn.
    """
    number = 8 if scene.numerics.precision == "double" else 4
    nodes = scene.grid.node_count * (2 if scene.contact else 1)
    core = points * (NUMBERS_PER_POINT * number + BYTES_PER_POINT)
    by_cells = 4 if scene.numerics.volumetric_strain == "cells" else 0
    carried = 36 if scene.numerics.node_velocity == "linear" else 0
    core += nodes * ((NUMBERS_PER_NODE + by_cells + carried) * number + BYTES_PER_NODE)
    running = RUNNING + core + points * BYTES_PER_POINT_WRITTEN
    return max(running, DRAWING + points * BYTES_PER_POINT_MEASURED)


def _disk(scene: Scene, points: int) -> float:
    """Return the largest size of the run folder, bytes: no point leaves the grid, and everything moves from the start."""
    # Where the interval divides the end time, the last ones are those at the end.
    snapshots, rows = (
        1 + math.ceil(scene.end_time / interval - 1e-9)
        for interval in (scene.output.snapshots, scene.output.history)
    )
    kept = snapshots * (points * BYTES_PER_POINT_KEPT[scene.numerics.precision] + BYTES_PER_SNAPSHOT)
    if scene.output.checkpoints:  # the last one stays
        kept += points * (NUMBERS_IN_CHECKPOINT * (8 if scene.numerics.precision == "double" else 4) + 10)
    return kept + rows * BYTES_PER_ROW + BYTES_OF_PICTURES


def _memory_warning(needed: float, available: float | None) -> list[str]:
    """Say that memory is short, if it is."""
    if available is None or needed <= available:
        return []
    return [f"it needs {needed / 2**20:,.0f} MiB of memory, {available / 2**20:,.0f} MiB are free"]
