"""One panel of a picture: a raster in colours, the outlines of material and projectile, what was measured."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..base.errors import shown
from ..base.geometry import Setup
from ..metrology.crater import Crater
from .canvas import MARK
from .quantities import PERCENTILES, Quantity
from .raster import Array, Limits, Raster

AIR = "#eef2f6"
TARGETS = ("#9a9a9a", "#6f9bd1", "#c9a66b", "#7fb59a", "#b594c4", "#5f6b7a")
PROJECTILE = "#e69f00"
EDGE = 0.8  # pt, of the projectile's outline, dark within white: one of them differs from any ground


def frame(axes: Axes, limits: Limits, title: str) -> None:
    """Give a panel its limits, um, its title and its air."""
    axes.set(xlim=limits[0], ylim=limits[1], aspect="equal", title=title, facecolor=AIR)


def show_quantity(axes: Axes, raster: Raster, quantity: Quantity, span: Normalize | None = None) -> AxesImage:
    """Draw a quantity of a raster in colours that end at `span`, by its own percentiles if None."""
    drawn = raster.field(raster.cut.values[quantity.name])
    image = axes.imshow(
        drawn.T,
        cmap=quantity.colours,
        norm=span or quantity.span(drawn.compressed()),
        extent=raster.extent,
        origin="lower",
        interpolation="nearest",
    )
    _outlined(axes, raster)
    return image


def show_bodies(axes: Axes, raster: Raster, setup: Setup) -> None:
    """Draw each body in its colour, hatched where the projectile is."""
    numbers = np.unique(raster.cut.body)
    owner = np.zeros(raster.material.shape, dtype=np.int64)
    if len(numbers):
        owner = np.argmax([raster.share(raster.cut.body == one) for one in numbers], axis=0)
    axes.imshow(
        np.ma.masked_array(owner, ~raster.material).T,
        cmap=ListedColormap([body_colour(setup, int(one)) for one in numbers] or [AIR]),
        norm=Normalize(-0.5, max(len(numbers), 1) - 0.5),
        extent=raster.extent,
        origin="lower",
        interpolation="nearest",
    )
    if (share := raster.projectile).max(initial=0.0) > 0.5:
        hatched = axes.contourf(
            raster.x, raster.z, share.T, levels=[0.5, 2.0], colors="none", hatches=["//////"]
        )
        hatched.set(edgecolor="black", linewidth=0.0)
    _outlined(axes, raster)


def _outlined(axes: Axes, raster: Raster) -> None:
    """Outline material and projectile, and dot the original surface."""
    material, projectile = raster.edges
    axes.add_collection(LineCollection(material, colors="black", linewidths=0.6), autolim=False)
    outline(axes, projectile)
    axes.axhline(0.0, color="black", linestyle=":", linewidth=0.8)


def outline(axes: Axes, lines: Sequence[Array]) -> None:
    """Draw lines (n, 2), um, dark within white: the projectile's."""
    drawn = LineCollection(lines, colors="black", linewidths=EDGE)
    drawn.set(path_effects=[withStroke(linewidth=3.0 * EDGE, foreground="white")])
    axes.add_collection(drawn, autolim=False)


def colour_bar(
    figure: Figure,
    image: AxesImage,
    axes: Axes | NDArray[np.object_],
    quantity: Quantity,
    *,
    paper: bool = False,
) -> None:
    """Draw the bar of a quantity, which says where its colours end. Pointed ends say that some of it is beyond."""
    low, high = image.get_clim()
    values = np.ma.masked_array(image.get_array()).compressed()
    slack = 1e-3 * (high - low)
    below, above = bool((values < low - slack).any()), bool((values > high + slack).any())
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]
    bar = figure.colorbar(image, ax=axes, extend=extend)
    bar.set_label(
        f"{quantity.name}\n{quantity.unit} (the paper's range)" if paper else told(quantity), fontsize="small"
    )


def told(quantity: Quantity) -> str:
    """Return the unit of a quantity, and where its colours end, for the bar of a panel that has its name."""
    percentiles = f"{PERCENTILES[0]:g} to {PERCENTILES[1]:g} % of the area"
    return f"{quantity.unit} (colours: {'0 to 1' if quantity.kind == 'share' else percentiles})".lstrip()


def note_extremes(axes: Axes, raster: Raster, quantity: Quantity) -> None:
    """Write the least and the largest value of the points at the plane, which no mean has taken down."""
    values = raster.cut.values[quantity.name]
    if len(values := values[np.isfinite(values)]):
        ends = " to ".join(dict.fromkeys(f"{end:.4g}" for end in (values.min(), values.max())))
        note(axes, f"points: {ends} {quantity.unit}".rstrip())


def note(axes: Axes, text: str) -> None:
    """Write a remark into the lower left corner of a panel."""
    ground = {"facecolor": "white", "alpha": 0.8, "linewidth": 0, "pad": 2}
    axes.text(0.015, 0.03, text, transform=axes.transAxes, fontsize="small", va="bottom", bbox=ground)


def mark_depth(axes: Axes, crater: Crater | None, across: int) -> None:
    """Draw the depth as an arrow in the crater, where there is one.

    Its length is written above the panel, where it hides nothing.
    """
    if crater is None:
        return
    x, depth = crater.bottom[1 - across] * 1e6, crater.depth * 1e6
    arrow = {"arrowstyle": "<->", "color": MARK, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x, -depth), (x, 0.0), arrowprops=arrow)
    axes.set_title(f"$C_p$ = {depth:.1f} um", loc="right", color=MARK)


def name_bodies(axes: Axes, setup: Setup) -> None:
    """Draw a legend with the names of the targets, and the hatch of a projectile."""
    patches = [Patch(facecolor=body_colour(setup, body), edgecolor="black") for body in setup.targets]
    names = [shown(setup.names[body], 40) for body in setup.targets]
    if setup.projectiles:
        patches.append(Patch(facecolor=PROJECTILE, edgecolor="black", hatch="//////"))
        names.append("projectile")
    legend = axes.legend(
        patches, ["body"] * len(patches), loc="lower right", fontsize="small", ncols=min(len(patches), 3)
    )
    # The names come last, for matplotlib leaves out labels that begin with "_".
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set(text=name, parse_math=False)


def body_colour(setup: Setup, body: int) -> str:
    """Return a body's colour: one of TARGETS, or PROJECTILE."""
    return TARGETS[setup.targets.index(body) % len(TARGETS)] if body in setup.targets else PROJECTILE
