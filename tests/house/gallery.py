"""The gallery: `python tests/house/gallery.py` draws a picture of each scene of docs/gallery, in build/gallery.

The first line of a scene says which picture, and what it shows: `# top: craters that touch.`
"""

import sys
import tempfile
from pathlib import Path

from pockmark import Scene, run_scene
from pockmark.run.pictures import figures_of

ROOT = Path(__file__).parents[2]
SCENES = sorted((ROOT / "docs" / "gallery").glob("*.toml"))
OUT = ROOT / "build" / "gallery"
PICTURES = {"slice": "crater.png", "fields": "fields.png", "top": "top.png"}


def heading(scene):
    """Return which picture a scene of the gallery asks for, and its caption."""
    kind, _, caption = scene.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ").partition(": ")
    return kind, caption


def draw(scene, out=OUT):
    """Run a scene and draw its picture. Return the picture and the state in which the run has ended."""
    out.mkdir(parents=True, exist_ok=True)
    picture = out / f"{scene.stem}.png"
    with tempfile.TemporaryDirectory() as folder:
        run, _ = run_scene(Scene.load(scene), Path(folder) / "run", threads=1, progress=False, coarse=True)
        figures_of(run.path)[PICTURES[heading(scene)[0]]]().savefig(picture, dpi=90)
        return picture, run.status()


if __name__ == "__main__":
    for one in SCENES:
        if one.stem in sys.argv[1:] or len(sys.argv) == 1:
            print(*draw(one))
