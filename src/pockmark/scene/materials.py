"""Materials: what a user writes, the cited library, and the core's material."""

import math
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from .. import _core
from ..base.errors import PockmarkError, found
from ..base.units import quantity


class Model(BaseModel):
    """A strict, immutable table: unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True)


# Every constant has a range: wide enough for aerogel, gels, foams, ice and osmium, and far too narrow for a slip of the
# exponent or a forgotten unit.
Modulus = Annotated[float, quantity("Pa", 1.0, 1e13)]
Stress = Annotated[float, quantity("Pa", 0.0, 1e12)]
Exponent = Annotated[float, quantity("", 1e-3, 20.0)]
Rate = Annotated[float, quantity("1/s", 1e-8, 1e8)]
DamageConstant = Annotated[float, quantity("", -100.0, 100.0)]
Triaxiality = Annotated[float, quantity("", -100.0, 100.0)]
Temperature = Annotated[float, quantity("K", 1.0, 1e5)]
ViscosityFactor = Annotated[float, quantity("", 0.0, 20.0)]


class MieGruneisen(Model):
    """Us = c0 + s up with a Grueneisen gamma (Liu et al. 2015, Eqs. 19-20 corrected)."""

    model: Literal["mie-gruneisen"]
    c0: Annotated[float, quantity("m/s", 1.0, 1e5)]
    s: Annotated[float, quantity("", 0.0, 20.0)]
    gamma0: Annotated[float, quantity("", 0.0, 20.0)]


class LinearEos(Model):
    """p = K (rho/rho0 - 1)."""

    model: Literal["linear"]
    bulk_modulus: Modulus


class JohnsonCook(Model):
    """Liu et al. 2015, Eq. 16."""

    model: Literal["johnson-cook"]
    shear_modulus: Modulus
    A: Annotated[float, quantity("Pa", 1.0, 1e12)]
    B: Stress
    n: Exponent
    C: Annotated[float, quantity("", 0.0, 10.0)]
    m: Exponent
    reference_rate: Rate = 1.0


class Elastic(Model):
    """A linear elastic deviator."""

    model: Literal["elastic"]
    shear_modulus: Modulus


class Fluid(Model):
    """No deviatoric stress."""

    model: Literal["fluid"]


class Failure(Model):
    """Johnson-Cook failure, Liu et al. 2015, Eqs. 17-18, and what happens where its strain is <= 0."""

    treatment: Literal["inactive", "no_damage", "signed", "floor", "clamp_triaxiality"]
    D1: DamageConstant = 0.0
    D2: DamageConstant = 0.0
    D3: DamageConstant = 0.0
    D4: DamageConstant = 0.0
    D5: DamageConstant = 0.0
    reference_rate: Rate = 1.0
    floor: Annotated[float, quantity("", 1e-9, 100.0)] = 1e-3
    triaxiality_min: Triaxiality = -1.5
    triaxiality_max: Annotated[Triaxiality, Field(validate_default=True)] = 1.0 / 3.0

    @field_validator("triaxiality_max")
    @classmethod
    def _is_a_range(cls, high: float, known: ValidationInfo) -> float:
        if high <= known.data.get("triaxiality_min", -math.inf):
            raise ValueError(f"found {high:g}, triaxiality_max must exceed triaxiality_min")
        return high

    @property
    def may_add_damage(self) -> bool:
        """Whether any state has a failure strain above 0."""
        if self.treatment == "inactive":
            return False
        if self.treatment == "floor" or self.D4 < 0 or self.D5 < 0:  # negative factors turn the sign
            return True
        return (self.D1 + self.D2 if self.D3 == 0 else max(self.D1, self.D2)) > 0


class Thermal(Model):
    """Heat from plastic work, and melting."""

    specific_heat: Annotated[float, quantity("J/(kg*K)", 1.0, 1e5)]
    room_temperature: Temperature = 293.0
    melt_temperature: Temperature
    taylor_quinney: Annotated[float, quantity("", 0.0, 1.0)] = 1.0

    @field_validator("melt_temperature")
    @classmethod
    def _is_hotter(cls, melt: float, known: ValidationInfo) -> float:
        if melt <= known.data.get("room_temperature", -math.inf):
            raise ValueError(f"found {melt:g} K, t_melt must exceed t_room")
        return melt


class Viscosity(Model):
    """Bulk viscosity q = rho l (quadratic l D^2 + linear c |D|) in compression."""

    quadratic: ViscosityFactor = 1.5
    linear: ViscosityFactor = 0.06


class Material(Model):
    """One material, SI inside."""

    source: str
    density: Annotated[float, quantity("kg/m^3", 1.0, 3e4)]
    eos: Annotated[MieGruneisen | LinearEos, Field(discriminator="model")]
    strength: Annotated[JohnsonCook | Elastic | Fluid, Field(discriminator="model")]
    failure: Failure
    thermal: Thermal
    viscosity: Viscosity = Viscosity()
    # Speed of impact on itself up to which its laws are meant: the material behind the shock then moves at half of it.
    max_speed: Annotated[float, quantity("m/s", 1.0, 1e6)] | None = None

    @field_validator("failure")
    @classmethod
    def _can_act(cls, failure: Failure, known: ValidationInfo) -> Failure:
        """Check that a law that was asked for adds damage somewhere."""
        strength = known.data.get("strength")
        if failure.treatment == "inactive":
            return failure
        if isinstance(strength, Elastic | Fluid):
            why = f"cannot act on strength '{strength.model}', for damage comes with plastic strain alone"
        elif not failure.may_add_damage:
            why = f"adds no damage, for with D1 = {failure.D1:g} and D2 = {failure.D2:g} no failure strain is above 0"
        else:
            return failure
        raise ValueError(f"treatment '{failure.treatment}' {why}; write failure.treatment = \"inactive\"")

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
        """Return the core's material."""
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
    """Return the tables of materials.toml, by name."""
    return tomllib.loads(files("pockmark.scene").joinpath("materials.toml").read_text(encoding="utf-8"))


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with `changes` put over it, table by table; a table that names another `model` replaces the old one."""
    if changes.get("model", base.get("model")) != base.get("model"):
        return dict(changes)
    out = dict(base)
    for key, value in changes.items():
        old = out.get(key)
        out[key] = merge(old, value) if isinstance(old, Mapping) and isinstance(value, Mapping) else value
    return out


def complete(name: str, written: Any, user: str = "") -> Any:
    """Return the full table of a material: the library's, or the one `based_on` names, under what the scene writes; what is written
    and no table is returned as it is.

    `user` is the key that names the material. Raises PockmarkError on an unknown name.
    """
    if written is not None and not isinstance(written, Mapping):
        return written
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
