"""An impact is the same mirrored, turned, and divided by its planes of symmetry: point by point, to rounding."""

import numpy as np
import pytest
from builders import FREE, RHO, SYMMETRY, TRANSMITTING, aluminium, core, lattice, law, options, solver

H = 4e-6
STEPS = 60  # through impact, failure of points, several renewals of the faces' areas
UNSTABLE_STEPS = 30  # USL strains by the velocities of slivers of mass: it makes any rounding large
SPEED = 3000.0
SCHEMES = [
    ("usf", "trilinear", False, "points"),
    ("musl", "trilinear", False, "points"),
    ("usl", "trilinear", False, "points"),
    ("usavg", "trilinear", False, "points"),
    ("usavg", "quadratic", False, "points"),
    ("usavg", "trilinear", True, "points"),
    ("usavg", "quadratic", True, "points"),
    ("usavg", "trilinear", False, "cells"),
    ("usavg", "quadratic", True, "cells"),
]
WAYS = pytest.mark.parametrize(("scheme", "shape", "contact", "volume"), SCHEMES)
# In the frame of the impact, z out of the target: the lower and upper faces of x, y, z.
OPEN = {"x": (TRANSMITTING, TRANSMITTING), "y": (TRANSMITTING, TRANSMITTING), "z": (TRANSMITTING, FREE)}
CELLS = np.array([6, 6, 5])  # of the target, each way from the middle and down
ROOM = 4  # cells above it


def scene_points():
    """Positions (n, 3) of a block below z = 0 and of a ball that rests on it, and which are the ball's."""
    block = lattice(
        (-CELLS[0] * H, -CELLS[1] * H, -CELLS[2] * H), (4 * CELLS[0], 4 * CELLS[1], 2 * CELLS[2]), H / 2
    )
    ball = lattice((-2 * H, -2 * H, 0.0), (16, 16, 16), H / 4)
    ball = ball[((ball - [0, 0, 2 * H]) ** 2).sum(axis=1) < (2 * H) ** 2]
    return np.concatenate([block, ball]), np.r_[np.zeros(len(block), int), np.ones(len(ball), int)]


def aluminium_that_fails():
    failure = law(
        "johnson-cook",
        treatment="floor",
        D1=0.13,
        D2=0.13,
        D3=-1.5,
        D4=0.011,
        floor=1e-3,
        triaxiality_min=-1.5,
    )
    return aluminium(failure)


def run(axes, signs, way, *, degrees=0.0, kept=(False, False)):
    """The state by point of an impact whose axis a lies along signs[a] times axis axes[a] of the grid.

    `degrees` of obliquity are towards x. `kept`: only x > 0, only y > 0 is computed, before a mirror.
    """
    scheme, shape, contact, volume = way
    x, body = scene_points()
    there = np.all([x[:, a] > 0 for a in range(2) if kept[a]], axis=0) if any(kept) else np.ones(len(x), bool)
    velocity = np.array([np.sin(np.radians(degrees)), 0.0, -np.cos(np.radians(degrees))]) * SPEED
    lower, upper = -CELLS * 1.0, np.array([CELLS[0], CELLS[1], ROOM + 0.0])
    faces = [list(OPEN[name]) for name in "xyz"]
    for a in range(2):
        if kept[a]:
            lower[a], faces[a][0] = 0.0, SYMMETRY

    def turned(vectors):
        out = np.zeros_like(vectors)
        for a in range(3):
            out[..., axes[a]] = signs[a] * vectors[..., a]
        return out

    corners = np.sort(turned(np.array([lower, upper])), axis=0)
    grid_faces = [None] * 6
    for a in range(3):
        pair = faces[a] if signs[a] > 0 else faces[a][::-1]
        grid_faces[2 * axes[a]], grid_faces[2 * axes[a] + 1] = pair
    bodies = [
        (turned(x[there & (body == b)]), turned(velocity * b), pitch**3, RHO, b)
        for b, pitch in enumerate((H / 2, H / 4))
    ]
    s = solver(
        corners[0] * H,
        H,
        np.round(corners[1] - corners[0]),
        grid_faces,
        [aluminium_that_fails()] * 2,
        options(scheme, shape, volume=volume),
        bodies,
        flies=[False, True],
        friction=0.3 if contact else None,
    )
    s.advance(UNSTABLE_STEPS if scheme == "usl" else STEPS, 1.0)
    ids = np.flatnonzero(there)[s.field("id")]
    back = lambda v: v[:, list(axes)] * np.array(signs)  # noqa: E731
    state = {
        "place": back(s.field("position")) / H,
        "velocity": back(s.field("velocity")) / SPEED,
        "pressure": s.field("pressure")[:, None] / 1e10,
        "energy": s.field("energy")[:, None] / 1e10,
        "damage": np.minimum(s.field("damage"), 1.0)[:, None],
    }
    return ids, state, s


