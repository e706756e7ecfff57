"""The scene: everything a user decides about a run, SI inside. The defaults of pockmark live here."""

import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from ..base import files
from ..base.errors import PockmarkError, found, together
from ..base.files import AnyPath, as_path
from ..base.geometry import Mirror
from ..base.lengths import in_metres
from ..base.toml import read_toml, to_toml
from ..base.units import quantity
from .bodies import Body, Solid, overlap
from .grid import FACES, MAX_NODES, Boundary, Grid
from .impact import Impact
from .materials import Material, complete
from .model import Model
from .numerics import Contact, Numerics, Output
from .overrides import override
from .sentences import faults

MAX_POINTS = 2**32 - 2  # what the core can number
MAX_BODIES = 255
MAX_STEPS = 1e9  # years
MAX_OUTPUTS = 1e6


class Scene(Model):
    """One run, complete: a scene saved and loaded again is the same object and gives the same run."""

    title: str = ""
    end_time: Annotated[float, quantity("s", 1e-18, 1e4)]
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
    def load(cls, path: AnyPath, overrides: str | Sequence[str] = ()) -> "Scene":
        """Read a TOML scene; `overrides` are texts "key.key=value", or one such. Raises PockmarkError."""
        return cls.from_dict(read_toml(path), source=str(path), overrides=overrides)

    @classmethod
    def from_dict(
        cls, table: Mapping[str, Any], *, source: str = "scene", overrides: str | Sequence[str] = ()
    ) -> "Scene":
        """Build a scene from a table as TOML gives it. Raises PockmarkError naming `source` and the key."""
        merged, told = _plain(table, source), []
        for text in [overrides] if isinstance(overrides, str) else overrides:
            try:
                merged = override(merged, text)
            except PockmarkError as error:
                told.append(str(error))
        told += _complete_materials(merged)
        try:
            scene = cls.model_validate(merged)
        except ValidationError as error:
            # Without its materials a scene's tables cannot be held against each other.
            told += faults([fault for fault in error.errors() if fault["loc"] or not told], cls)
        if told:
            raise PockmarkError(f"{source}: {together(told)}")
        return scene

    @field_validator("body", mode="before")
    @classmethod
    def _is_a_list(cls, bodies: Any) -> Any:
        if not isinstance(bodies, list | tuple) or not bodies:
            raise ValueError(f"{found(bodies)}, expected one [[body]] or more")
        return bodies

    @field_validator("body")
    @classmethod
    def _are_resolved(cls, bodies: tuple[Body, ...], known: ValidationInfo) -> tuple[Body, ...]:
        materials = known.data.get("materials", {})  # none if they are faulty themselves
        out: list[Body] = []
        told = []
        for body in bodies:
            try:
                material = materials.get(body.material)
                out.append(body.resolved(material.density) if material else body)
            except ValueError as error:
                told.append(f"'{body.name}': {error}")
        if told:
            raise ValueError(together(told))
        return tuple(out)

    @model_validator(mode="after")
    def _is_sound(self) -> Self:
        """Find every fault that lies between the tables, at once."""
        for i, body in enumerate(self.body):
            if body.material not in self.materials:
                raise ValueError(
                    f"body[{i}].material: {found(body.material)}, which is not among the materials"
                )
        rules = (
            self._can_be_saved,
            self._bodies_fit,
            self._contact_has_two_sides,
            self._bodies_have_points,
            self._symmetry_planes_are_kept,
            self._comes_to_an_end,
        )
        # Points that are too many cannot be looked at.
        told = [*self._points_can_be_numbered()] or [fault for rule in rules for fault in rule()]
        if told:
            raise ValueError(together(told))
        return self

    def _can_be_saved(self) -> Iterator[str]:
        try:
            self.to_toml().encode()
        except UnicodeEncodeError as error:
            yield f"found {error.object[error.start]!r} in a text, expected Unicode"

    def _points_can_be_numbered(self) -> Iterator[str]:
        total = 0.0
        for i, body in enumerate(self.body):
            total += body.points_about
            if not total <= MAX_POINTS:
                key = f"body[{i}] '{body.name}': a spacing of {body.spacing:g} m"
                yield f"{key} makes {body.points_about:.3g} points, at most {MAX_POINTS} fit"
                return

    def _bodies_fit(self) -> Iterator[str]:
        if len(self.body) > MAX_BODIES:
            yield f"body: found {len(self.body)} bodies, at most {MAX_BODIES} are allowed"
            return
        names = [b.name for b in self.body]
        for i, b in enumerate(self.body):
            key = f"body[{i}] '{b.name}'"
            if names.count(b.name) > 1:
                yield f"{key}: two bodies have this name"
            yield from self._outside(key, b)
        for (i, a), (j, b) in itertools.combinations(enumerate(self.body), 2):
            if overlap(a, b):
                yield f"body[{j}] '{b.name}': overlaps body[{i}] '{a.name}'"

    def _contact_has_two_sides(self) -> Iterator[str]:
        if self.contact and not (self.projectiles and self.targets):
            yield "contact: needs a body with projectile = true and one without"
        if self.contact and 2 * self.grid.node_count > MAX_NODES:
            nodes = 2 * self.grid.node_count
            yield f"contact: doubles the nodes to {nodes:.3g}, at most {MAX_NODES} fit"

    def _bodies_have_points(self) -> Iterator[str]:
        for i, body in enumerate(self.body):
            if body.count(self.grid.box) == 0:
                yield f"body[{i}] '{body.name}': a spacing of {body.spacing:g} m leaves it without points"

    def _symmetry_planes_are_kept(self) -> Iterator[str]:
        impact = self.impact
        for mirror in self.mirrors:
            face = FACES[2 * mirror.axis + mirror.above]
            for i, body in enumerate(self.body):
                if body.velocity and body.velocity[mirror.axis]:
                    yield f"body[{i}] '{body.name}': its velocity moves it across the symmetry plane {face}: compute what lies behind it, too"
            if self.projectiles and impact.velocity[mirror.axis]:
                yield (
                    f"impact.angle: {math.degrees(impact.angle):g} deg at an azimuth of {math.degrees(impact.azimuth):g} deg moves "
                    f"the projectiles across the symmetry plane {face}: compute what lies behind it, too, or turn impact.azimuth"
                )

    def _comes_to_an_end(self) -> Iterator[str]:
        for name, material in self.materials.items():
            yield from _unlawful(name, material)
        if not self.steps_about <= MAX_STEPS:
            yield (
                f"end_time: {self.end_time:g} s takes about {self.steps_about:.3g} steps with waves of {self.wave_speed:.3g} "
                f"m/s in cells of {self.grid.cell:g} m, at most {MAX_STEPS:.0e} are allowed"
            )
        for key in ("snapshots", "history"):
            if (interval := getattr(self.output, key)) < self.end_time / MAX_OUTPUTS:
                least = f"at least end_time/{MAX_OUTPUTS:.0e} = {self.end_time / MAX_OUTPUTS:g} s is needed"
                yield f"output.{key}: found {interval:g} s, {least}"

    def _outside(self, key: str, body: Solid) -> Iterator[str]:
        """Check that what a body's points fill lies in the grid, but for half a spacing of a `rounded` body, whose points themselves do; a
        sphere may be cut by a symmetry plane through its centre."""
        tolerance = 1e-9 * self.grid.cell
        lower, upper = body.box
        for face, kind in zip(FACES, self.boundary.faces, strict=True):
            axis, is_upper = FACES.index(face) // 2, face.endswith("upper")
            limit = self.grid.corner[axis] if is_upper else self.grid.lower[axis]
            beyond = upper[axis] - limit if is_upper else limit - lower[axis]
            if beyond <= tolerance + (body.spacing / 2 if body.rounded and kind != "symmetry" else 0.0):
                continue
            if kind == "symmetry" and body.is_halved_by(axis, limit, tolerance):
                continue
            yield f"{key}: reaches {in_metres(beyond)} outside the grid's face {face}"

    def to_dict(self) -> dict[str, Any]:
        """Return plain tables, SI numbers: from_dict gives the same scene back."""
        return self.model_dump(mode="json", exclude_none=True)

    def to_toml(self) -> str:
        """Return the scene as TOML with every default written out, SI numbers."""
        return to_toml(self.to_dict())

    def save(self, path: AnyPath) -> None:
        """Write to_toml() to a file. Raises PockmarkError."""
        where = as_path(path)
        with files.told(where):
            where.write_text(self.to_toml(), encoding="utf-8")

    @property
    def hash(self) -> str:
        """Identifies what is computed: the same for scenes that are equal but for their titles."""
        return hash_of(self.to_dict())

    @property
    def course(self) -> str:
        """Identifies what is computed until the end, whenever that is."""
        return hash_of(self.to_dict() | {"end_time": None})

    @property
    def projectiles(self) -> tuple[int, ...]:
        """Indices of the projectile bodies."""
        return tuple(i for i, b in enumerate(self.body) if b.projectile)

    @property
    def targets(self) -> tuple[int, ...]:
        """Indices of the other bodies."""
        return tuple(i for i, b in enumerate(self.body) if not b.projectile)

    def velocity(self, body: Body) -> tuple[float, float, float]:
        """Return how a body moves at the start, m/s: a projectile with the impact, another as it says itself."""
        return self.impact.velocity if body.projectile else body.velocity or (0.0, 0.0, 0.0)

    @property
    def wave_speed(self) -> float:
        """The fastest sound at rest, and the speed of the fastest body, m/s."""
        own = [math.hypot(*body.velocity) for body in self.body if body.velocity]
        sound = max(material.dilatational_speed for material in self.materials.values())
        return sound + max([self.impact.speed, *own])

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


