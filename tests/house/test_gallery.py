"""Each scene of the gallery runs, and its picture shows something. CI's site has the pictures that are drawn here."""

import gallery
import matplotlib.image
import numpy as np
import pytest


def test_there_are_a_dozen_pictures():
    assert len(gallery.SCENES) >= 12
    assert {gallery.heading(scene)[0] for scene in gallery.SCENES} == set(gallery.PICTURES)


@pytest.mark.parametrize("scene", gallery.SCENES, ids=lambda scene: scene.stem)
def test_a_scene_of_the_gallery_makes_a_picture(scene):
    picture, status = gallery.draw(scene)
    assert status == "finished"
    pixels = (255 * matplotlib.image.imread(picture)[..., :3]).astype(np.uint8).reshape(-1, 3)
    colours, counts = np.unique(pixels, axis=0, return_counts=True)
    print(f"{scene.stem}: {len(colours)} colours, {1 - counts.max() / counts.sum():.2f} of it drawn")
    assert len(colours) > 100
    assert counts.max() < 0.9 * counts.sum()
