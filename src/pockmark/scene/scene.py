"""The scene: everything that a user decides about a run, SI inside. The defaults of pockmark are here."""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, overload

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, field_validator, model_validator

from ..base import files
from ..base.errors import PockmarkError, found, together
from ..base.files import AnyPath, as_path
from ..base.geometry import Mirror
from ..base.toml import read_toml, to_toml
from ..base.units import Quantity
from .axisymmetry import obstacles, slice_of
from .bodies import Array, Body, Solid
from .grid import Boundary, Grid
from .identity import hash_of
from .impact import Impact
from .materials import Material, complete, library, material
from .model import Hint, Model
from .numerics import Contact, Numerics, Output
from .overrides import changed, override
from .rules import broken_rules
from .sentences import faults


class Scene(Model):
    """A complete scene.

    One that is saved and loaded again is the same object, and gives the same run.
    """

    title: str = ""
    """Name of the run, for a reader."""
    end_time: Annotated[
        float, Quantity("s", 1e-18, 1e4), Hint("when the crater has settled: `pockmark check` says when")
    ]
    """Simulated time at which the run ends."""
    grid: Grid
    boundary: Boundary = Boundary()
    impact: Impact
    materials: dict[str, Material] = Field(default_factory=dict)
    # After the materials, for a swarm's flux needs their density.
    body: Annotated[tuple[Body, ...], Field(min_length=1)]
    contact: Contact | None = None
    numerics: Numerics = Numerics()
    output: Output = Output()

    @classmethod
    def load(cls, path: AnyPath, overrides: str | Sequence[str] = ()) -> "Scene":
        """Return the scene of a TOML file. Raises PockmarkError.

        `overrides` are texts "key.key=value", or one such text.
        """
        return cls.from_dict(read_toml(path), source=str(path), overrides=overrides)

    @classmethod
    def from_dict(
        cls, table: Mapping[str, Any], *, source: str = "scene", overrides: str | Sequence[str] = ()
    ) -> "Scene":
        """Return the scene of a table as TOML gives it. Raises PockmarkError naming `source` and the key."""
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
            # Without its materials no rule between a scene's tables can be judged.
            told += faults([fault for fault in error.errors() if fault["loc"] or not told], cls)
        if told:
            raise PockmarkError(f"{source}: {together(told)}")
        return scene

    @model_validator(mode="before")
    @classmethod
    def _know_the_library(cls, table: Any) -> Any:
        """Return the table with the library's materials that its bodies name and it does not have."""
        if not isinstance(table, Mapping):
            return table
        known, bodies = table.get("materials", {}), table.get("body")
        if not isinstance(known, Mapping) or not isinstance(bodies, list | tuple):
            return table
        named = [
            body.get("material") if isinstance(body, Mapping) else getattr(body, "material", None)
            for body in bodies
        ]
        missing = {name: library()[name] for name in named if isinstance(name, str) and name in library()}
        return {**table, "materials": missing | {**known}}

    @field_validator("body", mode="before")
    @classmethod
    def _is_a_list(cls, bodies: Any) -> Any:
        if not isinstance(bodies, list | tuple) or not bodies:
            raise ValueError(f"{found(bodies)}, expected one [[body]] or more")
        return bodies

    @field_validator("body")
    @classmethod
    def _are_resolved(cls, bodies: tuple[Body, ...], known: ValidationInfo) -> tuple[Body, ...]:
        materials = known.data.get("materials", {})  # empty if they are faulty themselves
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
    def _is_sound(self) -> "Scene":
        """Return the scene as it is computed. Raises ValueError with every rule between its tables that it breaks."""
        scene: Scene = self
        if self.grid.is_axisymmetric:
            if told := [*obstacles(self)]:
                raise ValueError(together(told))
            scene = slice_of(self)
        if told := broken_rules(scene):
            raise ValueError(together(told))
        return scene

    @overload
    def with_(self, changes: str, value: Any) -> "Scene": ...

    @overload
    def with_(self, changes: Mapping[str, Any]) -> "Scene": ...

    def with_(self, changes: str | Mapping[str, Any], value: Any = None) -> "Scene":
        """Return the scene with another value of a key, such as "impact.speed", "3 km/s". Raises PockmarkError.

        Keys are named as --set names them. Several at once are given as a mapping of keys to values. What followed from
        what was written, such as a radius from a flux, follows anew.
        """
        table = self.model_dump(mode="json", exclude_unset=True, exclude_none=True)
        ours = [name for name, own in self.materials.items() if name in library() and own == material(name)]
        table["materials"] = {name: own for name, own in table["materials"].items() if name not in ours}
        for key, new in ({changes: value} if isinstance(changes, str) else changes).items():
            table = changed(table, key, new)
        return Scene.from_dict(table)

    def to_dict(self) -> dict[str, Any]:
        """Return the scene as plain tables, SI numbers. from_dict() makes the same scene of them."""
        return self.model_dump(mode="json", exclude_none=True)

    def to_toml(self) -> str:
        """Return the scene as TOML, SI numbers, with every default written out."""
        return to_toml(self.to_dict())

    def save(self, path: AnyPath) -> None:
        """Write to_toml() to a file. Raises PockmarkError."""
        where = as_path(path)
        with files.told(where):
            where.write_text(self.to_toml(), encoding="utf-8")

    @property
    def hash(self) -> str:
        """Return what identifies the run that is computed.

        It is the same for scenes that are equal but for title and checkpoints.
        """
        return hash_of(self.to_dict())

    @property
    def course(self) -> str:
        """Return what identifies all that is computed until the end, whenever that is."""
        return hash_of(self.to_dict() | {"end_time": None})

    @property
    def projectiles(self) -> tuple[int, ...]:
        """Return the indices of the projectiles."""
        return tuple(i for i, b in enumerate(self.body) if b.projectile)

    @property
    def targets(self) -> tuple[int, ...]:
        """Return the indices of the other bodies."""
        return tuple(i for i, b in enumerate(self.body) if not b.projectile)

    def filled(self, body: Solid) -> tuple[Array, Array]:
        """Return positions (n, 3), m, and volumes (n,), m^3, of the points of a body that are computed."""
        if self.grid.is_axisymmetric:
            rings = body.rings()
            return rings, body.ring_volumes(rings)
        x = body.lattice(self.grid.box)
        return x, np.broadcast_to(body.point_volume, len(x))

    def count(self, body: Solid) -> int:
        """Return how many points of a body are computed."""
        return len(body.rings()) if self.grid.is_axisymmetric else body.count(self.grid.box)

    def volume(self, body: Solid) -> float:
        """Return the volume of what is computed of a body, m^3; of rings it is the whole."""
        if self.grid.is_axisymmetric:
            return float(self.filled(body)[1].sum())
        return self.count(body) * body.point_volume

    def velocity(self, body: Body) -> tuple[float, float, float]:
        """Return the velocity of a body at the start, m/s.

        That of a projectile is the impact's; another body has its own, or none.
        """
        return self.impact.velocity if body.projectile else body.velocity or (0.0, 0.0, 0.0)

    @property
    def wave_speed(self) -> float:
        """Return the speed of the fastest sound at rest plus that of the fastest body, m/s."""
        own = [math.hypot(*body.velocity) for body in self.body if body.velocity]
        sound = max(material.dilatational_speed for material in self.materials.values())
        return sound + max([self.impact.speed, *own])

    @property
    def steps_about(self) -> float:
        """Return about how many steps a run takes; infinite for absurd materials."""
        # Waves are faster in shocked material, and `strain_limit` shortens some steps: model 1 needed the factor 1.35.
        return 1.35 * self.end_time / self.numerics.cfl / self.grid.cell * self.wave_speed

    @property
    def mirrors(self) -> tuple[Mirror, ...]:
        """Return the symmetry planes across the surface behind which there is more than what is computed.

        Rings are whole, so an axisymmetric scene has none.
        """
        return () if self.grid.is_axisymmetric else self.planes

    @property
    def planes(self) -> tuple[Mirror, ...]:
        """Return the symmetry planes across the surface, those of a slice included."""
        return tuple(
            Mirror(i // 2, at=(self.grid.lower, self.grid.corner)[i % 2][i // 2], above=bool(i % 2))
            for i, kind in enumerate(self.boundary.faces[:4])
            if kind == "symmetry"
        )


def _plain(table: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return a table with plain values: NumPy's numbers as numbers, its arrays as lists of them.

    Raises PockmarkError for what is no table, or is a table without an end.
    """

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


def _complete_materials(table: dict[str, Any]) -> list[str]:
    """Put into a scene's table the complete tables of the materials that it writes, or that its bodies name.

    What is no table or list stays: its model tells that. Returns what else is wrong, in sentences.
    """
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
