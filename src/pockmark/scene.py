"""The scene: everything a user decides about a run, SI inside. The defaults of pockmark live here."""

import hashlib
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from .bodies import Body, Sphere, Swarm, Vector, overlap, require_size
from .errors import PockmarkError, found
from .lattice import count, size
from .materials import Material, Model, complete
from .overrides import override
from .sentences import sentence
from .toml import read_toml, to_toml
from .units import Angle, Length, Number, Speed, Time

FaceKind = Literal["free", "symmetry", "fixed", "transmitting"]
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
MAX_NODES = MAX_POINTS = 2**32 - 2  # what the core can number
MAX_BODIES = 255
MAX_STEPS = 1e9  # years
MAX_OUTPUTS = 1e6


class Grid(Model):
    """The background grid: a box of cubic cells. The upper corner is rounded up to whole cells."""

    lower: Vector
    upper: Vector
    cell: Annotated[Length, Field(gt=0)]

    @property
    def cells(self) -> tuple[int, int, int]:
        """Number of cells along x, y, z."""
        x, y, z = (math.ceil((u - w) / self.cell - 1e-9) for w, u in zip(self.lower, self.upper, strict=True))
        return x, y, z

    @property
    def cell_count(self) -> int:
        """Number of cells."""
        return math.prod(self.cells)

    @property
    def node_count(self) -> int:
        """Number of nodes, with the rim around the cells."""
        return math.prod(n + 3 for n in self.cells)

    @property
    def corner(self) -> tuple[float, ...]:
        """The upper corner after rounding to whole cells, m."""
        return tuple(w + n * self.cell for w, n in zip(self.lower, self.cells, strict=True))

    @property
    def box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lower and upper corners, m."""
        return self.lower, self.corner

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        require_size(self.lower, self.upper)
        # With the rim around them; in floats, which may be infinite where no whole number is.
        nodes = math.prod((u - w) / self.cell + 4 for w, u in zip(self.lower, self.upper, strict=True))
        if not nodes <= MAX_NODES:
            raise ValueError(f"a cell of {self.cell:g} m makes {nodes:.3g} nodes, at most {MAX_NODES} fit")
        return self


class Boundary(Model):
    """What each face of the grid does."""

    x_lower: FaceKind = "transmitting"
    x_upper: FaceKind = "transmitting"
    y_lower: FaceKind = "symmetry"
    y_upper: FaceKind = "transmitting"
    z_lower: FaceKind = "transmitting"
    z_upper: FaceKind = "free"

    @property
    def faces(self) -> tuple[FaceKind, ...]:
        """The six faces in the core's order."""
        return (self.x_lower, self.x_upper, self.y_lower, self.y_upper, self.z_lower, self.z_upper)


@dataclass(frozen=True)
class Mirror:
    """A symmetry plane at coordinate `at` (m) of an axis; `above`: it is the upper face of what is computed."""

    axis: int
    at: float
    above: bool


class Impact(Model):
    """Velocity of the projectile bodies: speed, and angle from the normal of the surface towards +x."""

    speed: Annotated[Speed, Field(ge=0)]
    angle: Angle = 0.0

    @field_validator("angle")
    @classmethod
    def _comes_from_above(cls, angle: float) -> float:
        if not 0 <= angle < math.pi / 2:
            raise ValueError(f"found {math.degrees(angle):g} deg, expected 0 deg to less than 90 deg")
        return angle

    @property
    def velocity(self) -> tuple[float, float, float]:
        """m/s."""
        return self.speed * math.sin(self.angle), 0.0, -self.speed * math.cos(self.angle)


class Contact(Model):
    """Contact of the projectile bodies with all others; without it what shares a node sticks together."""

    friction: Annotated[Number, Field(ge=0, le=10)]


class Numerics(Model):
    """The method. The defaults are the ones compared in studies/README.md."""

    scheme: Literal["usf", "musl", "usl", "usavg"] = "usavg"
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    cfl: Annotated[Number, Field(gt=0, le=1)] = 0.5
    strain_limit: Annotated[Number, Field(gt=0, le=1)] = 0.2
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] = 0.0
    mass_cutoff: Annotated[Number, Field(ge=0, le=1)] = 0.0
    precision: Literal["double", "single"] = "double"


class Output(Model):
    """How often a run writes: time between snapshots, hit exactly, and between rows of the history, written with the first step at or beyond."""

    snapshots: Annotated[Time, Field(gt=0)] = 1e-7
    history: Annotated[Time, Field(gt=0)] = 2e-9


