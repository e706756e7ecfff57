"""Materials: what a user writes, the cited library, and the core's material."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache, reduce
from importlib.resources import files
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, ValidationInfo, create_model, field_validator
from scipy.optimize import brentq

from .. import _core
from ..base.errors import PockmarkError, found, nearest, shown
from ..base.units import Quantity
from .model import Hint, Model
from .overrides import changed, merge
from .sentences import sentence

# Every constant has a range: wide enough for aerogel, gels, foams, ice and osmium, and far too narrow for a slip of the
# exponent or a forgotten unit. Those of the laws are declared in their own files, core/eos, core/strength and core/failure.
Temperature = Annotated[float, Quantity("K", 1.0, 1e5)]
ViscosityFactor = Annotated[float, Quantity("", 0.0, 20.0)]
LAWS: dict[str, list[dict[str, Any]]] = _core.laws()  # what each law declares, by kind


class Law(Model):
    """A law of a material: its `model`, and the constants that the core declares for it."""

    model: str
    """Name of the law."""


def _table_of(law: Mapping[str, Any]) -> type[Law]:
    """Return the table that a scene gives a law, made from what the law declares."""
    fields: dict[str, Any] = {"model": Annotated[Literal[law["name"]], Field(description="Name of the law.")]}
    validators: dict[str, Any] = {}
    for constant in law["constants"]:
        name, default = constant["name"], constant["default"]
        if constant["choices"]:
            kind: Any = Literal[tuple(constant["choices"])]
        else:
            kind = Annotated[float, Quantity(constant["unit"], constant["least"], constant["most"])]
        if above := constant["above"]:
            kind = Annotated[kind, Field(validate_default=True), Hint(allowed=f"more than {above}")]
            validators[f"{name}_is_above"] = field_validator(name)(_above(name, above))
        kind = Annotated[kind, Field(description=f"{constant['doc'][0].upper()}{constant['doc'][1:]}.")]
        fields[name] = kind if default is None else (kind, default)
    return create_model(
        f"{law['name']} law", __base__=Law, __doc__=law["doc"], __validators__=validators, **fields
    )


def _above(name: str, other: str) -> Any:
    """Return the check that a constant exceeds another one."""

    def check(value: float, known: ValidationInfo) -> float:
        if value <= known.data.get(other, -math.inf):
            raise ValueError(f"found {value:g}, {name} must exceed {other}")
        return value

    return check


def _any_of(laws: Sequence[Mapping[str, Any]]) -> Any:
    """Return the type of a table that is one of some laws, as its `model` says."""
    return Annotated[reduce(or_, map(_table_of, laws)), Field(discriminator="model")]


if TYPE_CHECKING:
    Eos = Law
    Strength = Law
    Failure = Law
else:
    Eos, Strength, Failure = (_any_of(LAWS[kind]) for kind in ("eos", "strength", "failure"))


class Thermal(Model):
    """The heat from plastic work, and melting."""

    specific_heat: Annotated[float, Quantity("J/(kg*K)", 1.0, 1e5)]
    """Specific heat."""
    room_temperature: Temperature = 293.0
    """Temperature at the start."""
    melt_temperature: Annotated[Temperature, Hint(allowed="more than room_temperature")]
    """Temperature at which strength is gone."""
    taylor_quinney: Annotated[float, Quantity("", 0.0, 1.0)] = 1.0
    """Share of the plastic work that becomes heat."""

    @field_validator("melt_temperature")
    @classmethod
    def _is_hotter(cls, melt: float, known: ValidationInfo) -> float:
        if melt <= known.data.get("room_temperature", -math.inf):
            raise ValueError(f"found {melt:g} K, t_melt must exceed t_room")
        return melt


class Viscosity(Model):
    """The bulk viscosity in compression: q = rho l (quadratic l D^2 + linear c |D|)."""

    quadratic: ViscosityFactor = 1.5
    """Factor of the quadratic part, which spreads a shock over cells."""
    linear: ViscosityFactor = 0.06
    """Factor of the linear part, which damps what rings behind it."""


class Material(Model):
    """A material, SI inside."""

    source: str
    """Where each constant was read."""
    density: Annotated[float, Quantity("kg/m^3", 10.0, 3e4)]
    """Density at rest."""
    eos: Eos
    strength: Strength
    failure: Failure
    thermal: Thermal
    viscosity: Viscosity = Viscosity()
    # The material behind the shock moves at half of it.
    max_speed: Annotated[float, Quantity("m/s", 1.0, 1e6)] | None = None
    """Speed of impact on itself up to which its laws are meant."""

    @field_validator("failure", mode="before")
    @classmethod
    def _is_a_model(cls, failure: Any) -> Any:
        """Return the failure table with its model, which scenes of before it had one lack.

        They meant Johnson and Cook's law, or with the treatment "inactive" none.
        """
        if not isinstance(failure, Mapping) or failure.get("model", "johnson-cook") != "johnson-cook":
            return failure
        if failure.get("treatment") == "inactive":
            return {"model": "none"}
        return {"model": "johnson-cook", **failure}

    @field_validator("failure")
    @classmethod
    def _can_act(cls, failure: Law, known: ValidationInfo) -> Law:
        """Return the failure law. Raises ValueError for one that adds no damage anywhere."""
        strength = known.data.get("strength")
        if failure.model == "none":
            return failure
        if strength and _says("failure", failure, "needs_flow") and not _says("strength", strength, "yields"):
            why = f"cannot act on strength '{strength.model}', for its damage comes with plastic strain alone"
        elif not (why := _core.failure_fault(failure.model_dump())):
            return failure
        raise ValueError(f"model '{failure.model}' {why}; write failure.model = \"none\"")

    def with_(self, key: str, value: Any) -> "Material":
        """Return the material with another value of a key, such as "strength.A". Raises PockmarkError."""
        try:
            return Material.model_validate(changed(self.model_dump(exclude_none=True), key, value))
        except ValidationError as error:
            raise PockmarkError(f"material: {sentence(error, Material)}") from None

    @property
    def laws(self) -> tuple[str, str, str]:
        """Return the names of the laws: equation of state, strength, failure."""
        return self.eos.model, self.strength.model, self.failure.model

    def to_core(self) -> _core.Material:
        """Return the core's material."""
        t, v = self.thermal, self.viscosity
        return _core.Material(
            eos=self.eos.model_dump(),
            strength=self.strength.model_dump(),
            failure=self.failure.model_dump(),
            density=self.density,
            specific_heat=t.specific_heat,
            taylor_quinney=t.taylor_quinney,
            room_temperature=t.room_temperature,
            melt_temperature=t.melt_temperature,
            q_quadratic=v.quadratic,
            q_linear=v.linear,
        )

    @property
    def bulk_modulus(self) -> float:
        """Return the bulk modulus of the equation of state at rest, Pa."""
        return float(self.to_core().bulk_modulus)

    @property
    def shear_modulus(self) -> float:
        """Return the shear modulus at rest, Pa."""
        return float(self.to_core().shear_modulus)

    @property
    def yield_strength(self) -> float | None:
        """Return the flow stress at rest, without plastic strain, Pa.

        None if the material does not yield.
        """
        at_rest = [[0.0, 0.0, self.thermal.room_temperature, 0.0, 1.0, 0.0]]
        stress = float(self.to_core().strength_at(np.array(at_rest))[0, 0])
        return stress if math.isfinite(stress) else None

    @property
    def dilatational_speed(self) -> float:
        """Return the speed of P waves at rest, m/s."""
        return float(((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / self.density) ** 0.5)

    @property
    def failure_caution(self) -> str:
        """Return what has to be known of the constants of the failure law; empty if nothing has."""
        return str(_core.failure_caution(self.failure.model_dump()))

    def shock_pressure(self, up: float) -> float:
        """Return the pressure, Pa, behind a shock from rest that leaves the material at a speed `up`, m/s.

        There the equation of state meets the conservation of mass, momentum and energy: the pressure is rho0 up^2 (1
        + 1/mu), the energy rho0 up^2/2.
        """
        if up <= 0:
            return 0.0
        inertia, core = self.density * up * up, self.to_core()

        def excess(mu: float) -> float:
            pressure = core.eos_at(np.array([[mu, inertia / 2]]))[0, 0]
            return float(pressure) - inertia * (1 + 1 / mu)

        least, most = 1e-9 * up / self.dilatational_speed, 100.0
        mu = brentq(excess, least, most, xtol=1e-15) if excess(most) > 0 else most
        return inertia * (1 + 1 / float(mu))


def _says(kind: str, law: Law, what: str) -> bool:
    """Return whether a law declares something of itself to be true, such as "yields"."""
    return bool(next(declared[what] for declared in LAWS[kind] if declared["name"] == law.model))


@cache
def library() -> dict[str, dict[str, Any]]:
    """Return the tables of materials.toml, by name."""
    return tomllib.loads(files("pockmark.scene").joinpath("materials.toml").read_text(encoding="utf-8"))


def material(name: str) -> Material:
    """Return a material of the library. Raises PockmarkError for a name that is not there."""
    if name not in library():
        raise PockmarkError(f"{shown(name, 60)}: is no material of the library, nearest are {_nearest(name)}")
    return Material.model_validate(library()[name])


def complete(name: str, written: Any, user: str = "") -> Any:
    """Return the full table of a material.

    What the scene writes is put over the library's material of this name, or over the one that `based_on` names. What
    is written and is no table is returned as it is. `user` is the key that names the material. Raises PockmarkError
    for an unknown name.
    """
    if written is not None and not isinstance(written, Mapping):
        return written
    changes = dict(written or {})
    base = changes.pop("based_on", name if name in library() else None)
    if base is None:
        if written is None:
            raise PockmarkError(
                f"{user}: {found(name)}, which is neither in the scene nor in the library ({_nearest(name)})"
            )
        return changes
    if not isinstance(base, str) or base not in library():
        raise PockmarkError(
            f"materials.{name}.based_on: {found(base)}, expected one of the library ({_nearest(str(base))})"
        )
    return merge(library()[base], changes)


def _nearest(name: str) -> str:
    """Return the names in the library that are most like one, and how many more there are."""
    near = nearest(name, library())
    return f"{', '.join(near)} and {len(library()) - len(near)} more"
