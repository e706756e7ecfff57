"""A plane shock between two plates of a fluid in three frames, against Rankine and Hugoniot.

One column of cells with mirrors on its sides: exactly one-dimensional. Us = c0 + s up with up = v/2 is the exact answer.
"""

import math

import numpy as np
from schemes import Changes, scene_of

from pockmark import Scene, Simulation

H = 1e-6  # m, a cell
WAY = 180  # cells that the shock runs
CLEAR = 15  # cells beside the plates' contact, which the first instant overheats
BEHIND = 0.85  # of the shock's way: beyond lies its front
FRAMES = {
    "none": 0.0,
    "target": 0.5,
    "flyer": -0.5,
}  # which plate rests: velocity of the shocked material over v


def measure(
    changes: Changes, *, at_rest: str, speed_m_s: float, points: int, way: int = WAY
) -> dict[str, float]:
    """Return the pressure behind the shocks and its scatter, both over Rankine-Hugoniot's pressure.

    `points` lie along a cell's edge. The mean is that of both plates, at five times in the second part of the way.
    """
    frame = FRAMES[at_rest] * speed_m_s
    scene = _plates(changes, frame, speed_m_s, points, way)
    simulation = Simulation(scene, 1)
    shock, exact = hugoniot(scene, speed_m_s)
    found = []
    for time in np.linspace(0.4, 1.0, 5) * scene.end_time:
        simulation.run(end_time=time)
        depth = np.abs(simulation.field("position")[:, 0] - frame * simulation.time)
        behind = (depth > CLEAR * H) & (depth < BEHIND * (shock - speed_m_s / 2) * simulation.time)
        found.append(simulation.field("pressure")[behind])
    pressure = np.concatenate(found)
    return {"pressure": float(pressure.mean() / exact), "scatter": float(pressure.std() / exact)}


def hugoniot(scene: Scene, speed: float) -> tuple[float, float]:
    """Return the shock's speed (m/s) and pressure (Pa) for an impact of the first body's material on itself."""
    material = scene.materials[scene.body[0].material]
    constants = material.eos.model_dump()
    shock = constants["c0"] + constants["s"] * speed / 2
    return shock, material.density * shock * speed / 2


def _plates(changes: Changes, frame: float, speed: float, points: int, way: int) -> Scene:
    """Return the scene of two plates that meet in x = 0 at time 0; it ends when the shocks have gone their way.

    Each plate is just thick enough for the shock.
    """
    eos = {"c0": 5330.0, "s": 1.34}
    slowest = eos["c0"] + (eos["s"] - 1) * speed / 2  # of the shock, seen from the shocked material
    end = way * H / slowest
    thick = math.ceil(way + speed / 2 * end / H) + CLEAR
    side = (thick + math.ceil(abs(frame) * end / H) + 4) * H
    fluid = {
        "based_on": "al2024-liu2015",
        "eos": {"model": "mie-gruneisen", "gamma0": 2.0, **eos},
        "strength": {"model": "fluid"},
        "failure": {"model": "none"},
    }

    def plate(name: str, lower: float, upper: float, velocity: float) -> dict[str, object]:
        corners = {"lower": [lower, 0.0, 0.0], "upper": [upper, H, H]}
        body = {"name": name, "shape": "block", "material": "fluid", "spacing": H / points}
        return body | corners | {"velocity": [velocity, 0.0, 0.0]}

    table = {
        "title": "plane shock",
        "end_time": end,
        "impact": {"speed": 0.0},
        "grid": {"lower": [-side, 0.0, 0.0], "upper": [side, H, H], "cell": H},
        "boundary": dict.fromkeys(("x_lower", "x_upper"), "free")
        | dict.fromkeys(("y_lower", "y_upper", "z_lower", "z_upper"), "symmetry"),
        "materials": {"fluid": fluid},
        "body": [
            plate("target", 0.0, thick * H, frame - speed / 2),
            plate("flyer", -thick * H, 0.0, frame + speed / 2),
        ],
    }
    return scene_of(table, changes)
