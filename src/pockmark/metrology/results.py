"""The results of a run as numbers with stable keys, SI."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.geometry import LEAST_LAYERS, Setup, copies
from ..base.ledger import LEFT_ENERGIES, LEFT_MOMENTUM, SHARES
from .crater import Crater, measure_crater
from .ejecta import enhancement, find_ejecta, whole_momentum
from .ellipse import Ellipse
from .hole import Hole, measure_hole
from .lining import lining
from .modes import bottoms_of, measures_of, mode_of
from .morphology import Group, Pit
from .round import measure_round_crater, measure_round_hole
from .section import section_filling
from .surface import Filling, Surface, target_filling
from .uncertainty import LEVELS, half_difference, uncertainties

SHAPE = (
    "major_axis",
    "minor_axis",
    "orientation",
    "centre_x",
    "centre_y",
    "bottom_x",
    "bottom_y",
    "e1",
    "e2",
    "rim_height",
    "rim_diameter",
    "depth_over_major_axis",
    "depth_over_minor_axis",
    "lining_fraction",
    "lining_thickness",
    "uncertainty",
)
HOLE = ("perforated", "holes", "hole_width", "hole_diameter", "hole_x", "hole_y", "hole_z")
EJECTA = (
    *("mass", "momentum", "kinetic", "left_mass", "left_momentum", "left_kinetic", "beta"),
    *("speed_edges", "mass_by_speed", "angle_edges", "mass_by_angle"),
)


def filling_of(snapshot: Mapping[str, NDArray[Any]], setup: Setup) -> Filling | None:
    """Return the filling of the wall near its crater in a snapshot of all points.

    None if no wall can be measured, if nothing of it is open, or if a point has no place.
    """
    wall = setup.wall
    if wall is None or wall.layers < LEAST_LAYERS or misplaced(snapshot):
        return None
    is_target = np.isin(snapshot["body"], wall.bodies)
    position, volume = snapshot["position"][is_target], snapshot["volume"][is_target]
    fill = section_filling if setup.is_axisymmetric else target_filling
    return fill(position, volume, setup)


def misplaced(snapshot: Mapping[str, NDArray[Any]]) -> int:
    """Return how many points have a place, velocity, volume or mass that is no number.

    With one such point, nothing can be measured.
    """
    known = np.isfinite(snapshot["volume"]) & np.isfinite(snapshot["mass"])
    known &= np.isfinite(snapshot["position"]).all(axis=1) & np.isfinite(snapshot["velocity"]).all(axis=1)
    return int(np.count_nonzero(~known))


def crater_of(surface: Surface | None, heading: tuple[float, float] = (1.0, 0.0)) -> Crater | None:
    """Return the crater in the target's surface; None if there is none."""
    if surface is None:
        return None
    return measure_round_crater(surface) if surface.is_section else measure_crater(surface, heading)


def hole_of(surface: Surface | None) -> Hole | None:
    """Return the holes in the target's surface; None if there are none."""
    if surface is None:
        return None
    return measure_round_hole(surface) if surface.is_section else measure_hole(surface)


def morphology_table(
    snapshot: Mapping[str, NDArray[Any]],
    filling: Filling | None,
    crater: Crater | None,
    setup: Setup,
) -> dict[str, Any]:
    """Return the crater's shape, lining and uncertainties, SI; None for each that does not exist."""
    shape: dict[str, Any] = dict.fromkeys(SHAPE)
    if filling is None or crater is None:
        return shape
    mass, thickness = lining(snapshot, crater, setup)
    low, high = (crater_of(filling.surface(level), setup.heading) for level in LEVELS)
    shape |= {
        "bottom_x": crater.bottom[0],
        "bottom_y": crater.bottom[1],
        "rim_height": crater.rim_height,
        "rim_diameter": crater.rim_diameter,
        "lining_fraction": _ratio(mass, copies(setup.mirrors) * setup.projectile_mass),
        "lining_thickness": thickness,
        "uncertainty": uncertainties(crater, (low, high), setup.spacing),
    }
    if (ellipse := crater.pithead) is not None:
        shape |= _axes(ellipse) | {
            "centre_x": ellipse.centre[0],
            "centre_y": ellipse.centre[1],
            "e1": ellipse.e1(crater.bottom, setup.heading),
            "e2": ellipse.e2,
            "depth_over_major_axis": crater.depth / ellipse.major,
            "depth_over_minor_axis": crater.depth / ellipse.minor,
        }
    return shape


def hole_table(filling: Filling | None, hole: Hole | None) -> dict[str, Any]:
    """Return the number of holes in the wall, and the widest one's narrowest section, SI.

    `uncertainty` has those of its widths.
    """
    table: dict[str, Any] = dict.fromkeys(HOLE) | {"perforated": hole is not None, "holes": 0}
    if filling is None or hole is None:
        return table
    low, high = (hole_of(filling.surface(level)) for level in LEVELS)
    spread = {
        "hole_" + key: half_difference(*(getattr(h, key) if h else None for h in (low, high)))
        for key in ("width", "diameter")
    }
    x, y, z = hole.place or (None, None, None)
    return table | {
        "holes": hole.count,
        "hole_width": hole.width,
        "hole_diameter": hole.diameter,
        "hole_x": x,
        "hole_y": y,
        "hole_z": z,
        "uncertainty": spread,
    }


