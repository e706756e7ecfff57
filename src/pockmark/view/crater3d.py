"""The crater to turn, cut and colour, in a page that needs nothing else: PyVista's export, which has vtk.js in it."""

import json
from collections.abc import Mapping
from contextlib import contextmanager
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import to_hex
from numpy.typing import NDArray

from ..base.errors import PockmarkError
from ..metrology.mesh import FIELDS, Mesh

EXTRA = "PyVista and trame-pyvista are not installed: pip install 'pockmark[report]'"
MAPS = {False: "viridis", True: "coolwarm"}  # of a field with one sign, and with two
# vtk.js asks its makers' site for an icon.
ICON, NO_ICON = "https://kitware.github.io/vtk-js/icon/", "data:,"
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
    pyvista = _pyvista()
    fields = [*next(iter(meshes.values())).fields]
    bars = tuple(_bar(name, np.concatenate([mesh.fields[name] for mesh in meshes.values()])) for name in fields)
    with _quiet(pyvista):
        plotter = pyvista.Plotter(off_screen=True, window_size=(800, 600))
        plotter.set_background("white")
        for mesh in meshes.values():
            data = _polydata(pyvista, mesh)
            for bar in bars:
                data.point_data.active_scalars_name = None
                plotter.add_mesh(
                    data.copy(deep=False),
                    scalars=bar.name,
                    clim=(bar.low, bar.high),
                    cmap=MAPS[FIELDS[bar.name].is_signed],
                    show_scalar_bar=False,
                    smooth_shading=False,
                )
        plotter.camera_position = "iso"
        page = plotter.trame.export_html(None).getvalue()
        plotter.close()
    actors = json.dumps([[cut, bar.name] for cut in meshes for bar in bars])
    return View3d(page.replace(ICON, NO_ICON), actors, tuple(meshes), bars)


def _pyvista() -> Any:
    """Return the module pyvista. Raises PockmarkError where it or its export of pages is missing."""
    try:
        import pyvista
        import trame_pyvista  # noqa: F401
    except ImportError:
        raise PockmarkError(EXTRA) from None
    return pyvista


@contextmanager
def _quiet(pyvista: Any) -> Iterator[None]:
    """Let VTK not say that there is no display: nothing is shown on one."""
    before = pyvista.vtk_verbosity()
    pyvista.vtk_verbosity("off")
    try:
        yield
    finally:
        pyvista.vtk_verbosity(before)


def _polydata(pyvista: Any, mesh: Mesh) -> Any:
    """Return a mesh as PyVista has it, in um and in single precision."""
    corners = np.column_stack([np.full(len(mesh.triangles), 3), mesh.triangles]).astype(np.int32)
    data = pyvista.PolyData((mesh.vertices * 1e6).astype(np.float32), corners.ravel())
    for name, values in mesh.fields.items():
        data.point_data[name] = values.astype(np.float32)
    return data


def _bar(name: str, values: NDArray[np.float64]) -> Bar:
    """Return the colours of a field over what all but a few of its values span; about 0 if it has two signs."""
    low, high = (float(end) for end in np.nanpercentile(values, (SHARE, 100 - SHARE)))
    if FIELDS[name].is_signed:
        high = max(abs(low), abs(high))
        low = -high
    if high <= low:  # all alike
        high = low + max(abs(low), 1.0) * 1e-3
    steps = matplotlib.colormaps[MAPS[FIELDS[name].is_signed]](np.linspace(0, 1, 17))
    return Bar(name, FIELDS[name].unit, low, high, tuple(to_hex(colour) for colour in steps))
