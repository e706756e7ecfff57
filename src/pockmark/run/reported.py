"""The way from run folders to what their pages show."""

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .. import PHYSICS, __version__
from ..base.errors import PockmarkError, shown
from ..base.files import AnyPath, read_text
from ..base.geometry import Setup
from ..base.ledger import LEDGER, SHARES
from ..base.lengths import in_metres
from ..metrology.measures import UNWARNED
from ..metrology.mesh import meshes
from ..scene.prospect import impact_rows
from ..scene.scene import Scene
from ..scene.sheet import constants
from ..scene.warnings import is_too_coarse
from ..view.crater3d import View3d, view_3d
from ..view.images import frame, gif, png
from ..view.many import energy_figure
from ..view.page import Energy, MaterialSheet, Rows, RunReport
from ..view.plots import slice_figure
from ..view.quantities import present
from ..view.report import parts
from .compared import compared
from .measured import in_the_grid, measure_run, standing_of, surface_in
from .pictures import PICTURE_DPI, figures_of, plot_process
from .setup import setup_of
from .snapshot import Snapshot
from .store import RunFolder

MOST_FRAMES = 20  # of an animation: more would make the page too large


@UNWARNED
def run_report(path: AnyPath) -> RunReport:
    """Return what the page of a run folder shows.

    Raises PockmarkError for what is no run folder, is damaged or has no snapshot.
    """
    folder = RunFolder.open(path)
    result, scene, manifest = measure_run(path), folder.scene(), folder.manifest()
    snapshot, setup = in_the_grid(folder.last_snapshot(), scene), setup_of(scene)
    view, no_view = _view(snapshot, setup)
    film, no_film = _film(folder, scene, setup)
    return RunReport(
        title=scene.title or folder.path.name,
        folder=folder.path.name,
        standing=standing_of(path) or f"{result['run']['status']} at {result['run']['time'] * 1e9:.4g} ns",
        cautions=cautions(manifest),
        doubts=result["doubts"],
        warnings=result["warnings"],
        parts=parts(result),
        compared=compared(scene, result),
        was_run=was_run(scene),
        materials=_materials(scene),
        energies=_energies(folder, scene, result["energy"]),
        pictures=_pictures(folder, result["energy"]),
        view=view,
        no_view=no_view,
        film=film,
        no_film=no_film,
        reproduced=_reproduced(manifest),
        command=_command(scene, folder.path.name, manifest),
        scene=read_text(folder.path / "scene.toml"),
    )


def slice_of(path: AnyPath) -> str:
    """Return the slice through the crater of a run folder as the address of a PNG. Raises PockmarkError."""
    return png(figures_of(path)["crater.png"](), PICTURE_DPI)


def cautions(manifest: Mapping[str, Any]) -> list[str]:
    """Say that a newer pockmark made a run, if that is so."""
    version, physics = manifest.get("pockmark") or "", manifest.get("physics") or 0
    if physics <= PHYSICS and _numbers(version) <= _numbers(__version__):
        return []
    return [
        f"the run was made by pockmark {version} (physics {physics}), which is newer than this one, {__version__} (physics {PHYSICS}): what "
        "is measured here may be wrong"
    ]


def was_run(scene: Scene) -> list[tuple[str, str]]:
    """Return what a scene computes, in rows for a reader."""
    rows = [*impact_rows(scene)]
    for i, body in enumerate(scene.body):
        what = "projectile" if i in scene.projectiles else "target"
        spacing = in_metres(body.spacing)
        rows.append(
            (f"{what} {shown(body.name, 60)}", f"{body.shape} of {body.material}, points {spacing} apart")
        )
    rows.append(("cells", f"{in_metres(scene.grid.cell)} wide, {scene.grid.geometry}"))
    rows.append(("end", f"{scene.end_time * 1e9:.4g} ns"))
    return rows


def _numbers(version: str) -> list[int]:
    """Return the numbers of a version, to be compared; an empty list for a text without any."""
    return [int(part) for part in version.split(".") if part.isdigit()]


