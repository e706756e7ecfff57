"""Swarms: the paper's lattice of spheres (Liu et al. 2015, Eq. 29 and Table 3), and random places."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pockmark import PockmarkError, Scene
from pockmark.base.toml import read_toml
from pockmark.run.points import make_points
from pockmark.scene.bodies import Swarm
from pockmark.scene.bodies.placement import TRIES, at_random

GROUP = Path(__file__).parents[3] / "examples" / "group-4500.toml"
DENSITY = 2770.0


def swarm(**changes):
    keys = {
        "shape": "swarm",
        "name": "s",
        "material": "m",
        "spacing": "0.5 um",
        "lower": ["-50 um", "0 um"],
        "upper": ["50 um", "50 um"],
        "height": "12.5 um",
    }
    return Swarm(**(keys | changes)).resolved(DENSITY)


@pytest.mark.parametrize(
    ("flux", "diameter", "rounded"), [(0.1, 7.553, 8), (0.5, 12.916, 13), (1.0, 16.273, 16)]
)
def test_the_flux_gives_the_diameter(flux, diameter, rounded):
    exact = swarm(pitch="25 um", flux=f"{flux} mg/cm^2")
    whole = swarm(pitch="25 um", flux=f"{flux} mg/cm^2", rounded=True)
    print(f"{2e6 * exact.radius:.4f} um, rounded {2e6 * whole.fit.length:g} um")
    assert 2e6 * exact.radius == pytest.approx(diameter, abs=5e-4)
    assert 2e6 * whole.fit.length == pytest.approx(rounded)
    mass = exact.count() * exact.point_volume * DENSITY
    asked = flux * 1e-2 * 100e-6 * 50e-6  # kg: 1 mg/cm^2 is .01 kg/m^2
    print(f"mass of the points {mass / asked:.6f} of the flux's")
    assert mass / asked == pytest.approx(1, rel=1e-9)


def test_the_lattice_is_the_papers():
    body = swarm(pitch="25 um", flux="1.0 mg/cm^2", rounded=True)
    x, y, z = np.array(body.centers).T * 1e6
    assert sorted(zip(x.round(9), y.round(9), strict=True)) == [
        (a, b) for a in (-37.5, -12.5, 12.5, 37.5) for b in (12.5, 37.5)
    ]
    assert set(z.round(9)) == {12.5}
    assert body.count() == len(body.lattice()) == 8 * 17_256  # Table 3, model 3


def test_random_places_are_apart_and_come_again_with_the_seed():
    first, again, other = (swarm(seed=seed, radius="4 um", flux="0.5 mg/cm^2") for seed in (1, 1, 2))
    places = np.array(first.centers)[:, :2]
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + np.eye(len(places))
    print(f"{len(places)} balls, nearest {apart.min() * 1e6:.2f} um apart")
    assert len(places) == round(0.5e-2 * 50e-6 * 100e-6 / (4 / 3 * np.pi * 4e-6**3 * DENSITY))
    assert apart.min() >= 8e-6
    assert np.all(places >= np.array([-50e-6, 0]) + 4e-6)
    assert np.all(places <= np.array([50e-6, 50e-6]) - 4e-6)
    assert first.centers == again.centers != other.centers


def random_group(number):
    """The group's scene with its balls at random places."""
    table = read_toml(GROUP)
    swarm = {key: value for key, value in table["body"][1].items() if key not in ("pitch", "flux")}
    return table | {"body": [table["body"][0], swarm | {"seed": 3, "radius": "8 um", "number": number}]}


def test_a_saved_swarm_is_the_same_swarm():
    scenes = [
        Scene.load(GROUP),
        Scene.load(GROUP, ["body.swarm.rounded=false"]),
        Scene.from_dict(random_group(6)),
    ]
    for scene in scenes:
        again = Scene.from_dict(scene.to_dict())
        assert again.hash == scene.hash
        assert again.body[1].centers == scene.body[1].centers
        pieces = [piece for piece in make_points(scene) if piece.body[0] == 1]
        assert {tuple(piece.velocity[0]) for piece in pieces} == {scene.impact.velocity}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (
            "body.swarm.seed=1",
            r"body\[1\].*needs either pitch, for balls on a lattice, or seed, for random places",
        ),
        (
            "body.swarm.radius='3 um'",
            r"body: 'swarm': flux makes the radius 8.13649e-06, found 3e-06: give one of the two",
        ),
        ("body.swarm.flux='4 mg/cm^2'", "balls 2.6e-05 m wide overlap at a pitch of 2.5e-05 m"),
        ("body.swarm.flux='1 mg'", "flux: found '1 mg', expected a quantity in kg/m"),
        ("body.swarm.pitch='60 um'", "has no ball: the patch is smaller than a pitch"),
        ("body.swarm.upper=['-60 um', '50 um']", "upper must exceed lower in each direction"),
        ("body.swarm.height='5 um'", r"body\[1\] 'swarm': overlaps body\[0\] 'target'"),
        ("body.swarm.number=3", "and no number"),
        (
            "body.swarm.gap='0 um'",
            "needs either height, of the centres, or gap, the clear height above z = 0",
        ),
    ],
)
def test_a_slip_is_one_sentence(change, expected):
    with pytest.raises(PockmarkError, match=expected) as caught:
        Scene.load(GROUP, change)
    print(caught.value)
    assert "\n" not in str(caught.value)


