"""Puts the gallery into the site: a page with each scene and its picture. mkdocs calls it as a hook.

A picture that the tests have not drawn yet is drawn here.
"""

import sys
from pathlib import Path

from mkdocs.structure.files import File

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "house"))
import gallery

HEAD = """# Gallery

Each picture is drawn by the tests, from the scene below it. `pockmark run SCENE --coarse` makes it again.
"""
ENTRY = """
## {title}

{caption}

![{title}](gallery/{name}.png)

??? note "The scene"
    ```toml
{scene}
    ```
"""


def on_files(files, config):
    """Add the page and its pictures to what the site is made of."""
    entries = []
    for scene in gallery.SCENES:
        picture = gallery.OUT / f"{scene.stem}.png"
        if not picture.exists():
            gallery.draw(scene)
        files.append(File.generated(config, f"gallery/{scene.stem}.png", abs_src_path=str(picture)))
        text = scene.read_text(encoding="utf-8").split("\n", 1)[1]
        title = text.split('"')[1]
        caption = gallery.heading(scene)[1]
        lines = "\n".join(f"    {line}" for line in text.rstrip().splitlines())
        entries.append(
            ENTRY.format(title=title, caption=caption[0].upper() + caption[1:], name=scene.stem, scene=lines)
        )
    files.append(File.generated(config, "gallery.md", content=HEAD + "".join(entries)))
    return files
