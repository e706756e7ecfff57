"""The scene: everything a user decides about a run, SI inside. The defaults of pockmark live here."""

import hashlib
import itertools
import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from .bodies import Block, Body, Sphere, Vector, overlap
from .errors import PockmarkError
from .materials import Material, Model, complete
from .overrides import override
from .sentences import sentence
from .toml import to_toml
from .units import Angle, Length, Number, Speed, Time

FaceKind = Literal["free", "symmetry", "fixed", "transmitting"]
FACES = ("x_lower", "x_upper", "y_lower", "y_upper", "z_lower", "z_upper")
MAX_CELLS = 2**31  # what the core can number, with its rim of extra nodes


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
    def corner(self) -> tuple[float, ...]:
        """The upper corner after rounding to whole cells, m."""
        return tuple(w + n * self.cell for w, n in zip(self.lower, self.cells, strict=True))

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        if min(u - w for w, u in zip(self.lower, self.upper, strict=True)) <= 0:
            raise ValueError("upper must exceed lower in each direction")
        if self.cell_count > MAX_CELLS:
            raise ValueError(
                f"a cell of {self.cell:g} m makes {self.cell_count:.3g} cells, at most {MAX_CELLS} fit"
            )
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
    angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = 0.0

    @property
    def velocity(self) -> tuple[float, float, float]:
        """m/s."""
        return self.speed * math.sin(self.angle), 0.0, -self.speed * math.cos(self.angle)


class Numerics(Model):
    """The method. The defaults are the ones compared in studies/robustness."""

    scheme: Literal["usf", "musl", "usl", "usavg"] = "usavg"
    shape_functions: Literal["trilinear", "quadratic"] = "trilinear"
    cfl: Annotated[Number, Field(gt=0, le=1)] = 0.5
    strain_limit: Annotated[Number, Field(gt=0, le=1)] = 0.2
    pic_fraction: Annotated[Number, Field(ge=0, le=1)] = 0.0
    mass_cutoff: Annotated[Number, Field(ge=0, le=1)] = 0.0
    precision: Literal["double", "single"] = "double"


class Output(Model):
    """How often a run writes: time between snapshots and between rows of the history."""

    snapshots: Annotated[Time, Field(gt=0)] = 1e-7
    history: Annotated[Time, Field(gt=0)] = 2e-9


class Scene(Model):
    """One run, complete: a scene saved and loaded again is the same object and gives the same run."""

    title: str = ""
    end_time: Annotated[Time, Field(gt=0)]
    grid: Grid
    boundary: Boundary = Boundary()
    impact: Impact
    body: Annotated[tuple[Body, ...], Field(min_length=1)]
    materials: dict[str, Material]
    numerics: Numerics = Numerics()
    output: Output = Output()

    @classmethod
    def load(cls, path: str | Path, overrides: str | Sequence[str] = ()) -> "Scene":
        """Read a TOML scene; `overrides` are texts "key.key=value", or one such. Raises PockmarkError."""
        try:
            table = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        except OSError as error:
            raise PockmarkError(f"{path}: cannot be read ({error.strerror})") from None
        except UnicodeDecodeError:
            raise PockmarkError(f"{path}: is not a text file") from None
        except (ValueError, RecursionError) as error:  # not only TOMLDecodeError: a number of 5000 digits
            raise PockmarkError(f"{path}: is not TOML ({error})") from None
        return cls.from_dict(table, source=str(path), overrides=overrides)

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

    @model_validator(mode="after")
    def _can_be_saved(self) -> Self:
        try:
            self.to_toml().encode()
        except UnicodeEncodeError as error:
            raise ValueError(f"found {error.object[error.start]!r} in a text, expected Unicode") from None
        return self

    @model_validator(mode="after")
    def _bodies_fit(self) -> Self:
        for name, material in self.materials.items():
            _check_laws(name, material)
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

    def _check_inside(self, key: str, body: Block | Sphere) -> None:
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
        return self.model_dump(mode="json")

    def to_toml(self) -> str:
        """The scene as TOML with every default written out, SI numbers."""
        return to_toml(self.to_dict())

    def save(self, path: str | Path) -> None:
        """Write to_toml() to a file."""
        Path(path).write_text(self.to_toml(), encoding="utf-8")

    @property
    def hash(self) -> str:
        """Identifies what is computed: the same for equal scenes."""
        return hashlib.sha256(json.dumps(self.to_dict(), sort_keys=True).encode()).hexdigest()[:16]

    @property
    def projectiles(self) -> tuple[int, ...]:
        """Indices of the projectile bodies."""
        return tuple(i for i, b in enumerate(self.body) if b.projectile)

    @property
    def targets(self) -> tuple[int, ...]:
        """Indices of the other bodies."""
        return tuple(i for i, b in enumerate(self.body) if not b.projectile)

    @property
    def mirrors(self) -> tuple[Mirror, ...]:
        """The symmetry planes across the surface; what lies behind them is not computed."""
        return tuple(
            Mirror(i // 2, at=(self.grid.lower, self.grid.corner)[i % 2][i // 2], above=bool(i % 2))
            for i, kind in enumerate(self.boundary.faces[:4])
            if kind == "symmetry"
        )


def _check_laws(name: str, material: Material) -> None:
    """The core's own check of each law's constants. Raises ValueError."""
    try:
        material.to_core()
    except ValueError as error:
        raise ValueError(f"materials.{name}: {error}") from None


def _materials_used(table: Mapping[str, Any]) -> dict[str, Any]:
    """Complete tables of the materials that the bodies name and of those written in the scene."""
    written = table.get("materials", {})
    bodies = table.get("body", [])
    if not isinstance(written, Mapping):
        raise PockmarkError(f"materials: found {written!r}, expected a table")
    if not isinstance(bodies, Sequence):
        bodies = []  # validation tells
    names = [b["material"] for b in bodies if isinstance(b, Mapping) and isinstance(b.get("material"), str)]
    return {name: complete(name, written.get(name)) for name in dict.fromkeys([*names, *written])}
