"""Pictures of a run: the slice through the crater, and the history.

The slice has the panels of Liu et al. 2015, Figs. 5 and 8.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..base.errors import shown
from ..base.geometry import Setup
from ..base.ledger import DRAWN, LEFT_ENERGIES
from ..metrology.crater import Crater
from ..metrology.section import section_area
from ..metrology.stress import effective_stress

Fields = Mapping[str, NDArray[Any]]  # of a snapshot
History = Mapping[str, NDArray[np.float64]]  # columns
Array = NDArray[np.floating]
AIR = "#e8eef4"  # differs from the targets' colours and from the projectile's white
TARGETS = ("#999999", "#7a9cc6", "#c69c6d", "#8fb08c", "#a88bb5", "#c98686")
STRESS = ScalarMappable(Normalize(0.0, 600.0), "viridis")
PRESSURE = ScalarMappable(Normalize(-600.0, 600.0), "coolwarm")
HISTORY_COLUMNS = ("time", *DRAWN, *LEFT_ENERGIES, "error", "initial", "depth")


@dataclass(frozen=True)
class Cut:
    """The points within one spacing of a plane across y or x, as a picture shows them.

    `x` is the other of the two axes, um. All arrays are (n,): `width` of a point in um, `stress` and `pressure` in
    MPa.
    """

    x: Array
    z: Array
    width: Array
    stress: Array
    pressure: Array
    body: NDArray[Any]
    is_projectile: NDArray[np.bool_]
    time: float  # ns

    @classmethod
    def of(cls, snapshot: Fields, setup: Setup) -> "Cut":
        """Return the points near the plane of the picture, without those that have no place."""
        across = slice_axis(setup)
        near = np.abs(snapshot["position"][:, across] - slice_plane(setup)) < setup.spacing
        near &= np.isfinite(snapshot["position"]).all(axis=1) & (snapshot["volume"] > 0)
        there = np.flatnonzero(near)
        side = np.ones(len(there))
        position, volume = snapshot["position"][there] * 1e6, snapshot["volume"][there]
        width = np.cbrt(volume) * 1e6
        if setup.is_axisymmetric:  # a ring cuts the plane on both sides of the axis
            width = np.sqrt(section_area(snapshot["position"][there], volume)) * 1e6
            side = np.repeat((1.0, -1.0), len(there))
            there, position, width = np.tile(there, 2), np.tile(position, (2, 1)), np.tile(width, 2)
        body = snapshot["body"][there]
        return cls(
            side * position[:, 1 - across],
            position[:, 2],
            width,
            effective_stress(snapshot["deviator"][there]) / 1e6,
            snapshot["pressure"][there] / 1e6,
            body,
            np.isin(body, setup.projectiles),
            float(snapshot["time"][0]) * 1e9,
        )

    @property
    def limits(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the limits of axes that show the points, um."""
        return _limits(self.x, self.z, self.z[~self.is_projectile])

    def draw(self, axes: Axes, colour: NDArray[Any]) -> None:
        """Draw the target's points in their colours, the projectile white, the original surface dotted."""
        size = _marker_size(axes, self.width)
        target = ~self.is_projectile
        for part, painted in ((target, colour[target]), (self.is_projectile, "white")):
            axes.scatter(self.x[part], self.z[part], c=painted, s=size[part], marker="s", linewidths=0)
        axes.axhline(0.0, color="black", linestyle=":", linewidth=0.8)


def slice_figure(
    snapshot: Fields,
    setup: Setup,
    *,
    crater: Crater | None,
    title: str,
    is_perforated: bool = False,
) -> Figure:
    """Draw the points within one spacing of the plane of the picture, in three panels.

    They show the bodies, the effective stress from 0 to 600 MPa, and the pressure from -600 to 600 MPa.
    """
    cut, across = Cut.of(snapshot, setup), slice_axis(setup)
    limits = cut.limits
    figure = Figure(figsize=_size(limits), layout="compressed")
    FigureCanvasAgg(figure)
    figure.suptitle(shown(title, 80), parse_math=False)
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    colours = [
        np.asarray([_colour(setup, body) for body in cut.body]),
        STRESS.to_rgba(cut.stress),
        PRESSURE.to_rgba(cut.pressure),
    ]
    names = ("bodies (projectile white)", "effective stress (MPa)", "pressure (MPa)")
    for axes, name, scale in zip(panels, names, (STRESS, STRESS, PRESSURE), strict=True):
        axes.set(xlim=limits[0], ylim=limits[1], aspect="equal", ylabel="z (um)", title=name, facecolor=AIR)
        # Every panel gets a bar, so that all are of one width. That of the first has no meaning and is hidden.
        figure.colorbar(scale, ax=axes).ax.set_visible(axes is not panels[0])
    panels[-1].set_xlabel(f"{'xy'[1 - across]} (um)")
    figure.draw_without_rendering()  # the markers' size depends on the panels'
    for axes, colour in zip(panels, colours, strict=True):
        cut.draw(axes, np.asarray(colour))
        _mark_depth(axes, crater, across)
        if is_perforated:
            axes.set_title("perforated", loc="right", color="crimson")
        if len(cut.x) == 0:
            axes.text(0.5, 0.3, "no point is left in this plane", ha="center", transform=axes.transAxes)
    if len(setup.targets) > 1:
        _name_targets(panels[0], setup)
    return figure


