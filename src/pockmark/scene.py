"""The scene: everything a user decides about a run, SI inside. The defaults of pockmark live here."""

import difflib
import hashlib
import itertools
import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from .errors import PockmarkError
from .materials import Material, Model, complete, merge
from .units import Angle, Length, Number, Speed, Time

Vector = tuple[Length, Length, Length]
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


class Block(Model):
    """A brick of material between two corners."""

    shape: Literal["block"]
    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: bool = False
    lower: Vector
    upper: Vector

    @model_validator(mode="after")
    def _has_size(self) -> Self:
        if min(u - w for w, u in zip(self.lower, self.upper, strict=True)) <= 0:
            raise ValueError("upper must exceed lower in each direction")
        return self

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners, m."""
        return self.lower, self.upper


class Sphere(Model):
    """A ball of material. Its radius is rounded to a whole number of point spacings."""

    shape: Literal["sphere"]
    name: str
    material: str
    spacing: Annotated[Length, Field(gt=0)]
    projectile: bool = False
    center: Vector
    radius: Annotated[Length, Field(gt=0)]

    @property
    def box(self) -> tuple[Vector, Vector]:
        """Lower and upper corners of the ball's bounding box, m."""
        x, y, z = self.center
        r = self.radius
        return (x - r, y - r, z - r), (x + r, y + r, z + r)


Body = Annotated[Block | Sphere, Field(discriminator="shape")]


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
    def load(cls, path: str | Path, overrides: Sequence[str] = ()) -> "Scene":
        """Read a TOML scene; `overrides` are texts "key.key=value". Raises PockmarkError."""
        try:
            table = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        except OSError as error:
            raise PockmarkError(f"{path}: cannot be read ({error.strerror})") from None
        except UnicodeDecodeError:
            raise PockmarkError(f"{path}: is not a text file") from None
        except tomllib.TOMLDecodeError as error:
            raise PockmarkError(f"{path}: is not TOML ({error})") from None
        return cls.from_dict(table, source=str(path), overrides=overrides)

    @classmethod
    def from_dict(
        cls, table: Mapping[str, Any], *, source: str = "scene", overrides: Sequence[str] = ()
    ) -> "Scene":
        """Build a scene from a table as TOML gives it. Raises PockmarkError naming `source` and the key."""
        try:
            merged = dict(table)
            for text in overrides:
                merged = merge(merged, _override(text))
            merged["materials"] = _materials_used(merged)
            return cls.model_validate(merged)
        except ValidationError as error:
            raise PockmarkError(f"{source}: {_sentence(error)}") from None
        except PockmarkError as error:
            raise PockmarkError(f"{source}: {error}") from None

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
            if _overlap(a, b):
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
        return _toml(self.to_dict())

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
    def half(self) -> bool:
        """Whether y = 0 is a symmetry plane and half of the space is computed."""
        return self.boundary.y_lower == "symmetry" and self.grid.lower[1] == 0.0


def _check_laws(name: str, material: Material) -> None:
    """The core's own check of each law's constants. Raises ValueError."""
    try:
        material.to_core()
    except ValueError as error:
        raise ValueError(f"materials.{name}: {error}") from None


def _override(text: str) -> dict[str, Any]:
    """ "a.b=value" as nested tables; the value is TOML, or else a plain text."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise PockmarkError(f"--set {text}: expected key=value")
    try:
        out: Any = tomllib.loads(f"v = {value}")["v"]
    except tomllib.TOMLDecodeError:
        out = value.strip()
    for part in reversed(key.strip().split(".")):
        out = {part: out}
    return dict(out)


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


def _overlap(a: Block | Sphere, b: Block | Sphere) -> bool:
    """Whether two bodies share more than a surface."""
    if isinstance(a, Sphere) and isinstance(b, Sphere):
        return math.dist(a.center, b.center) < (a.radius + b.radius) * (1 - 1e-9)
    if isinstance(a, Block) and isinstance(b, Block):
        gaps = [
            max(al, bl) - min(au, bu)
            for al, au, bl, bu in zip(a.lower, a.upper, b.lower, b.upper, strict=True)
        ]
        return max(gaps) < -1e-9 * max(a.spacing, b.spacing)
    sphere, block = (a, b) if isinstance(a, Sphere) else (b, a)
    assert isinstance(sphere, Sphere)
    assert isinstance(block, Block)
    nearest = [min(max(c, w), u) for c, w, u in zip(sphere.center, block.lower, block.upper, strict=True)]
    return math.dist(nearest, sphere.center) < sphere.radius * (1 - 1e-9)


def _sentence(error: ValidationError) -> str:
    """The first fault of a validation as one sentence: key, what was found, what is allowed."""
    first = error.errors()[0]
    key = _key(first["loc"])
    kind, message, found = first["type"], first["msg"].removeprefix("Value error, "), first.get("input")
    if kind == "extra_forbidden":
        near = difflib.get_close_matches(str(first["loc"][-1]), _all_keys(), n=1)
        return f"{key}: unknown key" + (f", did you mean '{near[0]}'?" if near else "")
    if kind == "missing":
        return f"{key}: is missing"
    if kind == "value_error":
        return f"{key}: {message}" if key else message
    return f"{key}: found {found!r}, {message[0].lower()}{message[1:]}"


def _key(location: tuple[int | str, ...]) -> str:
    """("body", 0, "block", "radius") as "body[0].radius"."""
    tags = {"block", "sphere", "mie-gruneisen", "linear", "johnson-cook", "elastic", "fluid"}
    out = ""
    for i, part in enumerate(location):
        if isinstance(part, int):
            out += f"[{part}]"
        elif not (part in tags and i > 0):
            out += f".{part}" if out else part
    return out


def _all_keys() -> list[str]:
    models: list[type[Model]] = [Scene, Grid, Boundary, Block, Sphere, Impact, Numerics, Output, Material]
    return sorted({key for model in models for key in model.model_fields})


def _toml(table: Mapping[str, Any], prefix: str = "") -> str:
    """Minimal TOML writer for the plain tables of a scene (tomllib only reads)."""
    lines = [f"{k} = {_toml_value(v)}" for k, v in table.items() if not _is_table(v)]
    for key, value in table.items():
        path = f"{prefix}{json.dumps(key) if not key.replace('-', '').replace('_', '').isalnum() else key}"
        if isinstance(value, Mapping):
            lines += ["", f"[{path}]", _toml(value, f"{path}.").rstrip("\n")]
        elif _is_table(value):
            for item in value:
                lines += ["", f"[[{path}]]", _toml(item, f"{path}.").rstrip("\n")]
    return "\n".join(lines).lstrip("\n") + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, list):
        return "[" + ", ".join(_toml_value(v) for v in value) + "]"
    return json.dumps(value)
