"""A validation's faults as one sentence."""

import difflib

from pydantic import ValidationError

from .materials import Model


def sentence(error: ValidationError) -> str:
    """The first fault of a validation as one sentence: key, what was found, what is allowed."""
    first = error.errors()[0]
    key = _key(first["loc"])
    kind, message, found = first["type"], first["msg"].removeprefix("Value error, "), first.get("input")
    if kind == "extra_forbidden":
        near = difflib.get_close_matches(str(first["loc"][-1]), _all_keys(), n=1)
        return f"{key}: unknown key" + (f", did you mean '{near[0]}'?" if near else "")
    if kind == "missing":
        return f"{key}: is missing"
    if kind == "value_error":
        return f"{key}: {message}" if key else message
    return f"{key}: found {found!r}, {message[0].lower()}{message[1:]}"


def _key(location: tuple[int | str, ...]) -> str:
    """("body", 0, "block", "radius") as "body[0].radius"."""
    tags = {"block", "sphere", "mie-gruneisen", "linear", "johnson-cook", "elastic", "fluid"}
    out = ""
    for i, part in enumerate(location):
        if isinstance(part, int):
            out += f"[{part}]"
        elif not (part in tags and i > 0):
            out += f".{part}" if out else part
    return out


def _all_keys(model: type[Model] = Model) -> set[str]:
    """The keys of every table of a scene."""
    return set(model.model_fields).union(*(_all_keys(table) for table in model.__subclasses__()))
