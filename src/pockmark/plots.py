"""Pictures of a run: the slice through the crater (the panels of Liu et al. 2015, Figs. 5 and 8) and the history."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .crater import Crater
from .store import effective_stress

Fields = Mapping[str, NDArray[Any]]
ENERGIES = ("kinetic", "internal", "absorbed")
HISTORY_COLUMNS = ("time", *ENERGIES, "left_kinetic", "left_internal", "error", "initial", "depth")


def slice_figure(
    snapshot: Fields, *, bodies_projectile: Sequence[int], spacing: float, crater: Crater | None, title: str
) -> Figure:
    """Points within one `spacing` (m) of y = 0: bodies, effective stress 0 to 600 MPa, pressure -600 to 600 MPa."""
    near = np.abs(snapshot["position"][:, 1]) < spacing
    x, z = snapshot["position"][near, 0] * 1e6, snapshot["position"][near, 2] * 1e6
    width = np.cbrt(snapshot["volume"][near]) * 1e6
    is_projectile = np.isin(snapshot["body"][near], bodies_projectile)
    stress = effective_stress(snapshot["deviator"][near]) / 1e6
    pressure = snapshot["pressure"][near] / 1e6
    figure = Figure(figsize=(8, 11), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title)
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    settings = [
        ("bodies (projectile white)", np.full(len(x), 0.6), "gray", (0.0, 1.0), ""),
        ("effective stress", stress, "viridis", (0.0, 600.0), "MPa"),
        ("pressure", pressure, "coolwarm", (-600.0, 600.0), "MPa"),
    ]
    for axes, (name, values, colours, limits, unit) in zip(panels, settings, strict=True):
        low, high = z.min() - 2, max(z[~is_projectile].max(initial=0.0), 30.0) + 2
        axes.set(
            xlim=(x.min() - 2, x.max() + 2),
            ylim=(low, min(high, 60.0)),
            aspect="equal",
            ylabel="z (um)",
            title=name,
        )
        figure.draw_without_rendering()
        size = _marker_size(axes, width)
        t, p = ~is_projectile, is_projectile
        drawn = axes.scatter(
            x[t],
            z[t],
            c=values[t],
            s=size[t],
            marker="s",
            linewidths=0,
            cmap=colours,
            vmin=limits[0],
            vmax=limits[1],
        )
        axes.scatter(x[p], z[p], c="white", s=size[p], marker="s", edgecolors="black", linewidths=0.3)
        axes.axhline(0.0, color="black", linestyle=":", linewidth=0.8)
        # Every panel gets a bar, so that all are of one width; the first one's says nothing and is hidden.
        figure.colorbar(drawn, ax=axes, label=unit).ax.set_visible(bool(unit))
        _mark_depth(axes, crater)
    panels[-1].set_xlabel("x (um)")
    return figure


def _marker_size(axes: Axes, width_um: NDArray[np.float64]) -> NDArray[np.float64]:
    """Area in points^2 of square markers `width_um` wide in data units, so that points tile the plane."""
    origin, unit = axes.transData.transform([(0.0, 0.0), (1.0, 0.0)])
    points_per_um = (unit[0] - origin[0]) * 72.0 / axes.figure.dpi
    return np.asarray((width_um * points_per_um) ** 2)


def _mark_depth(axes: Axes, crater: Crater | None) -> None:
    if crater is None:
        return
    x, depth = crater.bottom[0] * 1e6, crater.depth * 1e6
    axes.annotate("", (x, -depth), (x, 0.0), arrowprops={"arrowstyle": "<->", "color": "crimson"})
    axes.text(
        x + 1,
        -depth / 2,
        f"$C_p$ = {depth:.1f} um",
        color="crimson",
        va="center",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1},
    )


def history_figure(history: Fields) -> Figure:
    """Energies, ledger error and crater depth against time."""
    time, initial = history["time"] * 1e9, history["initial"]
    # Without an initial energy there are no shares of it.
    shares = bool(initial.all())
    scale = initial if shares else 1.0
    figure = Figure(figsize=(8, 9), layout="constrained")
    FigureCanvasAgg(figure)
    energy, error, depth = figure.subplots(3, 1, sharex=True)
    for name in ENERGIES:
        energy.plot(time, history[name] / scale, label=name)
    energy.plot(time, (history["left_kinetic"] + history["left_internal"]) / scale, label="left the grid")
    energy.set(ylabel="energy / initial kinetic energy" if shares else "energy (J)")
    energy.legend()
    error.plot(time, history["error"] / scale * (100 if shares else 1))
    error.set(ylabel="ledger error (%)" if shares else "ledger error (J)")
    depth.plot(time, history["depth"] * 1e6)
    depth.set(ylabel="depth on the axis (um),\nan estimate, not $C_p$", xlabel="time (ns)")
    return figure
