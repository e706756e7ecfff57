"""What a scene may say: each key, as the one declaration that validates it has it."""

import difflib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import annotated_types as limits
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ..base.errors import PockmarkError, shown
from ..base.units import Quantity
from .materials import library
from .model import Hint, Model
from .scene import Scene
from .sentences import kinds_of, members_of

NAMED = "NAME"  # stands for the name of a material
CORNERS = {2: "[x, y]", 3: "[x, y, z]"}
# `based_on` says where the other keys come from, and so no table has it when they are validated.
BASED_ON = "Material of the library that it is, but for what is written beside this key."


@dataclass(frozen=True)
class Key:
    """A key of a scene.

    `path` is its place, with NAME for the name of a material; `of` the shape or the law that has it, empty where all
    have. `unit` is that of a bare number. `default` is empty where the key is needed.
    """

    path: str
    of: str
    meaning: str
    unit: str
    default: str
    allowed: str
    advice: str

    @property
    def name(self) -> str:
        """Return its own name, without the table's."""
        return self.path.rpartition(".")[2]

    @property
    def table(self) -> str:
        """Return the path of its table, with the shape or law that has it; empty for the scene itself."""
        table = self.path.rpartition(".")[0]
        return f"{table} ({self.of})" if self.of else table


@cache
def keys() -> tuple[Key, ...]:
    """Return all keys of a scene, in the order of their tables."""
    based_on = Key(f"materials.{NAMED}.based_on", "", BASED_ON, "", "none", _quoted(library()), "")
    return (*_keys_of(Scene, ""), based_on)


def find(asked: str) -> list[Key]:
    """Return the keys that are meant by a key, a part of its path, a table, a shape or a law.

    A body or a material may stand there by its name. Raises PockmarkError with the nearest ones.
    """
    path = _without_names(asked.strip(" []."))
    known = keys()
    tries = (
        [key for key in known if key.path == path],
        [key for key in known if key.path.startswith(f"{path}.")],
        [key for key in known if key.of == path],
        [key for key in known if key.path.endswith(f".{path}")],
        [key for key in known if f".{path}." in key.path],
    )
    if path and (found := next((those for those in tries if those), None)):
        return found
    near = [f"'{name}'" for name in _nearest(path)]
    raise PockmarkError(f"{shown(asked, 60)}: is no key of a scene, nearest are {', '.join(near)}")


def _nearest(path: str) -> list[str]:
    """Return the paths of the three keys that are most like what was asked: as a whole, or by their own name."""
    name = path.rpartition(".")[2]

    def likeness(key: Key) -> float:
        whole = difflib.SequenceMatcher(None, path[:100], key.path).ratio()
        return max(whole, difflib.SequenceMatcher(None, name[:100], key.name).ratio())

    ranked = sorted(keys(), key=likeness, reverse=True)
    return list(dict.fromkeys(key.path for key in ranked))[:3]


def _without_names(path: str) -> str:
    """Return a path as `keys` has it: without the name of a body, and with NAME for that of a material."""
    parts = path.replace("[", ".").replace("]", "").split(".")
    if parts[0] == "body" and len(parts) > 2:
        parts = [parts[0], parts[-1]]
    if parts[0] == "materials" and len(parts) > 2 and parts[-1]:
        parts[1] = NAMED
    return ".".join(parts)


def _keys_of(
    table: type[BaseModel], path: str, of: str = "", but: frozenset[str] = frozenset()
) -> Iterator[Key]:
    """Give the keys of a table and of its tables, but for some names."""
    for name, field in table.model_fields.items():
        if name in but:
            continue
        here = f"{path}{name}"
        inner, notes = _unwrapped(field.annotation, field.metadata)
        choice = Annotated[inner, field] if field.discriminator else _item(inner)
        if kinds_of(choice)[0]:
            yield from _keys_of_kinds(choice, f"{here}.")
        elif isinstance(inner, type) and issubclass(inner, BaseModel):
            yield from _keys_of(inner, f"{here}.", of)
        elif get_origin(inner) is dict:
            yield from _keys_of(get_args(inner)[1], f"{here}.{NAMED}.", of)
        else:
            yield _key(here, of, field, inner, notes)


