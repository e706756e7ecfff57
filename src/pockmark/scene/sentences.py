"""The faults of a validation as one sentence: all of them at once, each with its key."""

import difflib
from collections.abc import Iterator, Sequence
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from ..base.errors import found, together
from .model import Model

Location = tuple[int | str, ...]


def sentence(error: ValidationError, model: type[BaseModel]) -> str:
    """Return every fault of a validation of `model` in one sentence: key, what was found, what is allowed."""
    return together(faults(error.errors(), model))


def faults(details: Sequence[ErrorDetails], model: type[BaseModel]) -> list[str]:
    """Return a sentence for each fault of a validation of `model`.

    A key that is missing because it is misspelt is told once.
    """
    unknown = {f["loc"]: _meant(f, model) for f in details if f["type"] == "extra_forbidden"}
    misspelt = {(*location[:-1], meant) for location, meant in unknown.items() if meant}
    told = [f for f in details if f["loc"] not in misspelt or f["type"] != "missing"]
    told.sort(key=lambda f: f["type"] != "extra_forbidden")  # a misspelt key explains what else is wrong
    return [_sentence(fault, model, unknown.get(fault["loc"], "")) for fault in told]


def _sentence(fault: ErrorDetails, model: type[BaseModel], meant: str) -> str:
    """Return the sentence of a fault; `meant` is the key that an unknown one is most like, or empty."""
    key, kind, message = _key(fault["loc"], model), fault["type"], fault["msg"].removeprefix("Value error, ")
    if kind == "extra_forbidden":
        return f"{key}: unknown key" + (f", did you mean '{meant}'?" if meant else "")
    if kind == "missing":
        return f"{key}: is missing"
    if kind == "value_error":
        return f"{key}: {message}" if key else message
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return _which_kind(key, fault, model)
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        message = "expected a table"
    if kind == "tuple_type":
        message = "expected a list"
    if kind == "too_long":
        message = f"expected a list of at most {fault['ctx']['max_length']}"
    return f"{key}: {found(fault['input'])}, {message[0].lower()}{message[1:]}"


def _which_kind(key: str, fault: ErrorDetails, model: type[BaseModel]) -> str:
    """Return the sentence of a table that does not say which of its kinds it is."""
    *_, last = _walk(fault["loc"], model)
    selector, kinds = kinds_of(last)
    what = "is missing" if selector not in fault["input"] else found(fault["input"][selector])
    return f"{key}.{selector}: {what}, allowed are {', '.join(map(repr, kinds))}"


def _key(location: Location, model: type[BaseModel]) -> str:
    """Return a location as a user writes it: ("body", 0, "block", "radius") as "body[0].radius"."""
    out = ""
    for part, annotation in zip(location, _walk(location, model), strict=False):
        if isinstance(part, int):
            out += f"[{part}]"
        elif part not in kinds_of(annotation)[1]:  # the kind that pydantic took the table for is no key
            out += f".{part}" if out else part
    return out


def _walk(location: Location, model: type[BaseModel]) -> Iterator[Any]:
    """Give what is expected at each part of a location.

    `model` comes first; what the whole location names comes last.
    """
    expected: Any = model
    for part in location:
        yield expected
        expected = _next(expected, part)
    yield expected


def _next(expected: Any, part: int | str) -> Any:
    """Return what is expected at a part of what is expected here; None if that is not known."""
    if part in (kinds := kinds_of(expected)[1]):
        return members_of(expected)[kinds.index(str(part))]
    if isinstance(expected, type) and issubclass(expected, Model):
        key = expected.model_fields.get(str(part))
        return None if key is None else Annotated[key.annotation, key]
    if get_origin(expected) is Annotated:
        return _next(get_args(expected)[0], part)
    arguments = [a for a in get_args(expected) if a not in (type(None), ...)]
    if get_origin(expected) in (Union, UnionType):
        return _next(arguments[0], part) if len(arguments) == 1 else None
    return arguments[-1] if arguments else None  # the items of a list or tuple, the values of a dict


def kinds_of(expected: Any) -> tuple[str, list[str]]:
    """Return the key that says which of its kinds a table is, and the kinds.

    Such are ("shape", ["block", "sphere", ...]). Without kinds they are empty.
    """
    notes = get_args(expected)[1:] if get_origin(expected) is Annotated else ()
    for selector in (n.discriminator for n in notes if isinstance(n, FieldInfo)):
        if isinstance(selector, str):
            tags = [get_args(member.model_fields[selector].annotation)[0] for member in members_of(expected)]
            return selector, tags
    return "", []


def members_of(expected: Any) -> tuple[Any, ...]:
    """Return the tables from which an annotated union chooses."""
    return get_args(get_args(expected)[0])


def _meant(fault: ErrorDetails, model: type[BaseModel]) -> str:
    """Return the key that is most like an unknown one; "" if none is.

    Keys of its own table are tried first, then those of any table.
    """
    unknown = str(fault["loc"][-1])
    *_, table, _ = _walk(fault["loc"], model)
    own = set(table.model_fields) if isinstance(table, type) and issubclass(table, Model) else set()
    for keys in (own, _all_keys()):
        if near := difflib.get_close_matches(unknown, keys - {unknown}, n=1):
            return near[0]
    return ""


def _all_keys(model: type[Model] = Model) -> set[str]:
    """Return the keys of every table of a scene."""
    return set(model.model_fields).union(*(_all_keys(table) for table in model.__subclasses__()))