def difference(one, other, flip=None):
    """The largest difference of two runs in the points that both have; `flip`: the other is the mirror image along an axis."""
    (ids, state, _), (other_ids, other_state, _) = one, other
    if flip is not None:
        x, body = scene_points()
        key = lambda y: [tuple(row) for row in np.round(np.c_[y / H * 64, body * 1e6]).astype(int)]  # noqa: E731
        image = x.copy()
        image[:, flip] *= -1
        number = {k: i for i, k in enumerate(key(x))}
        other_ids = np.array([number[k] for k in key(image)])[other_ids]
        other_state = {name: v.copy() for name, v in other_state.items()}
        for name in ("place", "velocity"):
            other_state[name][:, flip] *= -1
    common, mine, others = np.intersect1d(ids, other_ids, return_indices=True)
    assert len(common) == min(len(ids), len(other_ids))
    return max(float(np.abs(state[name][mine] - other_state[name][others]).max()) for name in state)


def told(name, way, worst, s):
    print(
        f"{name}, {way}: largest difference {worst:.1e}; {s.sorts} sorts, {s.counters()['failed_points']} points failed"
    )
    assert s.counters()["failed_points"] > 0
    assert s.ledger()["absorbed"] > 1e-4 * s.ledger()["initial"]
    assert worst < 1e-7


AS_IT_IS = ((0, 1, 2), (1, 1, 1))


@WAYS
@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_mirrored(scheme, shape, contact, volume, degrees):
    """The same impact with x to the other side, and with z downwards."""
    way = (scheme, shape, contact, volume)
    base = run(*AS_IT_IS, way, degrees=degrees)
    for signs in ((-1, 1, 1), (1, -1, 1), (1, 1, -1)):
        told(f"mirrored {signs}", way, difference(base, run((0, 1, 2), signs, way, degrees=degrees)), base[2])


@WAYS
@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_turned(scheme, shape, contact, volume, degrees):
    """The surface looks along x, along y, and the projectile comes along y."""
    way = (scheme, shape, contact, volume)
    base = run(*AS_IT_IS, way, degrees=degrees)
    for axes in ((1, 2, 0), (2, 0, 1), (1, 0, 2)):
        told(f"turned {axes}", way, difference(base, run(axes, (1, 1, 1), way, degrees=degrees)), base[2])


@WAYS
def test_divided(scheme, shape, contact, volume):
    """A quarter and a half have the points of the whole; an oblique half too."""
    way = (scheme, shape, contact, volume)
    whole = run(*AS_IT_IS, way)
    for kept in ((True, False), (False, True), (True, True)):
        told(f"kept {kept}", way, difference(whole, run(*AS_IT_IS, way, kept=kept)), whole[2])
    oblique = run(*AS_IT_IS, way, degrees=30.0)
    half = run(*AS_IT_IS, way, degrees=30.0, kept=(False, True))
    told("oblique half", way, difference(oblique, half), oblique[2])


@WAYS
def test_a_symmetric_impact_stays_symmetric(scheme, shape, contact, volume):
    way = (scheme, shape, contact, volume)
    whole = run(*AS_IT_IS, way)
    for axis in (0, 1):
        told(f"about {'xy'[axis]} = 0", way, difference(whole, whole, flip=axis), whole[2])


