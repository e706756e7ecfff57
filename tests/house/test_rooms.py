"""The house stands as ARCHITECTURE.md draws it: rooms with one direction, measures without the core, names that are there."""

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pockmark

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "pockmark"
ROOMS = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}


def drawn():
    """Return the arrows of the drawing of the rooms, as pairs."""
    text = (ROOT / "ARCHITECTURE.md").read_text()
    drawing = text[text.index("## The rooms") :].split("```")[1]
    return set(re.findall(r"(\w+) ─+▶ (?=(\w+))", drawing))


def imported():
    """Return the imports between rooms, as pairs with a file that has one."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        module = path.relative_to(PACKAGE).with_suffix("").parts
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                named = [alias.name for alias in node.names]
                assert not any(name.split(".")[0] == "pockmark" for name in named), path
            if not isinstance(node, ast.ImportFrom):
                continue
            assert not (node.module or "").startswith("pockmark"), path
            if node.level == len(module):
                others = [node.module] if node.module else [alias.name for alias in node.names]
                for other in (name.split(".")[0] for name in others):
                    if other != module[0] and (node.module or other in ROOMS) and not other.startswith("_"):
                        found[module[0], other] = path.name
    return {pair: name for pair, name in found.items() if len(pair[0]) and not pair[0].startswith("_")}


def below(room, arrows):
    """Return the rooms that arrows lead to from a room: that room, too, if they lead round."""
    found = set()
    while more := {b for a, b in arrows if a in {room, *found}} - found:
        found |= more
    return found


def test_the_rooms_are_as_they_are_drawn():
    arrows, found = drawn(), imported()
    assert {room for pair in arrows for room in pair} == ROOMS
    assert not [room for room in ROOMS if room in below(room, arrows)], "the arrows lead round"
    for (room, other), file in found.items():
        assert other in below(room, arrows), f"{room}/{file} imports {other}, to which no arrow leads"
        assert room not in below(other, arrows), f"{room} and {other} import each other"
    assert all(arrow in found for arrow in arrows), "an arrow is drawn that nothing is imported along"


def test_a_shape_costs_a_file_and_a_line():
    """Nothing outside of the bodies asks what kind a body is."""
    kinds = re.compile(r"\b(Block|Sphere|Swarm|Cylinder)\b")
    for path in PACKAGE.rglob("*.py"):
        if path.parent.name != "bodies":
            assert not kinds.search(re.sub(r'""".*?"""', "", path.read_text(), flags=re.S)), path


WITHOUT_THE_CORE = """
import importlib, pkgutil, sys
for name in ("_core", "_core_scalar", "_core_avx2", "_core_avx512"):
    sys.modules[f"pockmark.{name}"] = None  # an import of it fails
import numpy as np
import pockmark.metrology
for module in pkgutil.iter_modules(pockmark.metrology.__path__):
    importlib.import_module(f"pockmark.metrology.{module.name}")
from pockmark.base.geometry import Mirror, Setup, Wall
from pockmark.base.ledger import LEDGER
from pockmark.metrology.measures import measures
um, h = 1e-6, 2e-6
axes = [np.arange(low, high, 1.0) + 0.5 for low, high in ((-40, 40), (0, 40), (-40, 0))]
x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
x = x[np.hypot(x[:, 0], x[:, 1]) ** 2 / 12**2 + (x[:, 2] / 10) ** 2 > 1] * um
n = len(x)
snapshot = {"position": x, "velocity": np.zeros((n, 3)), "mass": np.full(n, 1e-15), "volume": np.full(n, um**3)}
snapshot |= {"body": np.zeros(n, dtype=np.uint8), "time": np.zeros(1)}
wall = Wall((0,), (-40 * um, 0.0, -40 * um), (40 * um, 40 * um, 0.0), h, "transmitting")
setup = Setup(h, (Mirror(1, 0.0, above=False),), ("target",), wall=wall, walls=((0,),), tops=(0.0,))
table = measures(snapshot, setup, dict.fromkeys(LEDGER, 1.0), {}, {}, {})
assert not [m for m in sys.modules if m.startswith(("pockmark.scene", "pockmark.run", "matplotlib", "pydantic", "pint"))]
print(table["crater"]["depth"] / um, table["crater"]["diameter"] / um)
"""


def test_a_crater_is_measured_without_the_core():
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_THE_CORE], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    depth, diameter = map(float, run.stdout.split())
    print(f"C_p {depth:.2f} of 10 um, D_c {diameter:.2f} of 24 um")
    assert abs(depth - 10) < 1
    assert abs(diameter - 24) < 1


def test_the_tests_that_the_documents_name_are_there():
    for document in [*(ROOT / "docs").glob("*.md"), *ROOT.glob("*.md")]:
        for path, test in re.findall(
            r"`(?:tests/)?((?:\w+/)+test_\w+\.py)(?:::(\w+))?", document.read_text()
        ):
            assert (ROOT / "tests" / path).exists(), f"{document.name}: {path}"
            assert f"def {test}" in (ROOT / "tests" / path).read_text(), f"{document.name}: {path}::{test}"


def test_an_addition_costs_the_lines_that_are_told():
    found = re.findall(r"`([\w/]+\.\w+)`, (\d+)", (ROOT / "docs" / "contributing.md").read_text())
    assert len(found) >= 10
    for path, lines in found:
        now = (ROOT / path).read_text().count("\n")
        assert abs(now - int(lines)) <= 0.1 * now, (
            f"{path} has {now} lines, docs/contributing.md says {lines}"
        )


def test_what_is_public_is_there():
    assert all(getattr(pockmark, name) is not None for name in pockmark.__all__)
    for room in PACKAGE.glob("*/__init__.py"):
        importlib.import_module(f"pockmark.{room.parent.name}")
    assert callable(pockmark.measure)  # no room hides a function by its name
    assert callable(pockmark.run_scene)
