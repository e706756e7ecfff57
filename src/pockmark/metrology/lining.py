"""The lining: the projectile's material that is left in the crater."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.measure import points_in_poly

from ..base.geometry import Setup
from .crater import FIT_RADIUS, Crater
from .surface import with_images


def lining(snapshot: Mapping[str, NDArray[Any]], crater: Crater, setup: Setup) -> tuple[float, float]:
    """Return the lining's mass (kg, of the whole impact) and its thickness at the bottom (m).

    The mass is that of the projectile's points below z = 0 within the pithead. The thickness is the volume of those
    below z = 0 within three spacings of the bottom, seen from above, over the area of that circle.
    """
    left = np.isin(snapshot["body"], setup.projectiles) & (snapshot["position"][:, 2] < 0)
    position = snapshot["position"][left]
    amounts = np.stack([snapshot[key][left] for key in ("mass", "volume")], axis=1)
    for mirror in setup.mirrors:
        position, amounts = with_images(position, amounts, mirror)
    mass, volume = amounts.T
    within = np.zeros(len(position), dtype=bool)
    if crater.contour is not None:
        within = points_in_poly(position[:, :2], crater.contour)  # type: ignore[no-untyped-call]
    radius = FIT_RADIUS * setup.spacing
    near = np.hypot(position[:, 0] - crater.bottom[0], position[:, 1] - crater.bottom[1]) < radius
    return float(mass[within].sum()), float(volume[near].sum() / (np.pi * radius**2))
