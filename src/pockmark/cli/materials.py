"""`pockmark materials`: what the library has, and where it was read."""

from typing import Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from ..base.json import to_json
from ..base.terminal import literal
from ..scene.materials import Material, library, material
from ..scene.sheet import Row, at_rest, constants
from .common import CONSOLE

CHANGE = """
[materials.mine]             # name it in a body: material = "mine"
based_on = "{name}"
density = "2.7 g/cm^3"       # and any other key, such as strength.shear_modulus
"""


def materials(
    name: Annotated[
        str, typer.Argument(metavar="[NAME]", help="A material of the library; left out: all of them.")
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, SI.")] = False,
) -> None:
    """List the materials of the library, or all that is known of one: constants, range, sources."""
    shown = {one: material(one) for one in ([name] if name else library())}
    if as_json:
        print(to_json({one: _plain(what) for one, what in shown.items()}))
    elif name:
        CONSOLE.print(_sheet(name, shown[name]))
        CONSOLE.print("A scene that changes it:")
        CONSOLE.print(CHANGE.format(name=name), soft_wrap=True, highlight=False)
    else:
        CONSOLE.print(_list(shown))
        CONSOLE.print("pockmark materials NAME shows a material's constants, and how a scene changes them")


def _plain(what: Material) -> dict[str, Any]:
    """Return a material as plain tables, with what follows from its constants."""
    return what.model_dump(mode="json") | {"at_rest": {row.key: row.value for row in at_rest(what)}}


def _list(shown: dict[str, Material]) -> Table:
    """Return a row for each material."""
    table = Table(show_header=False, title="Materials", show_lines=True)
    table.add_column(no_wrap=True)
    for name, what in shown.items():
        eos, strength, failure = what.laws
        told = f"{what.density:g} kg/m^3; eos {eos}, strength {strength}, failure {failure}; up to {_up_to(what)}"
        table.add_row(literal(name, "bold"), Text.assemble(literal(told), "\n", literal(what.source, "dim")))
    return table


def _up_to(what: Material) -> str:
    """Return the speed of impact on itself up to which a material's laws are meant."""
    return "-" if what.max_speed is None else f"{what.max_speed / 1e3:g} km/s"


def _sheet(name: str, what: Material) -> Table:
    """Return all that is known of a material."""
    table = Table("key", "value", "what it is", title=literal(name), caption=literal(what.source))
    table.columns[0].no_wrap = True
    table.add_row(
        "max_speed", _up_to(what), literal("Speed of impact on itself up to which its laws are meant.")
    )
    if caution := what.failure_caution:
        table.add_row("failure", "", literal(caution, "yellow"))
    for rows in (constants(what), at_rest(what)):
        table.add_section()
        for row in rows:
            table.add_row(literal(row.key), literal(_value(row)), literal(row.meaning))
    return table


def _value(row: Row) -> str:
    """Return a value with its unit."""
    if row.value is None:
        return "-"
    return str(row.value) if isinstance(row.value, str) else f"{row.value:.6g} {row.unit}".strip()
