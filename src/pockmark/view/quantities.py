"""The quantities that pictures show: how each follows from the fields, its unit, its colours, its range.

All maps are safe for the colour-blind. Those of a quantity without a sign become lighter all the way; that of the
pressure becomes darker to both sides of 0.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from ..base.errors import PockmarkError, nearest, shown
from ..metrology.stress import effective_stress

Array = NDArray[np.float64]
Fields = Mapping[str, NDArray[Any]]  # of a snapshot
PERCENTILES = (0.2, 99.8)  # of what is drawn: a few odd points do not decide about all the colours


@dataclass(frozen=True)
class Quantity:
    """A scalar of each point.

    `field` is what it is made of, by `of`, SI; `size` is its unit in SI. `kind` says where its colours begin and end:
    "up" from 0, "both" at equal distances from 0, "share" at 0 and 1, "any" where the content does. `paper` is the
    range of Liu et al. 2015, in its unit.
    """

    name: str
    unit: str
    size: float
    field: str
    colours: str
    kind: str
    of: Callable[[Array], Array] = np.asarray
    paper: tuple[float, float] | None = None

    def values(self, snapshot: Fields, which: Any = slice(None)) -> Array:
        """Return the quantity of some points in its unit. Raises PockmarkError if the snapshot lacks its field."""
        if self.field not in snapshot:
            made = "" if self.name.replace(" ", "_") == self.field else f", of which {self.name} is made"
            raise PockmarkError(f"the snapshot lacks the field {self.field}{made}")
        values = np.asarray(self.of(np.asarray(snapshot[self.field])[which]) / self.size, dtype=np.float64)
        return values.clip(0.0, 1.0) if self.kind == "share" else values

    def span(self, drawn: Array) -> Normalize:
        """Return the range of the colours, by the percentiles of what is drawn."""
        drawn = np.asarray(drawn)[np.isfinite(drawn)]
        low, high = map(float, np.percentile(drawn, PERCENTILES)) if len(drawn) else (0.0, 0.0)
        if self.kind == "share":
            low, high = 0.0, 1.0
        elif self.kind == "up":
            low = 0.0
        elif self.kind == "both":
            high = max(-low, high)
            low = -high
        least = 1e-6 * max(abs(low), abs(high))  # all alike: what differs is rounding
        if not high - low > least:
            low, high = (low, low + 1.0) if self.kind == "up" else (low - 0.5, high + 0.5)
        return Normalize(low, high)


def _speed(velocity: Array) -> Array:
    """Return the speed (n,) of velocities (n, 3)."""
    return np.asarray(np.linalg.norm(velocity, axis=1))


STRESS = Quantity("effective stress", "MPa", 1e6, "deviator", "viridis", "up", effective_stress, (0.0, 600.0))
PRESSURE = Quantity("pressure", "MPa", 1e6, "pressure", "coolwarm", "both", paper=(-600.0, 600.0))
TEMPERATURE = Quantity("temperature", "K", 1.0, "temperature", "inferno", "any")
STRAIN = Quantity("plastic strain", "", 1.0, "plastic_strain", "viridis", "up")
DAMAGE = Quantity("damage", "", 1.0, "damage", "cividis", "share")
SPEED = Quantity("speed", "m/s", 1.0, "velocity", "viridis", "up", _speed)
QUANTITIES = {
    one.name.replace(" ", "_"): one for one in (STRESS, PRESSURE, TEMPERATURE, STRAIN, DAMAGE, SPEED)
}
HEIGHT = Quantity("height", "um", 1e-6, "height", "cividis", "any")  # of a surface, not of points


def present(snapshot: Fields) -> dict[str, Array]:
    """Return the values (n,) of the quantities that a snapshot has, by their names, the pressure first."""
    ordered = dict.fromkeys((PRESSURE, *QUANTITIES.values()))
    return {one.name: one.values(snapshot) for one in ordered if one.field in snapshot}


def quantity_of(name: str) -> Quantity:
    """Return a quantity by its name. Raises PockmarkError for an unknown one."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    like = f" (did you mean {close[0]}?)" if (close := nearest(name, QUANTITIES)) else ""
    raise PockmarkError(f"field: found {shown(name, 40)}, expected one of {', '.join(QUANTITIES)}{like}")
