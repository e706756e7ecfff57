"""A swarm: equal balls of material over a patch."""

import math
from functools import cached_property
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ...base.units import ArealDensity, Length
from .balls import Balls
from .placement import MAX_BALLS, at_random, on_lattice, require_few, sphere_diameter
from .shape import Fit, Vector, require_size

MAX_SEED = 2**63 - 1  # TOML's largest whole number


class Swarm(Balls):
    """A swarm of equal balls of material over a rectangular patch.

    Their centres have one `height`, or there is a `gap` between them and z = 0. They lie on a lattice with a `pitch`,
    or at random places of the patch (`seed`), each ball whole in it and clear of the others. `flux` is the swarm's
    mass over the patch's area. On a lattice it gives the radius (Liu et al. 2015, Eq. 29), at random places the
    number of balls.
    """

    shape: Literal["swarm"] = "swarm"
    """Kind of the body."""
    lower: tuple[Length, Length]
    """Lower corner (x, y) of the patch."""
    upper: tuple[Length, Length]
    """Upper corner (x, y) of the patch."""
    height: Length | None = None
    """Height of the centres; this or gap."""
    gap: Annotated[Length, Field(ge=0)] | None = None
    """Clear height between the balls and z = 0; this or height."""
    pitch: Annotated[Length, Field(gt=0)] | None = None
    """Distance of neighbours on a lattice; this or seed."""
    seed: Annotated[int, Field(strict=True, ge=0, le=MAX_SEED)] | None = None
    """Seed of random places; this or pitch."""
    flux: Annotated[ArealDensity, Field(gt=0)] | None = None
    """Mass of the swarm over the area of the patch: gives the radius on a lattice, else the number."""
    radius: Annotated[Length, Field(gt=0)] | None = None
    """Radius of each ball."""
    number: Annotated[int, Field(strict=True, gt=0, le=MAX_BALLS)] | None = None
    """Number of balls at random places."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        require_size(self.lower, self.upper)
        if (self.height is None) == (self.gap is None):
            raise ValueError("needs either height, of the centres, or gap, the clear height above z = 0")
        if (self.pitch is None) == (self.seed is None):
            raise ValueError("needs either pitch, for balls on a lattice, or seed, for random places")
        if self.pitch is not None and (self.number is not None or (self.flux or self.radius) is None):
            raise ValueError("balls on a lattice need flux or radius, and no number")
        if self.seed is not None and (self.radius is None or (self.flux or self.number) is None):
            raise ValueError("balls at random places need radius, and flux or number")
        return self

    def resolved(self, density: float) -> Self:
        """Return the swarm with what follows from its flux, and with balls that are known to fit.

        `density` is its material's, kg/m^3. Raises ValueError if the flux contradicts what is given, or if the balls
        do not fit.
        """
        swarm = self._filled(density)
        if not swarm.centers:
            raise ValueError(
                "has no ball: the patch is smaller than a pitch, or the flux less than one ball's"
            )
        return swarm

    def _filled(self, density: float) -> Self:
        """Return the swarm with the radius or the number that its flux makes. Raises ValueError."""
        if self.flux is None:
            return self
        if self.pitch is not None:
            diameter = sphere_diameter(self.flux, area=self.pitch**2, number=1, density=density)
            return self._with("radius", diameter / 2)
        area = math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))
        ball = 4 / 3 * math.pi * (self.radius or 0.0) ** 3 * density
        number = self.flux * area / ball if ball else math.inf
        require_few(number)
        return self._with("number", round(number))

    def _with(self, key: str, value: float) -> Self:
        """Return the swarm with a value of a key. Raises ValueError if another value is given."""
        given = getattr(self, key)
        if given is not None and not math.isclose(given, value, rel_tol=1e-9):
            raise ValueError(f"flux makes the {key} {value:.6g}, found {given:.6g}: give one of the two")
        swarm = self.model_copy(update={key: value})
        if given is None:
            swarm.model_fields_set.discard(key)  # it was not written: Scene.with_() lets it follow anew
        return swarm

    @cached_property
    def centers(self) -> tuple[Vector, ...]:
        """Return the centres of the balls, m. Raises ValueError if they do not fit into the patch."""
        radius = max(self.radius or 0.0, self.fit.length)  # clear of each other as written and as filled
        if self.pitch is None:
            places = at_random(self.lower, self.upper, radius, self.number or 0, self.seed or 0)
        elif 2 * radius <= self.pitch * (1 + 1e-9):
            places = on_lattice(self.lower, self.upper, self.pitch)
        else:
            raise ValueError(f"balls {2 * radius:.4g} m wide overlap at a pitch of {self.pitch:.4g} m")
        height = (self.gap or 0.0) + self.fit.length if self.height is None else self.height
        return tuple((x, y, height) for x, y in places)

    @property
    def places(self) -> tuple[Vector, ...]:
        """Return the centres of its balls, m."""
        return self.centers

    @property
    def fit(self) -> Fit:
        """Return how points fill the radius of a ball."""
        return Fit.of(self.radius or 0.0, self.spacing, self.rounded)

    @property
    def written_radius(self) -> float:
        """Return the radius of a ball, m, as it is written or as it follows from the flux."""
        return self.radius or 0.0

    @property
    def neighbours(self) -> float:
        """Return the distance of neighbouring balls, m.

        At random places it is that of a lattice of as many balls.
        """
        if self.pitch is not None:
            return self.pitch
        area = math.prod(u - w for w, u in zip(self.lower, self.upper, strict=True))
        return math.sqrt(area / len(self.centers))
