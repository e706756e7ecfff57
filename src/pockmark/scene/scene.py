"""The scene: everything a user decides about a run, SI inside. The defaults of pockmark live here."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from ..base import files
from ..base.errors import PockmarkError, found, together
from ..base.files import AnyPath, as_path
from ..base.geometry import Mirror
from ..base.toml import read_toml, to_toml
from ..base.units import quantity
from .bodies import Body
from .grid import Boundary, Grid
from .impact import Impact
from .materials import Material, complete
from .model import Model
from .numerics import Contact, Numerics, Output
from .overrides import override
from .rules import broken_rules
from .sentences import faults


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
        if told := broken_rules(self):
            raise ValueError(together(told))
        return self

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