def _plain(table: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return a table of plain values: NumPy's numbers are numbers, and its arrays lists of them. Raises PockmarkError."""

    def plain(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [plain(item) for item in value]
        return value.tolist() if isinstance(value, np.generic | np.ndarray) else value

    if not isinstance(table, Mapping):
        raise PockmarkError(f"{source}: {found(table)}, expected a table")
    try:
        return dict(plain(table))
    except RecursionError:
        raise PockmarkError(f"{source}: has tables in tables without an end") from None


def hash_of(table: Mapping[str, Any], *, titled: bool = False) -> str:
    """Return what identifies a scene's table, 16 hexadecimal digits; the title is a part of it only if `titled`."""
    hashed = {key: value for key, value in table.items() if titled or key != "title"}
    if isinstance(output := hashed.get("output"), Mapping):  # checkpoints change nothing that is computed
        hashed["output"] = {key: value for key, value in output.items() if key != "checkpoints"}
    return hashlib.sha256(json.dumps(hashed, sort_keys=True, default=str).encode()).hexdigest()[:16]


def _unlawful(name: str, material: Material) -> Iterator[str]:
    """Say what the core's own check of each law's constants says."""
    try:
        material.to_core()
    except ValueError as error:
        yield f"materials.{name}: {error}"


def _complete_materials(table: dict[str, Any]) -> list[str]:
    """Put complete tables of the materials that the bodies name, and of those written, into a scene's table; what is no table
    or list stays, to be told by its model. Returns what else is wrong with them."""
    written, bodies = table.get("materials", {}), table.get("body")
    if not isinstance(written, Mapping):
        return []
    users: dict[str, str] = dict.fromkeys(written, "")
    for i, body in enumerate(bodies if isinstance(bodies, list | tuple) else ()):
        if isinstance(body, Mapping) and isinstance(name := body.get("material"), str):
            users.setdefault(name, f"body[{i}].material")
    told = []
    table["materials"] = {}
    for name, user in users.items():
        try:
            table["materials"][name] = complete(name, written.get(name), user)
        except PockmarkError as error:
            told.append(str(error))
    return told