def depth_change(time: NDArray[np.float64], depth: NDArray[np.float64]) -> float | None:
    """Return the largest depth less the least (m) in the last tenth of the time, over the last depth.

    None if a depth is missing there, or if the last depth is not positive.
    """
    if len(time) < 2 or not (start := 0.9 * time[-1]) > time[0] or not depth[-1] > 0:
        return None
    late = np.append(depth[time >= start], np.interp(start, time, depth))
    return float(np.ptp(late) / depth[-1]) if np.isfinite(late).all() else None


def group_table(group: Group, setup: Setup) -> dict[str, Any]:
    """Return the craters of a swarm, one by one and as a group, SI.

    The mode, and what decides it, are given for two craters or more, if no ball went through.
    """
    table: dict[str, Any] = {
        "craters": len(group.pits),
        "pitheads": len({pit.hollow for pit in group.pits}),
        "bottoms": bottoms_of(group),
        "ridges": len(group.ridges),
        "holes": group.holes,
        "each_crater": [_pit_table(pit) for pit in group.pits],
        "each_ridge": [asdict(ridge) for ridge in group.ridges],
    }
    if len(group.pits) < 2 or group.holes:
        return table
    depths, measures = [pit.depth for pit in group.pits], measures_of(group, setup.heading)
    mode = mode_of(measures, oblique=setup.is_oblique)
    mean = float(np.mean(depths))
    return table | {
        "mode": mode.number,
        "nearest_mode": mode.nearest,
        "distance_to_it": mode.distance,
        "depth_mean": mean,
        "depth_spread": (max(depths) - min(depths)) / mean,
        **asdict(measures),
    }


def _axes(ellipse: Ellipse | None) -> dict[str, float | None]:
    """Return the axes of a pithead, m and rad; None for each if there is no pithead."""
    return {
        "major_axis": ellipse.major if ellipse else None,
        "minor_axis": ellipse.minor if ellipse else None,
        "orientation": ellipse.orientation if ellipse else None,
    }


def _pit_table(pit: Pit) -> dict[str, Any]:
    """Return one crater of a group, SI."""
    return {
        "x": pit.place[0],
        "y": pit.place[1],
        "depth": pit.depth,
        "roughness": pit.roughness,
        "hollow": pit.hollow,
        **_axes(pit.ellipse),
        "residual": pit.residual,
    }


def ejecta_table(
    snapshot: Mapping[str, NDArray[Any]],
    ledger: Mapping[str, float],
    setup: Setup,
    *,
    has_crater: bool = True,
) -> dict[str, Any]:
    """Return the ejecta in the grid, and what has left it, of the whole impact, SI.

    What is in the grid is None if points have no place. Without a crater beta is None: nothing was thrown out of one,
    or some flies on through the wall.
    """
    n = copies(setup.mirrors)
    left = whole_momentum(n * np.array([ledger[key] for key in LEFT_MOMENTUM]), setup)
    table: dict[str, Any] = dict.fromkeys(EJECTA) | {
        "left_mass": n * ledger["left_mass"],
        "left_momentum": left.tolist(),
        "left_kinetic": n * ledger["left_kinetic"],
    }
    if misplaced(snapshot):
        return table
    found = find_ejecta(snapshot, setup)
    beta = enhancement(float(found.momentum[2] + left[2]), n * setup.momentum) if has_crater else None
    return table | {
        "mass": found.mass,
        "momentum": found.momentum.tolist(),
        "kinetic": found.kinetic,
        "beta": beta,
        "speed_edges": found.speed_edges.tolist(),
        "mass_by_speed": found.mass_by_speed.tolist(),
        "angle_edges": found.angle_edges.tolist(),
        "mass_by_angle": found.mass_by_angle.tolist(),
    }


def result_table(
    crater: Crater | None,
    crater_time: float | None,
    setup: Setup,
    ledger: Mapping[str, float],
    run: Mapping[str, Any],
    counters: Mapping[str, int],
) -> dict[str, Any]:
    """Return the tables crater, energy, run and counters.

    Energies are shares of the initial energy, None if that is zero. E_i^r counts the points that left, with the
    energy that they had then. internal + kinetic + absorbed + left + pic + contact = 1 + ledger_error.
    """
    depth, diameter = (crater.depth, crater.diameter) if crater else (None, None)
    initial = ledger["initial"]
    joules = {key: ledger[key] for key in SHARES} | {
        "residual_internal": ledger["internal"] + ledger["left_internal"],
        "left": sum(ledger[key] for key in LEFT_ENERGIES),
        "ledger_error": ledger["error"],
    }
    return {
        "crater": {
            "depth": depth,
            "diameter": diameter,
            "volume": crater.volume if crater else None,
            "depth_over_projectile_diameter": _ratio(depth, setup.projectile_diameter),
            "depth_over_diameter": _ratio(depth, diameter),
            "time": crater_time,
        },
        "energy": {key: _ratio(value, initial) for key, value in joules.items()},
        "run": dict(run) | {"cells_across_projectile": setup.cells_across},
        "counters": dict(counters),
    }


def _ratio(value: float | None, of: float | None) -> float | None:
    """Return a value over another; None if either is None or the other is 0."""
    return value / of if value is not None and of else None
