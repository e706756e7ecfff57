"""Scaling of crater depth with flux and speed: Liu et al. 2015, Section 4.3."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import curve_fit
from scipy.stats import t as student

Array = NDArray[np.float64]


def energy_flux(flux: float, speed: float, angle: float = 0.0) -> tuple[float, float]:
    """Return E_f and its normal part E_f^n, J/m^2 (Liu et al. 2015, Eqs. 25, 26).

    `flux` is in kg/m^2, `speed` in m/s, `angle` from the normal in rad.
    """
    total = 0.5 * flux * speed**2
    return total, total * math.cos(angle) ** 2


def group_depth(flux: float, normal_speed: float) -> float:
    """Return the depth C_p of a group's craters, m (Liu et al. 2015, Eq. 33, which is in mm, ms, g).

    `flux` is in kg/m^2; `normal_speed` is v_p cos(theta), m/s. The depth is 0 up to the threshold of 422.5 m/s. The
    equation is for Al 2024 on Al 2024 in the paper's pattern, 625 um^2 a sphere.
    """
    beyond = max(normal_speed - 422.5, 0.0)  # mm/ms are m/s
    return 1e-3 * 4.896e-4 * math.cbrt(flux * 1e-3) * math.pow(beyond, 0.9234)  # 1 kg/m^2 is 1e-3 g/mm^2


@dataclass(frozen=True)
class Fit:
    """A power law of crater depths: C_p/d_p = factor ((v_n - threshold) sqrt(rho/Y))^exponent.

    `threshold` is in m/s. `intervals` are the half-widths of the 95 % intervals of the three constants. `goodness` is
    R^2.
    """

    factor: float
    threshold: float
    exponent: float
    intervals: tuple[float, float, float]
    goodness: float

    def __call__(self, normal_speed: Array, root: float) -> Array:
        """Return C_p/d_p (n,) at normal speeds (n,), m/s; `root` is sqrt(rho/Y), s/m."""
        return _power(normal_speed * root, self.factor, self.threshold * root, self.exponent)


def fit_depth(normal_speed: Array, depth_over_diameter: Array, *, density: float, strength: float) -> Fit:
    """Fit the constants of Liu et al. 2015, Eqs. 31 and 32, to n > 3 depths.

    `normal_speed` (n,) is v_p cos(theta), m/s; `depth_over_diameter` (n,) is C_p/d_p. `density` (kg/m^3) and
    `strength` (Pa) are the target's. Raises ValueError for fewer depths, RuntimeError if the fit does not converge.
    """
    if len(normal_speed) <= 3:
        raise ValueError(f"found {len(normal_speed)} depths, a fit of three constants needs at least 4")
    root = math.sqrt(density / strength)
    x, y = normal_speed * root, depth_over_diameter
    start = (float(y.max() / x.max()), 0.5 * float(x.min()), 1.0)
    bounds = ((0.0, 0.0, 0.1), (np.inf, float(x.min()), 3.0))
    best, covariance = curve_fit(_power, x, y, p0=start, bounds=bounds)
    error = y - _power(x, *best)
    goodness = 1 - float(error @ error) / float(((y - y.mean()) ** 2).sum())
    widths = student.ppf(0.975, len(x) - 3) * np.sqrt(np.diag(covariance))
    return Fit(
        float(best[0]),
        float(best[1]) / root,
        float(best[2]),
        (float(widths[0]), float(widths[1]) / root, float(widths[2])),
        goodness,
    )


def _power(x: Array, factor: float, threshold: float, exponent: float) -> Array:
    """Return factor (x - threshold)^exponent; about 0 at and below the threshold."""
    return np.asarray(factor * np.maximum(x - threshold, 1e-12) ** exponent)
