"""The stress of points, as results and pictures show it."""

import numpy as np
from numpy.typing import NDArray


def effective_stress(deviator: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the von Mises effective stress (n,) of deviators, Pa.

    `deviator` (n, 6), Pa, has the components xx, yy, zz, xy, yz, zx.
    """
    twice = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # off the diagonal each component stands twice in s:s
    return np.asarray(np.sqrt(1.5 * np.einsum("ij,ij,j->i", deviator, deviator, twice)))
