"""Materials: what a user writes, the cited library, and the core's material."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from . import _core
from .errors import PockmarkError, found
from .units import Density, Number, Pressure, Rate, SpecificHeat, Speed, Temperature


class Model(BaseModel):
    """A strict, immutable table: unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


Positive = Annotated[float, Field(gt=0)]


class MieGruneisen(Model):
    """Us = c0 + s up with a Grueneisen gamma (Liu et al. 2015, Eqs. 19-20 corrected)."""

    model: Literal["mie-gruneisen"]
    c0: Annotated[Speed, Field(gt=0)]
    s: Annotated[Number, Field(ge=0)]
    gamma0: Annotated[Number, Field(ge=0)]


class LinearEos(Model):
    """p = K (rho/rho0 - 1)."""

    model: Literal["linear"]
    bulk_modulus: Annotated[Pressure, Field(gt=0)]


class JohnsonCook(Model):
    """Liu et al. 2015, Eq. 16."""

    model: Literal["johnson-cook"]
    shear_modulus: Annotated[Pressure, Field(gt=0)]
    A: Annotated[Pressure, Field(gt=0)]
    B: Annotated[Pressure, Field(ge=0)]
    n: Annotated[Number, Field(gt=0)]
    C: Annotated[Number, Field(ge=0)]
    m: Annotated[Number, Field(gt=0)]
    reference_rate: Annotated[Rate, Field(gt=0)] = 1.0


class Elastic(Model):
    """A linear elastic deviator."""

    model: Literal["elastic"]
    shear_modulus: Annotated[Pressure, Field(ge=0)]


class Fluid(Model):
    """No deviatoric stress."""

    model: Literal["fluid"]


class Failure(Model):
    """Johnson-Cook failure, Liu et al. 2015, Eqs. 17-18, and what happens where its strain is <= 0."""

    treatment: Literal["inactive", "no_damage", "signed", "floor", "clamp_triaxiality"]
    D1: Number = 0.0
    D2: Number = 0.0
    D3: Number = 0.0
    D4: Number = 0.0
    D5: Number = 0.0
    reference_rate: Annotated[Rate, Field(gt=0)] = 1.0
    floor: Annotated[Number, Field(gt=0)] = 1e-3
    triaxiality_min: Number = -1.5
    triaxiality_max: Number = 1.0 / 3.0


class Thermal(Model):
    """Heat from plastic work, and melting."""

    specific_heat: Annotated[SpecificHeat, Field(gt=0)]
    room_temperature: Annotated[Temperature, Field(gt=0)] = 293.0
    melt_temperature: Annotated[Temperature, Field(gt=0)]
    taylor_quinney: Annotated[Number, Field(ge=0, le=1)] = 1.0


class Viscosity(Model):
    """Bulk viscosity q = rho l (quadratic l D^2 + linear c |D|) in compression."""

    quadratic: Annotated[Number, Field(ge=0)] = 1.5
    linear: Annotated[Number, Field(ge=0)] = 0.06


class Material(Model):
    """One material, SI inside."""

    source: str
    density: Annotated[Density, Field(gt=0)]
    eos: Annotated[MieGruneisen | LinearEos, Field(discriminator="model")]
    strength: Annotated[JohnsonCook | Elastic | Fluid, Field(discriminator="model")]
    failure: Failure
    thermal: Thermal
    viscosity: Viscosity = Viscosity()
    # Speed of impact on itself up to which its laws are meant: the material behind the shock then moves at half of it.
    max_speed: Annotated[Speed, Field(gt=0)] | None = None

    @property
    def bulk_modulus(self) -> float:
        """rho0 c0^2 or K, Pa."""
        if isinstance(self.eos, MieGruneisen):
            return self.density * self.eos.c0 * self.eos.c0
        return self.eos.bulk_modulus

    @property
    def shear_modulus(self) -> float:
        """Pa."""
        return 0.0 if isinstance(self.strength, Fluid) else self.strength.shear_modulus

    @property
    def dilatational_speed(self) -> float:
        """Speed of P waves, m/s."""
        return float(((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / self.density) ** 0.5)

    def to_core(self) -> _core.Material:
        """The core's material."""
        t, v = self.thermal, self.viscosity
        return _core.Material(
            eos=self._core_eos(),
            strength=self._core_strength(),
            failure=self._core_failure(),
            specific_heat=t.specific_heat,
            taylor_quinney=t.taylor_quinney,
            t_room=t.room_temperature,
            t_melt=t.melt_temperature,
            q_quadratic=v.quadratic,
            q_linear=v.linear,
        )

    def _core_eos(self) -> Any:
        e = self.eos
        if isinstance(e, MieGruneisen):
            return _core.MieGruneisen(density=self.density, c0=e.c0, s=e.s, gamma0=e.gamma0)
        return _core.LinearEos(density=self.density, bulk_modulus=e.bulk_modulus)

    def _core_strength(self) -> Any:
        s, t = self.strength, self.thermal
        if isinstance(s, Fluid):
            return _core.Fluid()
        if isinstance(s, Elastic):
            return _core.Elastic(shear_modulus=s.shear_modulus)
        return _core.JohnsonCook(
            shear_modulus=s.shear_modulus,
            A=s.A,
            B=s.B,
            n=s.n,
            C=s.C,
            m=s.m,
            reference_rate=s.reference_rate,
            t_room=t.room_temperature,
            t_melt=t.melt_temperature,
        )

    def _core_failure(self) -> Any:
        f, t = self.failure, self.thermal
        if f.treatment == "inactive":
            return _core.NoFailure()
        return _core.JohnsonCookFailure(
            D1=f.D1,
            D2=f.D2,
            D3=f.D3,
            D4=f.D4,
            D5=f.D5,
            reference_rate=f.reference_rate,
            t_room=t.room_temperature,
            t_melt=t.melt_temperature,
            treatment=getattr(_core.FailureTreatment, f.treatment),
            floor=f.floor,
            triaxiality_min=f.triaxiality_min,
            triaxiality_max=f.triaxiality_max,
        )


@cache
def library() -> dict[str, dict[str, Any]]:
    """The tables of materials.toml, by name."""
    return tomllib.loads(files("pockmark").joinpath("materials.toml").read_text(encoding="utf-8"))


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """`base` with `changes` put over it, table by table; a table that names another `model` replaces the old one."""
    if changes.get("model", base.get("model")) != base.get("model"):
        return dict(changes)
    out = dict(base)
    for key, value in changes.items():
        old = out.get(key)
        out[key] = merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
    return out


def complete(name: str, written: Mapping[str, Any] | None, user: str = "") -> dict[str, Any]:
    """The full table of a material: the library's, or the one `based_on` names, under what the scene writes.

    `user` is the key that names the material. Raises PockmarkError on an unknown name or something that is no table.
    """
    if written is not None and not isinstance(written, Mapping):
        raise PockmarkError(f"materials.{name}: {found(written)}, expected a table")
    changes = dict(written or {})
    base = changes.pop("based_on", name if name in library() else None)
    if base is None:
        if written is None:
            known = ", ".join(sorted(library()))
            raise PockmarkError(
                f"{user}: {found(name)}, which is neither in the scene nor in the library ({known})"
            )
        return changes
    if not isinstance(base, str) or base not in library():
        raise PockmarkError(
            f"materials.{name}.based_on: {found(base)}, expected one of {', '.join(library())}"
        )
    return merge(library()[base], changes)