def _view(snapshot: Snapshot, setup: Setup) -> tuple[View3d | None, str]:
    """Return the view of the crater in a snapshot; if there is none, None and why."""
    surface = surface_in(snapshot, setup)
    found = meshes(surface, snapshot, setup, present(snapshot)) if surface else {}
    if not found:
        return None, "There is no crater to show: nothing below z = 0 is open to the top."
    try:
        return view_3d(found), ""
    except PockmarkError as error:
        return None, f"It is left out: {error}"


def _film(folder: RunFolder, scene: Scene, setup: Setup) -> tuple[str | None, str]:
    """Return an animation of a run's snapshots, or None, and what is to be said of it."""
    files = folder.snapshots()
    if len(files) < 2:
        return None, "The run has one snapshot: there is nothing to animate."
    chosen = np.unique(np.linspace(0, len(files) - 1, min(len(files), MOST_FRAMES)).round().astype(int))
    frames = []
    for n in chosen:
        try:
            snapshot = in_the_grid(folder.snapshot(files[n]), scene)
        except PockmarkError:  # of a run that was killed while it was written
            continue
        title = f"{float(snapshot['time'][0]) * 1e9:.4g} ns"
        frames.append(frame(slice_figure(snapshot, setup, crater=None, title=title)))
    return gif(frames), f"{len(frames)} of {len(files)} snapshots."


def _pictures(folder: RunFolder, energy: Mapping[str, Any]) -> dict[str, str]:
    """Return the pictures of a run as addresses of PNGs."""
    drawn, bar = figures_of(folder), energy_figure(energy)
    try:
        process = plot_process(folder) if len(folder.snapshots()) > 1 else None
    except PockmarkError:  # of a run that was killed while it wrote one
        process = None
    return {
        "slice": png(drawn["crater.png"](), PICTURE_DPI),
        "history": png(drawn["history.png"](), PICTURE_DPI),
        "process": png(process) if process else "",
        "energy": png(bar) if bar else "",
    }


def _materials(scene: Scene) -> list[MaterialSheet]:
    """Return the materials of a scene's bodies, with all constants."""
    out = []
    for name in dict.fromkeys(body.material for body in scene.body):
        material = scene.materials[name]
        bodies = ", ".join(body.name for body in scene.body if body.material == name)
        rows = [
            (row.key, "-" if row.value is None else f"{_told(row.value)} {row.unit}".strip(), row.meaning)
            for row in constants(material)
        ]
        out.append(MaterialSheet(name, bodies, material.source, rows))
    return out


def _told(value: float | str) -> str:
    """Return a constant as a reader sees it."""
    return value if isinstance(value, str) else f"{value:.6g}"


def _energies(folder: RunFolder, scene: Scene, shares: Mapping[str, Any]) -> list[Energy]:
    """Return where the energy is at the end of a run."""
    joules = folder.record(scene.grid.cell_count).joules
    return [Energy(key, LEDGER[key], joules[key], shares.get(key)) for key in SHARES]


def _reproduced(manifest: Mapping[str, Any]) -> Rows:
    """Return by what a run was made, in rows for a reader. What a manifest does not say is left out."""
    machine: Mapping[str, Any] = manifest.get("machine") or {}
    build: Mapping[str, Any] = machine.get("build") or {}
    rows: Sequence[tuple[str, Any]] = (
        ("pockmark", manifest.get("pockmark")),
        ("physics", manifest.get("physics")),
        ("commit", manifest.get("commit")),
        ("hash of the scene", manifest["scene_hash"]),
        ("started", manifest.get("started")),
        ("ended", manifest.get("ended")),
        ("threads", manifest.get("threads")),
        ("processor", machine.get("processor")),
        ("system", machine.get("system")),
        ("Python", machine.get("python")),
        ("instruction set", build.get("isa")),
        ("compiler", build.get("compiler")),
    )
    return [(name, str(value)) for name, value in rows if value is not None]


def _command(scene: Scene, name: str, manifest: Mapping[str, Any]) -> str:
    """Return the command that makes a run again from its scene."""
    coarse = " --coarse" if is_too_coarse(scene) else ""
    threads = f" --threads {manifest['threads']}" if isinstance(manifest.get("threads"), int) else ""
    return f"pockmark run scene.toml -o {shlex.quote(shown(f'{name}-again'))}{threads}{coarse}"