def process_figure(snapshots: Iterable[Fields], setup: Setup) -> Figure:
    """Draw effective stress above and pressure below, a column for each snapshot.

    These are the panels of Liu et al. 2015, Figs. 5 and 8.
    """
    cuts, across = [Cut.of(snapshot, setup) for snapshot in snapshots], slice_axis(setup)
    limits = cuts[-1].limits
    wide, high = (end - start for start, end in limits)
    figure = Figure(figsize=(3 * len(cuts) + 1, 6 * high / wide + 1), layout="compressed")
    FigureCanvasAgg(figure)
    rows = figure.subplots(2, len(cuts), sharex=True, sharey=True, squeeze=False)
    names = ("effective stress (MPa)", "pressure (MPa)")
    for row, name, scale in zip(rows, names, (STRESS, PRESSURE), strict=True):
        for axes in row:
            axes.set(xlim=limits[0], ylim=limits[1], aspect="equal", facecolor=AIR)
        row[0].set_ylabel("z (um)")
        figure.colorbar(scale, ax=row, label=name)
    for axes, cut in zip(rows[0], cuts, strict=True):
        axes.set_title(f"{cut.time:.0f} ns")
    for axes in rows[1]:
        axes.set_xlabel(f"{'xy'[1 - across]} (um)")
    figure.draw_without_rendering()
    for column, cut in zip(rows.T, cuts, strict=True):
        cut.draw(column[0], np.asarray(STRESS.to_rgba(cut.stress)))
        cut.draw(column[1], np.asarray(PRESSURE.to_rgba(cut.pressure)))
    return figure


def slice_axis(setup: Setup) -> int:
    """Return the axis across the picture's slice: y, or x if the projectiles move more along y than along x."""
    x, y = setup.heading
    return 1 if abs(x) >= abs(y) else 0


def slice_plane(setup: Setup) -> float:
    """Return the coordinate of the picture's slice on that axis, m.

    It is that of a symmetry plane, or else of the first projectile.
    """
    axis = slice_axis(setup)
    for mirror in setup.mirrors:
        if mirror.axis == axis:
            return mirror.at
    return setup.centre[axis]


def _colour(setup: Setup, body: int) -> str:
    """Return a body's colour: white for a projectile, one of TARGETS for a target."""
    return TARGETS[setup.targets.index(body) % len(TARGETS)] if body in setup.targets else "#ffffff"


def _limits(x: Array, z: Array, z_target: Array) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the limits of the axes, um.

    They show the whole target, and above it no more air than a third of the width.
    """
    if len(x) == 0:
        return (-1.0, 1.0), (-1.0, 1.0)
    left, right, low = float(x.min()), float(x.max()), float(z.min())
    width = max(right - left, 1e-3)
    room = min(float(z_target.max(initial=0.0)) + 0.1 * width, 0.33 * width)
    margin = 0.01 * width
    return (left - margin, right + margin), (low - margin, max(0.15 * width, room))


def _size(limits: tuple[tuple[float, float], tuple[float, float]]) -> tuple[float, float]:
    """Return the width and height of the figure, inches, in which its panels leave no blank."""
    (left, right), (low, high) = limits
    shape = (high - low) / (right - left)
    wide = min(5.4, 4.0 / shape)
    return max(wide, 3.0) + 1.9, 3 * (wide * shape + 0.4) + 0.7


def _marker_size(axes: Axes, width_um: Array) -> Array:
    """Return the areas, pt^2, of square markers `width_um` wide in data units, so that they tile the plane.

    A quarter of a pt more closes the hairlines that rounding to pixels leaves.
    """
    origin, unit = axes.transData.transform([(0.0, 0.0), (1.0, 0.0)])
    pt_per_um = (unit[0] - origin[0]) * 72.0 / axes.figure.dpi
    return np.asarray((width_um * pt_per_um + 0.25) ** 2)


def _mark_depth(axes: Axes, crater: Crater | None, across: int) -> None:
    """Draw the depth as an arrow in the crater.

    Its length is written above the panel, where it hides nothing.
    """
    if crater is None:
        return
    x, depth = crater.bottom[1 - across] * 1e6, crater.depth * 1e6
    arrow = {"arrowstyle": "<->", "color": "crimson", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x, -depth), (x, 0.0), arrowprops=arrow)
    axes.set_title(f"$C_p$ = {depth:.1f} um", loc="right", color="crimson")


def _name_targets(axes: Axes, setup: Setup) -> None:
    """Draw a legend with the names of the targets."""
    squares = [axes.scatter([], [], color=_colour(setup, body), marker="s") for body in setup.targets]
    legend = axes.legend(squares, ["target"] * len(squares), loc="upper left", fontsize="small", ncols=2)
    # The names come last, for matplotlib leaves out labels that begin with "_".
    for text, body in zip(legend.get_texts(), setup.targets, strict=True):
        text.set(text=shown(setup.names[body], 40), parse_math=False)


def history_figure(history: History) -> Figure:
    """Draw energies, ledger error and crater depth against time."""
    time, initial = history["time"] * 1e9, history["initial"]
    # Without an initial energy no share of it can be drawn.
    shares = bool(initial.all())
    scale = initial if shares else 1.0
    figure = Figure(figsize=(8, 9), layout="constrained")
    FigureCanvasAgg(figure)
    energy, error, depth = figure.subplots(3, 1, sharex=True)
    for name in DRAWN:
        energy.plot(time, history[name] / scale, label=name)
    energy.plot(time, sum(history[name] for name in LEFT_ENERGIES) / scale, label="left the grid")
    energy.set(ylabel="energy / initial kinetic energy" if shares else "energy (J)")
    energy.legend()
    error.plot(time, history["error"] / scale * (100 if shares else 1))
    error.set(ylabel="ledger error (%)" if shares else "ledger error (J)")
    depth.plot(time, history["depth"] * 1e6)
    depth.set(ylabel="depth of the deepest column (um),\nan estimate, not $C_p$", xlabel="time (ns)")
    return figure
