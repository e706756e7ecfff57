"""The crater to turn, cut and colour, in a page that needs nothing else: vtk.js is in it, by trame-vtk."""

import io
import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from ..base.errors import PockmarkError
from ..metrology.mesh import Mesh
from .quantities import QUANTITIES

EXTRA = "PyVista and trame-vtk are not installed: pip install 'pockmark[report]'"
MAPS = {False: "viridis", True: "coolwarm"}  # of a field with one sign, and with two
# vtk.js asks its makers' site for an icon.
ICON, NO_ICON = "https://kitware.github.io/vtk-js/icon/", "data:,"
SHOWN = {one.name: one for one in QUANTITIES.values()}
SHARE = 1.0  # per cent of the vertices that may lie beyond each end of the colours


@dataclass(frozen=True)
class View3d:
    """A view: its page with vtk.js, and the names by which its parts are shown.

    `actors` names the cut and the field of each thing drawn, in the page's order. `bars` are the fields' colours.
    """

    page: str
    actors: str  # JSON: [[cut, field], ...]
    cuts: tuple[str, ...]
    bars: tuple["Bar", ...]


@dataclass(frozen=True)
class Bar:
    """The colours of a field: its name, unit, ends, and colours (CSS) from the low end to the high one."""

    name: str
    unit: str
    low: float
    high: float
    colours: tuple[str, ...]


def view_3d(meshes: Mapping[str, Mesh]) -> View3d:
    """Return the view of meshes by the names of their cuts. Raises PockmarkError where PyVista or trame is missing."""
    pyvista, *exporting = _libraries()
    fields = [*next(iter(meshes.values())).fields]
    bars = tuple(
        _bar(name, np.concatenate([mesh.fields[name] for mesh in meshes.values()])) for name in fields
    )
    with pyvista.vtk_verbosity("off"):  # it says that there is no display, and none is needed
        plotter = pyvista.Plotter(off_screen=True)
    plotter.set_background("white")
    for mesh in meshes.values():
        data = _polydata(pyvista, mesh)
        for bar in bars:
            plotter.add_mesh(
                data.copy(deep=False),
                scalars=bar.name,
                clim=(bar.low, bar.high),
                cmap=_map_of(bar.name),
                show_scalar_bar=False,
            )
    plotter.camera_position = "iso"
    page = _exported(plotter.render_window, *exporting)
    plotter.close()
    actors = json.dumps([[cut, bar.name] for cut in meshes for bar in bars])
    return View3d(page, actors, tuple(meshes), bars)


def _exported(window: Any, serializers: Any, write_html: Callable[[bytes, io.StringIO], None]) -> str:
    """Return a page that shows what VTK's window has.

    It is what PyVista's own export gives, without the server that this starts: one that asks the network for a file.
    """
    serializers.initialize_serializers()
    context = serializers.SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    scene = serializers.serialize(None, window, serializers.reference_id(window), context, 1)
    camera = window.GetRenderers().GetFirstRenderer().GetActiveCamera()
    scene["extra"] = {
        "vtkRefId": serializers.reference_id(window),
        "centerOfRotation": camera.GetFocalPoint(),
        "camera": serializers.reference_id(camera),
    }
    arrays = {
        entry["hash"]: entry | {"content": context.get_cached_data_array(entry["hash"], False)}
        for entry in serializers.extract_array_hash(scene)
    }
    packed, page = io.BytesIO(), io.StringIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    write_html(packed.getvalue(), page)
    return page.getvalue().replace(ICON, NO_ICON)


def _libraries() -> tuple[Any, Any, Callable[[bytes, io.StringIO], None]]:
    """Return PyVista, and of trame-vtk what describes a scene and what puts it into a page.

    Raises PockmarkError where one is missing.
    """
    try:
        import pyvista
        from trame_vtk.modules.vtk import serializers
        from trame_vtk.tools.vtksz2html import write_html
    except ImportError:
        raise PockmarkError(EXTRA) from None
    return pyvista, serializers, write_html


def _polydata(pyvista: Any, mesh: Mesh) -> Any:
    """Return a mesh as PyVista has it, in um and in single precision."""
    corners = np.column_stack([np.full(len(mesh.triangles), 3), mesh.triangles]).astype(np.int32)
    data = pyvista.PolyData((mesh.vertices * 1e6).astype(np.float32), corners.ravel())
    for name, values in mesh.fields.items():
        data.point_data[name] = values.astype(np.float32)
    return data


def _map_of(name: str) -> str:
    """Return the name of the map in whose colours a field is shown."""
    return MAPS[SHOWN[name].kind == "both"]


def _bar(name: str, values: NDArray[np.float64]) -> Bar:
    """Return the colours of a field over what all but a few of its values span; about 0 if it has two signs."""
    low, high = (float(end) for end in np.nanpercentile(values, (SHARE, 100 - SHARE)))
    if SHOWN[name].kind == "both":
        high = max(abs(low), abs(high))
        low = -high
    if high <= low:  # all alike
        high = low + max(abs(low), 1.0) * 1e-3
    steps = matplotlib.colormaps[_map_of(name)](np.linspace(0, 1, 17))
    return Bar(name, SHOWN[name].unit, low, high, tuple(to_hex(colour) for colour in steps))
