"""The crater from above: the height of the target's surface, the pithead, and what is left of the projectile in it."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..base.geometry import Setup
from ..metrology.crater import Crater
from ..metrology.section import section_area
from ..metrology.surface import Surface, volume_fraction, with_images
from .canvas import MARK, UM, blank, draw_lines
from .panels import AIR, note, outline, told
from .quantities import HEIGHT, Fields
from .raster import Array, edges_of, slice_axis, slice_plane


def top_figure(
    surface: Surface | None, snapshot: Fields, setup: Setup, *, crater: Crater | None, title: str
) -> Figure:
    """Draw the height of the uppermost surface of the target near the crater, seen from above.

    A column without material is left in the colour of air. The lining, what is left of the projectile below z = 0, is
    outlined where it is more than half a spacing thick. `surface` is None where nothing below z = 0 is open.
    """
    figure = blank((6.6, 5.6), title=title)
    axes = figure.subplots()
    axes.set(xlabel="x (um)", ylabel="y (um)", aspect="equal", facecolor=AIR, title="height, from above")
    if surface is None:
        axes.set(xticks=[], yticks=[])
        note(axes, "nothing below z = 0 is open: there is no crater to show")
        return figure
    height = top_of(surface) / UM
    x, y = surface.x / UM, (surface.x if surface.is_section else surface.y) / UM
    half = surface.node_distance / UM / 2
    image = axes.imshow(
        height.T,
        cmap=HEIGHT.colours,
        norm=HEIGHT.span(height.compressed()),
        extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half),
        origin="lower",
        interpolation="bilinear",
    )
    bar = figure.colorbar(image, ax=axes, extend="both")
    bar.set_label(told(HEIGHT), fontsize="small")
    lining = edges_of(_lining(surface, snapshot, setup) > 0.5)
    outline(axes, [np.array([x[0], y[0]]) + line * 2 * half for line in lining])
    _mark(axes, crater, setup)
    if height.count():
        note(axes, f"height: {height.min():.4g} to {height.max():.4g} um")
    return figure


def top_of(surface: Surface) -> np.ma.MaskedArray[Any, Any]:
    """Return the height (nx, ny), m, of the uppermost surface; masked where a column has no material.

    Of a section through an axis it is the height around the axis, (nx, nx).
    """
    solid = surface.fraction > 0.5
    last = solid.shape[2] - 1 - np.argmax(solid[:, :, ::-1], axis=2)
    height = np.where(solid.any(axis=2), surface.crossing(last), np.nan)
    return np.ma.masked_invalid(_around(surface, height[:, 0]) if surface.is_section else height)


def _around(surface: Surface, along: Array) -> Array:
    """Return values (nx,) along x of a section turned around its axis: (nx, nx). What is farther out is no number."""
    x = np.asarray(surface.x)
    radius = np.hypot(x[:, None], x[None, :])
    inside = x >= -1e-9 * surface.spacing
    return np.interp(radius, x[inside], along[inside], right=np.nan)


def _lining(surface: Surface, snapshot: Fields, setup: Setup) -> Array:
    """Return how many spacings thick the projectile lies below z = 0 in each column, (nx, ny)."""
    h = surface.spacing
    position, volume = snapshot["position"], snapshot["volume"]
    mine = np.isin(snapshot["body"], setup.projectiles)
    mine &= np.isfinite(position).all(axis=1) & (volume > 0) & (position[:, 2] < 0)
    position, volume = position[mine], volume[mine]
    if surface.is_section:
        apart = position[:, 0] > 0
        place, size = position[apart, :1], section_area(position[apart], volume[apart]) / h**2
        place, size = np.concatenate([place, -place]), np.tile(size, 2)
        nodes = [surface.x]
    else:
        for mirror in setup.mirrors:
            position, volume = with_images(position, volume, mirror)
        place, size = position[:, :2], volume / h**3
        nodes = [surface.x, surface.y]
    origin = np.array([along[0] for along in nodes])
    last: NDArray[np.int64] = np.array([len(along) - 1 for along in nodes])
    thick = volume_fraction((place - origin) / h, size, np.zeros_like(last), last)
    return np.nan_to_num(_around(surface, thick)) if surface.is_section else thick


def _mark(axes: Any, crater: Crater | None, setup: Setup) -> None:
    """Draw the plane of the slice and, where there is a crater, its bottom and its pithead."""
    line = axes.axhline if slice_axis(setup) == 1 else axes.axvline
    line(
        0.0 if setup.is_axisymmetric else slice_plane(setup) / UM, color="black", linestyle=":", linewidth=0.8
    )
    if crater is None:
        return
    axes.plot(
        crater.bottom[0] / UM, crater.bottom[1] / UM, "+", color="white", markersize=11, markeredgewidth=3
    )
    axes.plot(crater.bottom[0] / UM, crater.bottom[1] / UM, "+", color=MARK, markersize=9)
    if crater.contour is not None:
        draw_lines(axes, [crater.contour], "w-")
        draw_lines(axes, [crater.contour], "k--")
    if crater.diameter is not None:
        axes.set_title(f"$D_c$ = {crater.diameter / UM:.1f} um", loc="right", color=MARK)