def shell(axis, upper, shape, scheme, *, whole):
    """Return points after the step that throws some through the plane of symmetry: by id, with `axis` first and the plane at 0.

    Compressed points that hardly weigh on the nodes before them push these, and light points with them, farther than a
    cell is wide. `whole`: with the mirror image in place of the plane.
    """
    rng = np.random.default_rng(5)
    heavy = rng.random((40, 3)) * [0.02, 4, 4] + [1.97 if shape == "trilinear" else 2.46, 2, 2]
    light = rng.random((60, 3)) * [0.9, 4, 4] + [0.05, 2, 2]
    x, mass = np.vstack([heavy, light]), np.r_[np.ones(40), np.full(60, 1e-6)]
    squeezed = np.r_[np.full(40, 0.8), np.ones(60)]
    copies = 2 if whole else 1
    x = np.vstack([x * [sign, 1, 1] for sign in (1, -1)[:copies]]) * [-1 if upper else 1, 1, 1]
    to_axis = np.roll([0, 1, 2], axis)  # the axis across the plane comes first in x
    lower = np.array([-8.0 if whole or upper else 0.0, 0, 0])
    cells = np.array([16 if whole else 8, 8, 8])
    faces = [FREE] * 6
    if not whole:
        faces[2 * axis + upper] = SYMMETRY
    s = core.solver(single=False)(
        lower=tuple(lower[to_axis] * H),
        cell=H,
        cells=tuple(int(n) for n in cells[to_axis]),
        faces=faces,
        materials=[aluminium()],
        options=options(scheme, shape),
        threads=1,
    )
    mass = np.tile(mass, copies) * RHO * H**3 / 8
    s.add_points(
        position=np.ascontiguousarray(x[:, to_axis] * H),
        velocity=np.zeros_like(x),
        mass=mass,
        volume=mass / RHO * np.tile(squeezed, copies),
        body=np.zeros(len(x), np.uint8),
    )
    s.initialize()
    s.advance(2 if scheme == "musl" else 1, 1.0)  # of which the first one makes the stress
    order = np.argsort(s.field("id"))
    assert s.counters()["lost_points"] == 0
    position, velocity = (
        s.field(name)[order][: 100 * copies, np.argsort(to_axis)] for name in ("position", "velocity")
    )
    return position / H, velocity, s.field("id")[order]


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
@pytest.mark.parametrize("scheme", ["usavg", "usf", "musl"])
@pytest.mark.parametrize(("axis", "upper"), [(0, False), (1, True), (2, False), (0, True)])
def test_what_crosses_a_plane_of_symmetry_comes_back_as_its_image(axis, upper, scheme, shape):
    """Points of the half that is computed were lost there; those of the whole go to the other side."""
    half, whole = (shell(axis, upper, shape, scheme, whole=use) for use in (False, True))
    place, velocity, known = whole
    side = -1 if upper else 1
    ids = half[2]
    assert np.isin(ids, known).all()
    at = np.searchsorted(known, ids)
    crossed = place[at, 0] * side < 0
    turn = np.where(crossed[:, None], [-1.0, 1, 1], 1.0)
    off = np.abs(half[0] - place[at] * turn).max()
    faster = np.abs(half[1] - velocity[at] * turn).max() / np.abs(velocity).max()
    print(f"{crossed.sum()} of {len(ids)} crossed; off by {off:.0e} cells, {faster:.0e} of the velocity")
    assert crossed.sum() > 5
    assert off < 1e-9
    assert faster < 1e-11


@pytest.mark.parametrize("upper", [False, True])
def test_the_first_step_knows_how_fast_images_close(upper):
    """Points run to a plane of symmetry and meet their images at twice their speed, which bounds the first strain."""
    x = lattice((0, 0, 0), (4, 4, 4), H / 2)
    velocity = np.array([3e4 if upper else -3e4, 0, 0])
    shift = np.array([-3 * H if upper else H, 0, 0])
    half = solver(
        (-4 * H if upper else 0, 0, 0),
        H,
        (4, 2, 2),
        [FREE, SYMMETRY] + [FREE] * 4 if upper else [SYMMETRY] + [FREE] * 5,
        [aluminium()],
        options(cfl=1.0),
        [(x + shift, velocity, (H / 2) ** 3, RHO, 0)],
    )
    image = [-1, 1, 1]
    both = [((x + shift), velocity), ((x + shift) * image, velocity * image)]
    whole = solver(
        (-4 * H, 0, 0),
        H,
        (8, 2, 2),
        [FREE] * 6,
        [aluminium()],
        options(cfl=1.0),
        [(place, v, (H / 2) ** 3, RHO, 0) for place, v in both],
    )
    for s in (half, whole):
        s.advance(1, 1.0)
    assert half.dt == whole.dt


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
def test_a_column_is_as_wide_as_its_mirrors_make_it(shape):
    """Between mirrors one cell of a plane shock is as good as two: what lies behind a mirror is the image of the other one."""
    pressures = []
    for wide in (1, 2):
        x = lattice((0, 0, H), (2 * wide, 2 * wide, 28), H / 2)
        v = np.where(x[:, 2:] > 8 * H, [0.0, 0, -1000.0], [0.0, 0, 1000.0])
        s = solver(
            (0, 0, 0),
            H,
            (wide, wide, 16),
            [SYMMETRY] * 4 + [FREE, FREE],
            [aluminium()],
            options(shape=shape),
            [(x, v, (H / 2) ** 3, RHO, 0)],
        )
        s.advance(30, 1.0)
        assert np.abs(s.field("velocity")[:, :2]).max() < 1e-9
        pressures.append(s.field("pressure")[np.argsort(s.field("id"))][:28])
    assert np.abs(pressures[1] - pressures[0]).max() < 1e-12 * pressures[0].max()