FORGOTTEN = [
    ("pitch='1e-15 m'\nradius='1e-16 m'", "makes 3.2e+21 balls, at most 5000 are allowed"),
    (
        "seed=1\nnumber=100000\nradius='0.01 um'",
        "number: found 100000, input should be less than or equal to 5000",
    ),
    ("seed=1\nnumber=5000\nradius='0.4 um'", "found places for 3"),
    ("seed=1\nnumber=5000\nradius='1e-9 um'", "leaves it without points"),
    ("pitch='20 um'\nradius=5", "balls 10 m wide overlap at a pitch of 2e-05 m"),
    ("pitch=20\nradius='5 um'", "has no ball: the patch is smaller than a pitch"),
    ("pitch='20 um'\nflux=0.1\nradius='5 um'", "flux makes the radius"),
    ("seed=1\nnumber=3\nradius=5", "balls 10 m wide do not fit into the patch"),
    ("seed=1\nradius='0.5 um'\nflux=1", "balls, at most 5000 are allowed: has each length its unit?"),
    ("seed=1\nradius=1e-99\nflux=1", "balls, at most 5000 are allowed"),
    ("pitch='20 um'\nradius='5 um'\nlower=[-40,0]\nupper=[40,40]", "makes 8e+12 balls"),
    ("seed=1\nnumber=5000\nradius='5 um'\nlower=[-40,0]\nupper=[40,40]", "outside the grid's face"),
    ("pitch='20 um'\nradius='5 um'\nspacing=1.25", "a spacing of 1.25 m leaves it without points"),
    ("pitch='20 um'\nradius='5 um'\nspacing=5e-324", "nearer to 0 than any quantity"),
    ("pitch='20 um'\nradius='5 um'\nheight=10", "outside the grid's face z_upper"),
    ("seed='1'\nradius='5 um'\nnumber=2", "seed: found '1', input should be a valid integer"),
]

LIMITED = """
import resource, sys, time
from pockmark import PockmarkError, Scene
from pockmark.base.toml import read_toml
table = read_toml(sys.argv[1])
Scene.from_dict(table)  # what is imported and kept for all scenes
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 200_000_000,) * 2)
import tomllib
for text in sys.argv[2:]:
    body = table["body"][1]
    if text:
        kept = {k: body[k] for k in ("name", "material", "projectile")}
        patch = {"shape": "swarm", "lower": ["-40 um", "0 um"], "upper": ["40 um", "40 um"], "height": "10 um"}
        body = kept | {"spacing": "1.25 um"} | patch | tomllib.loads(text)
    else:
        body = body | {"spacing": 5e-324}
    start = time.process_time()
    try:
        Scene.from_dict(table | {"body": [table["body"][0], body]})
        said = "accepted"
    except PockmarkError as error:
        said = str(error)
    print(f"{time.process_time() - start:.2f} {said}")
"""


def test_a_forgotten_unit_is_answered_at_once_and_in_little_memory():
    texts = ["", *(text for text, _ in FORGOTTEN)]
    command = [sys.executable, "-c", LIMITED, str(GROUP.parent / "quick.toml"), *texts]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    print(done.stdout, done.stderr)
    assert done.returncode == 0
    answers = done.stdout.splitlines()
    assert len(answers) == len(texts)
    for answer, (_, sentence) in zip(
        answers, [("", "nearer to 0 than any quantity"), *FORGOTTEN], strict=True
    ):
        assert sentence in answer
        assert float(answer.split()[0]) < 2


def one_by_one(lower, upper, radius, number, seed):
    """Places as they were first drawn: all tries of a ball at once, each held against every place before."""
    low, high = np.asarray(lower) + radius, np.asarray(upper) - radius
    generator = np.random.default_rng(seed)
    places = np.empty((0, 2))
    for _ in range(number):
        tried = generator.uniform(low, high, (TRIES, 2))
        clear = np.ones(TRIES, dtype=bool)
        for place in places:
            clear &= ((tried - place) ** 2).sum(axis=1) >= (2 * radius) ** 2
        if not clear.any():
            return len(places)
        places = np.vstack([places, tried[np.argmax(clear)]])
    return [tuple(place) for place in places.tolist()]


@pytest.mark.parametrize("upper", [(50e-6, 50e-6), (50e-6, 17e-6), (-33e-6, 50e-6)])
@pytest.mark.parametrize(
    ("radius", "number"), [(4e-6, 9), (8e-6, 8), (2e-6, 40), (1e-9, 40), (4e-6, 1), (3.5e-6, 80)]
)
def test_a_seed_keeps_its_places(radius, number, upper):
    lower = (-50e-6, 0.0)
    for seed in (1, 10**18):
        expected = one_by_one(lower, upper, radius, number, seed)
        if isinstance(expected, int):
            with pytest.raises(ValueError, match=f"found places for {expected} of {number} balls"):
                at_random(lower, upper, radius, number, seed)
        else:
            assert at_random(lower, upper, radius, number, seed) == expected


def test_a_patch_too_full_is_told():
    with pytest.raises(PockmarkError, match=r"found places for \d+ of 60 balls 1.6e-05 m wide"):
        Scene.from_dict(random_group(60))
