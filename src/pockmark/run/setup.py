"""The setup of a scene: what its measures and pictures have to know of it."""

from ..base.geometry import Setup
from ..scene.prospect import arrivals, settled_at
from ..scene.scene import Scene
from ..scene.warnings import cells_across
from .wall import first_wall, walls


def setup_of(scene: Scene) -> Setup:
    """Return the setup of a scene."""
    mass = {i: _mass(scene, i) for i in range(len(scene.body))}
    hits, pitch = _swarm(scene)
    return Setup(
        spacing=max(scene.body[i].spacing for i in scene.targets or scene.projectiles),
        mirrors=scene.mirrors,
        names=tuple(body.name for body in scene.body),
        projectiles=scene.projectiles,
        wall=first_wall(scene),
        walls=tuple(walls(scene)),
        tops=tuple(scene.body[i].box[1][2] for i in scene.targets),
        projectile_mass=sum(mass[i] for i in scene.projectiles),
        projectile_diameter=_projectile_diameter(scene),
        momentum=-sum(mass[i] * scene.velocity(body)[2] for i, body in enumerate(scene.body)),
        cells_across=cells_across(scene),
        heading=scene.impact.heading,
        is_oblique=scene.impact.angle != 0,
        hits=hits,
        pitch=pitch,
        centre=_centre(scene),
        arrival=min(arrivals(scene), default=None),
        settled=settled_at(scene),
        is_axisymmetric=scene.grid.is_axisymmetric,
        cell=scene.grid.cell,
    )


def _mass(scene: Scene, i: int) -> float:
    """Return the mass at the start of a body's points that are computed, kg."""
    body = scene.body[i]
    return scene.volume(body) * scene.materials[body.material].density


def _projectile_diameter(scene: Scene) -> float:
    """Return the diameter of the first projectile as its points fill it, m; 0 without one."""
    return scene.body[scene.projectiles[0]].diameter if scene.projectiles else 0.0


def _swarm(scene: Scene) -> tuple[tuple[tuple[float, float], ...], float]:
    """Return where the balls of the first swarm meet z = 0 (x, y; m), and the distance of neighbours, m.

    Each ball flies along its own path. Without a swarm there are no places, and the distance is 0.
    """
    swarms = [
        (body.places, apart) for i in scene.projectiles if (apart := (body := scene.body[i]).neighbours)
    ]
    if not swarms:
        return (), 0.0
    places, pitch = swarms[0]
    x, y, z = scene.impact.velocity
    drift = (x / -z, y / -z) if z else (0.0, 0.0)
    hits = tuple((a + c * drift[0], b + c * drift[1]) for a, b, c in places)
    return hits, pitch


def _centre(scene: Scene) -> tuple[float, float]:
    """Return x and y (m) of the first projectile; without one, of the axis or of the grid's middle."""
    if scene.projectiles:
        return scene.body[scene.projectiles[0]].foot
    if scene.grid.is_axisymmetric:
        return 0.0, 0.0
    (x0, y0, _), (x1, y1, _) = scene.grid.box
    return (x0 + x1) / 2, (y0 + y1) / 2
