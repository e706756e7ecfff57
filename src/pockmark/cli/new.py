"""`pockmark new`: a scene with comments to start from."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from ..base.errors import PockmarkError
from ..base.files import as_path, told
from ..base.shipped import example, examples
from ..base.terminal import literal
from ..base.toml import read_toml
from .common import CONSOLE, say_written


def new(
    name: Annotated[Path, typer.Argument(metavar="[NAME]", help="The file to write.")] = Path("scene.toml"),
    template: Annotated[
        str, typer.Option("--from", metavar="EXAMPLE", help="The example to begin with.")
    ] = "rings",
    listed: Annotated[bool, typer.Option("--list", help="List the examples, and write nothing.")] = False,
) -> None:
    """Write a commented scene to start from. A file that is there is never overwritten."""
    if listed:
        CONSOLE.print(_list())
        return
    text = example(template).read_text(encoding="utf-8")
    path = as_path(name if name.suffix else name.with_name(f"{name.name}.toml"))
    try:
        with told(path), path.open("x", encoding="utf-8") as file:
            file.write(text)
    except PockmarkError:
        if path.exists():
            raise PockmarkError(f"{path}: is there, and is not overwritten: give another name") from None
        raise
    say_written(path)
    CONSOLE.print(f"next: pockmark check {path}, pockmark run {path}", soft_wrap=True)


def _list() -> Table:
    """Return the examples and their titles."""
    table = Table("example", "what it is")
    for name, path in examples().items():
        table.add_row(literal(name), literal(read_toml(path).get("title", "")))
    return table
