"""Every law with constants: those of the library's materials, and simple ones that the library has no use for."""

import numpy as np
import pytest
from builders import kernels, law

import pockmark._core as core
from pockmark.scene.materials import Material, library

ROWS = [False, True] if core.build_info()["lanes"] else [False]
LANES = pytest.mark.parametrize("lanes", ROWS)
CELL, DT, V0 = 4e-6, 2e-10, 8e-18
SIMPLE = {
    "eos": [law("linear", bulk_modulus=70e9)],
    "strength": [law("elastic", shear_modulus=27e9), law("fluid")],
    "failure": [law("none")],
}


def materials(kind):
    """A material for each law of a kind that has constants of its own, by name; the other laws are a library material's."""
    found = {name: Material.model_validate(table) for name, table in library().items()}
    plain = library()["al2024-t351"]
    simple = {table["model"] for table in SIMPLE[kind]}  # before a library's row with the same law
    for table in SIMPLE[kind]:
        free = {} if kind == "eos" else {"failure": {"model": "none"}}
        found[table["model"]] = Material.model_validate(plain | free | {kind: table})
    distinct = {}
    for name, material in sorted(found.items(), key=lambda entry: entry[0] not in simple):
        distinct.setdefault(str(getattr(material, kind)), (name, material))
    return dict(distinct.values())


def each(kind):
    """Run a test for each law of a kind, with each of its sets of constants."""
    known = materials(kind)
    ids = [f"{getattr(m, kind).model}: {name}" for name, m in known.items()]
    return pytest.mark.parametrize("material", known.values(), ids=ids)


def declared(kind, name):
    return next(entry for entry in core.laws()[kind] if entry["name"] == name)


def states_of(n, material, **columns):
    """Rows as update_stress takes them, at rest but for what is given."""
    states = np.zeros((n, 13))
    states[:, 0], states[:, 5] = V0, material.thermal.room_temperature
    names = ("volume", "energy", "pressure", "viscosity", "plastic_strain", "temperature", "damage")
    for name, values in columns.items():
        states[:, names.index(name) if name in names else 10] = values  # s_xy otherwise
    return states


def update(material, states, gradients=None, *, lanes=False, q=True, dt=DT, cell=CELL):
    """The states after a step; `q`: with bulk viscosity."""
    made = material if q else material.model_copy(update={"viscosity": quiet(material)})
    gradients = np.zeros((len(states), 9)) if gradients is None else gradients
    return kernels.update_stress(made.to_core(), states, gradients, material.density * V0, cell, dt, lanes)


def quiet(material):
    return material.viscosity.model_copy(update={"quadratic": 0.0, "linear": 0.0})


def differences(f, x, column, change):
    """The central difference of f at rows x by a column, and whether both of its sides agree: no kink lies between."""
    ahead, behind = x.copy(), x.copy()
    ahead[:, column] += change
    behind[:, column] -= change
    up, here, down = f(ahead), f(x), f(behind)
    right, left = (up - here) / change, (here - down) / change
    smooth = np.abs(right - left) <= 1e-3 * (np.abs(right) + np.abs(left)) + 1e-9 * np.abs(here) / change
    return (up - down) / (2 * change), smooth