class Scene(Model):
    """One run, complete: a scene saved and loaded again is the same object and gives the same run."""

    title: str = ""
    end_time: Annotated[Time, Field(gt=0)]
    grid: Grid
    boundary: Boundary = Boundary()
    impact: Impact
    materials: dict[str, Material]
    body: Annotated[
        tuple[Body, ...], Field(min_length=1)
    ]  # after the materials, whose density a swarm's flux needs
    contact: Contact | None = None
    numerics: Numerics = Numerics()
    output: Output = Output()

    @classmethod
    def load(cls, path: str | Path, overrides: str | Sequence[str] = ()) -> "Scene":
        """Read a TOML scene; `overrides` are texts "key.key=value", or one such. Raises PockmarkError."""
        return cls.from_dict(read_toml(path), source=str(path), overrides=overrides)

    @classmethod
    def from_dict(
        cls, table: Mapping[str, Any], *, source: str = "scene", overrides: str | Sequence[str] = ()
    ) -> "Scene":
        """Build a scene from a table as TOML gives it. Raises PockmarkError naming `source` and the key."""
        try:
            merged = dict(table)
            for text in [overrides] if isinstance(overrides, str) else overrides:
                merged = override(merged, text)
            merged["materials"] = _materials_used(merged)
            return cls.model_validate(merged)
        except ValidationError as error:
            raise PockmarkError(f"{source}: {sentence(error)}") from None
        except PockmarkError as error:
            raise PockmarkError(f"{source}: {error}") from None

    @field_validator("body")
    @classmethod
    def _swarms_are_resolved(cls, bodies: tuple[Body, ...], known: ValidationInfo) -> tuple[Body, ...]:
        materials = known.data.get("materials", {})  # none if they are faulty themselves
        return tuple(
            _resolved(body, materials[body.material].density)
            if isinstance(body, Swarm) and body.material in materials
            else body
            for body in bodies
        )

    @model_validator(mode="after")
    def _can_be_saved(self) -> Self:
        try:
            self.to_toml().encode()
        except UnicodeEncodeError as error:
            raise ValueError(f"found {error.object[error.start]!r} in a text, expected Unicode") from None
        return self

    @model_validator(mode="after")
    def _bodies_fit(self) -> Self:
        if len(self.body) > MAX_BODIES:
            raise ValueError(f"body: found {len(self.body)} bodies, at most {MAX_BODIES} are allowed")
        names = [b.name for b in self.body]
        for i, b in enumerate(self.body):
            key = f"body[{i}] '{b.name}'"
            if names.count(b.name) > 1:
                raise ValueError(f"{key}: two bodies have this name")
            self._check_inside(key, b)
        for (i, a), (j, b) in itertools.combinations(enumerate(self.body), 2):
            if overlap(a, b):
                raise ValueError(f"body[{j}] '{b.name}': overlaps body[{i}] '{a.name}'")
        return self

    @model_validator(mode="after")
    def _contact_has_two_sides(self) -> Self:
        if self.contact and not (self.projectiles and self.targets):
            raise ValueError("contact: needs a body with projectile = true and one without")
        if self.contact and 2 * self.grid.node_count > MAX_NODES:
            nodes = 2 * self.grid.node_count
            raise ValueError(f"contact: doubles the nodes to {nodes:.3g}, at most {MAX_NODES} fit")
        return self

    @model_validator(mode="after")
    def _points_fit(self) -> Self:
        total = 0.0
        for i, body in enumerate(self.body):
            key = f"body[{i}] '{body.name}': a spacing of {body.spacing:g} m"
            total += size(body)
            if not total <= MAX_POINTS:
                raise ValueError(f"{key} makes {size(body):.3g} points, at most {MAX_POINTS} fit")
            if count(body, self.grid.box) == 0:
                raise ValueError(f"{key} leaves it without points")
        return self

    @model_validator(mode="after")
    def _comes_to_an_end(self) -> Self:
        for name, material in self.materials.items():
            _check_laws(name, material)
        if not self.steps_about <= MAX_STEPS:
            raise ValueError(
                f"end_time: {self.end_time:g} s takes about {self.steps_about:.3g} steps with waves of {self.wave_speed:.3g} "
                f"m/s in cells of {self.grid.cell:g} m, at most {MAX_STEPS:.0e} are allowed"
            )
        for key, interval in self.output.model_dump().items():
            if interval < self.end_time / MAX_OUTPUTS:
                least = f"at least end_time/{MAX_OUTPUTS:.0e} = {self.end_time / MAX_OUTPUTS:g} s is needed"
                raise ValueError(f"output.{key}: found {interval:g} s, {least}")
        return self

    def _check_inside(self, key: str, body: Body) -> None:
        """A body lies in the grid; a sphere may be cut by a symmetry plane through its centre."""
        tolerance = 1e-9 * self.grid.cell
        lower, upper = body.box
        for face, kind in zip(FACES, self.boundary.faces, strict=True):
            axis, is_upper = FACES.index(face) // 2, face.endswith("upper")
            limit = self.grid.corner[axis] if is_upper else self.grid.lower[axis]
            beyond = upper[axis] - limit if is_upper else limit - lower[axis]
            if beyond <= tolerance:
                continue
            if (
                kind == "symmetry"
                and isinstance(body, Sphere)
                and abs(body.center[axis] - limit) <= tolerance
            ):
                continue
            raise ValueError(f"{key}: reaches {beyond * 1e6:.4g} um outside the grid's face {face}")

    def to_dict(self) -> dict[str, Any]:
        """Plain tables, SI numbers: from_dict gives the same scene back."""
        return self.model_dump(mode="json", exclude_none=True)

    def to_toml(self) -> str:
        """The scene as TOML with every default written out, SI numbers."""
        return to_toml(self.to_dict())

    def save(self, path: str | Path) -> None:
        """Write to_toml() to a file."""
        Path(path).write_text(self.to_toml(), encoding="utf-8")

    @property
    def hash(self) -> str:
        """Identifies what is computed: the same for scenes that are equal but for their titles."""
        return hash_of(self.to_dict())

    @property
    def projectiles(self) -> tuple[int, ...]:
        """Indices of the projectile bodies."""
        return tuple(i for i, b in enumerate(self.body) if b.projectile)

    @property
    def targets(self) -> tuple[int, ...]:
        """Indices of the other bodies."""
        return tuple(i for i, b in enumerate(self.body) if not b.projectile)

    @property
    def wave_speed(self) -> float:
        """The fastest sound at rest, and the projectile's speed, m/s."""
        return max(m.dilatational_speed for m in self.materials.values()) + self.impact.speed

    @property
    def steps_about(self) -> float:
        """About how many steps a run takes; infinite for absurd materials."""
        # Shocked material is faster and strain limits some steps: 1.35 is what model 1 needed.
        return 1.35 * self.end_time / self.numerics.cfl / self.grid.cell * self.wave_speed

    @property
    def mirrors(self) -> tuple[Mirror, ...]:
        """The symmetry planes across the surface; what lies behind them is not computed."""
        return tuple(
            Mirror(i // 2, at=(self.grid.lower, self.grid.corner)[i % 2][i // 2], above=bool(i % 2))
            for i, kind in enumerate(self.boundary.faces[:4])
            if kind == "symmetry"
        )


def hash_of(table: Mapping[str, Any], *, titled: bool = False) -> str:
    """Return what identifies a scene's table, 16 hexadecimal digits; the title is a part of it only if `titled`."""
    hashed = {key: value for key, value in table.items() if titled or key != "title"}
    return hashlib.sha256(json.dumps(hashed, sort_keys=True, default=str).encode()).hexdigest()[:16]


def _check_laws(name: str, material: Material) -> None:
    """The core's own check of each law's constants. Raises ValueError."""
    try:
        material.to_core()
    except ValueError as error:
        raise ValueError(f"materials.{name}: {error}") from None


def _resolved(swarm: Swarm, density: float) -> Swarm:
    """With what follows from its flux, its balls known to fit."""
    try:
        swarm = swarm.resolved(density)
        if not swarm.centers:
            raise ValueError(
                "has no ball: the patch is smaller than a pitch, or the flux less than one ball's"
            )
    except ValueError as error:
        raise ValueError(f"'{swarm.name}': {error}") from None
    return swarm


def _materials_used(table: Mapping[str, Any]) -> dict[str, Any]:
    """Complete tables of the materials that the bodies name and of those written in the scene."""
    written = table.get("materials", {})
    bodies = table.get("body", [{}])
    if not isinstance(written, Mapping):
        raise PockmarkError(f"materials: {found(written)}, expected a table")
    if not isinstance(bodies, list | tuple) or not bodies:
        raise PockmarkError(f"body: {found(bodies)}, expected one [[body]] or more")
    users: dict[str, str] = dict.fromkeys(written, "")
    for i, body in enumerate(bodies):
        if not isinstance(body, Mapping):
            raise PockmarkError(f"body[{i}]: {found(body)}, expected a table")
        if isinstance(name := body.get("material"), str):
            users.setdefault(name, f"body[{i}].material")
    return {name: complete(name, written.get(name), user) for name, user in users.items()}
