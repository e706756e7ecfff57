"""The guide as a site: it is built without a warning, and its pages show something in a browser, from the disk."""

import inspect
import io
import subprocess
import sys
from pathlib import Path

import chromium
import numpy as np
import pytest
from chromium import browser
from PIL import Image

pytest.importorskip("mkdocs", reason="no mkdocs here (pip install '.[docs]')")
__all__ = ["browser"]  # a fixture
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    out = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--quiet", "-d", out],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return out


def test_every_public_name_is_in_the_reference(site):
    import pockmark

    text = (site / "api.html").read_text(encoding="utf-8")
    names = [name for name in dir(pockmark) if not inspect.ismodule(getattr(pockmark, name))]
    names = [name for name in names if not name.startswith("_")]
    names += [f"scene.bodies.{name}" for name in ("Block", "Cylinder", "Sphere", "Swarm")]
    missing = [name for name in names if f'id="pockmark.{name}"' not in text]
    print(f"{len(names)} names, missing: {missing}")
    assert not missing


@chromium.NEEDED
@pytest.mark.parametrize("page", ["guide/choosing.html", "gallery.html"])
def test_a_page_shows_something(page, site, browser):
    browser.get((site / page).as_uri())
    pixels = np.asarray(Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("L"))
    print(f"{page}: {len(np.unique(pixels))} shades, {(pixels < 128).mean():.3f} dark")
    assert 0.01 < (pixels < 128).mean() < 0.6
    assert not [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
