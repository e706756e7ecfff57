"""A validation's faults as one sentence."""

import difflib

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from .errors import found
from .materials import Model

# The tables whose keys depend on one of them: that key, and what it may be.
KINDS = {
    "body": ("shape", ("block", "sphere")),
    "eos": ("model", ("mie-gruneisen", "linear")),
    "strength": ("model", ("johnson-cook", "elastic", "fluid")),
}


def sentence(error: ValidationError) -> str:
    """The first fault of a validation as one sentence: key, what was found, what is allowed."""
    faults = error.errors()
    fault = faults[0]
    if fault["type"] == "missing":  # more likely misspelt than forgotten
        fault = next((f for f in faults if f["type"] == "extra_forbidden"), fault)
    key, kind, message = _key(fault["loc"]), fault["type"], fault["msg"].removeprefix("Value error, ")
    if kind == "extra_forbidden":
        unknown = str(fault["loc"][-1])
        near = difflib.get_close_matches(unknown, _all_keys() - {unknown}, n=1)
        return f"{key}: unknown key" + (f", did you mean '{near[0]}'?" if near else "")
    if kind == "missing":
        return f"{key}: is missing"
    if kind == "value_error":
        return f"{key}: {message}" if key else message
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return _which_kind(key, fault)
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        message = "expected a table"
    if kind in ("tuple_type", "too_long"):
        message = "expected a list of 3"
    return f"{key}: {found(fault['input'])}, {message[0].lower()}{message[1:]}"


def _which_kind(key: str, fault: ErrorDetails) -> str:
    """A table that does not say which of its kinds it is."""
    selector, kinds = KINDS[next(part for part in reversed(fault["loc"]) if isinstance(part, str))]
    what = "is missing" if selector not in fault["input"] else found(fault["input"][selector])
    return f"{key}.{selector}: {what}, allowed are {', '.join(map(repr, kinds))}"


def _key(location: tuple[int | str, ...]) -> str:
    """("body", 0, "block", "radius") as "body[0].radius"."""
    out, table = "", ""
    for part in location:
        if isinstance(part, int):
            out += f"[{part}]"
        # After a body's number, eos or strength comes the kind that the table was taken for: no key.
        elif part not in KINDS.get(table, ("", ()))[1]:
            out += f".{part}" if out else part
            table = part
    return out


def _all_keys(model: type[Model] = Model) -> set[str]:
    """The keys of every table of a scene."""
    return set(model.model_fields).union(*(_all_keys(table) for table in model.__subclasses__()))