def _keys_of_kinds(choice: Any, path: str) -> Iterator[Key]:
    """Give the keys of a table that is one of some kinds: first those that all have, then those of each."""
    selector, kinds = kinds_of(choice)
    members = members_of(choice)
    shared = frozenset.intersection(*(frozenset(_inherited(member)) for member in members)) - {selector}
    first = members[0].model_fields[selector]
    yield Key(f"{path}{selector}", "", first.description or "", "", "", _quoted(kinds), "")
    yield from _keys_of(members[0], path, but=frozenset(members[0].model_fields) - shared)
    for kind, member in zip(kinds, members, strict=True):
        yield from _keys_of(member, path, kind, but=shared | {selector})


def _inherited(member: type[BaseModel]) -> set[str]:
    """Return the keys that a table has from the tables it is made of."""
    return {name for base in member.__bases__ if issubclass(base, Model) for name in base.model_fields}


def _key(path: str, of: str, field: FieldInfo, inner: Any, notes: list[Any]) -> Key:
    """Return a key that is no table."""
    unit = next((note.unit for note in notes if isinstance(note, Quantity)), "")
    hints = [note for note in notes if isinstance(note, Hint)]
    allowed = "; ".join([*_range(inner, notes), *(hint.allowed for hint in hints if hint.allowed)])
    advice = "; ".join(hint.advice for hint in hints if hint.advice)
    default = "" if field.is_required() else _written(field.default, unit)
    return Key(path, of, field.description or "", unit, default, allowed, advice)


def _item(annotation: Any) -> Any:
    """Return what a list has; the annotation itself if it is no list."""
    return get_args(annotation)[0] if get_origin(annotation) is tuple else annotation


def _unwrapped(annotation: Any, notes: list[Any]) -> tuple[Any, list[Any]]:
    """Return a type without its notes, without None, and for a list of equal items the items' notes too."""
    notes = [*notes]
    for note in [note for note in notes if isinstance(note, FieldInfo)]:
        notes += note.metadata
    if get_origin(annotation) is Annotated and not kinds_of(annotation)[0]:
        inner, *more = get_args(annotation)
        return _unwrapped(inner, [*more, *notes])
    options = [option for option in get_args(annotation) if option is not type(None)]
    if get_origin(annotation) in (Union, UnionType) and len(options) == 1:
        return _unwrapped(options[0], notes)
    if get_origin(annotation) is tuple and not kinds_of(options[0])[0]:
        return annotation, _unwrapped(options[0], notes)[1]
    return annotation, notes


def _range(inner: Any, notes: list[Any]) -> Iterator[str]:
    """Give what a type and its notes allow, in words; nothing where they allow any number."""
    if get_origin(inner) is Literal:
        yield _quoted(get_args(inner))
    elif inner is bool:
        yield "true, false"
    elif inner is str:
        yield "a text"
    else:
        items = [option for option in get_args(inner) if option is not Ellipsis]
        each = f"{CORNERS[len(items)]}, each " if len(items) in CORNERS else "each " if items else ""
        if bounds := _bounds(notes):
            yield each + bounds


def _bounds(notes: list[Any]) -> str:
    """Return the range of a number in words; empty if it has none."""
    lows = [(note.low, "") for note in notes if isinstance(note, Quantity)]
    highs = [(note.high, "") for note in notes if isinstance(note, Quantity)]
    lows += [(float(note.gt), "more than ") for note in notes if isinstance(note, limits.Gt)]  # type: ignore[arg-type]
    lows += [(float(note.ge), "") for note in notes if isinstance(note, limits.Ge)]  # type: ignore[arg-type]
    highs += [(float(note.lt), "less than ") for note in notes if isinstance(note, limits.Lt)]  # type: ignore[arg-type]
    highs += [(float(note.le), "") for note in notes if isinstance(note, limits.Le)]  # type: ignore[arg-type]
    unit = next((f" {note.unit}" for note in notes if isinstance(note, Quantity) and note.unit), "")
    low, above = max(lows, default=(-math.inf, ""))
    high, below = min(highs, default=(math.inf, ""))
    if math.isinf(high):
        return "" if math.isinf(low) else f"{above}{low:g}{unit}" + ("" if above else " or more")
    if above or below:
        return f"{above}{low:g}, {below or 'up to '}{high:g}{unit}"
    return f"{low:g} to {high:g}{unit}"


def _quoted(names: Any) -> str:
    """Return names as TOML writes them."""
    return ", ".join(f'"{name}"' for name in names)


def _written(value: Any, unit: str) -> str:
    """Return a default as a scene writes it."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    return f"{value:g} {unit}".strip()
