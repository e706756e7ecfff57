"""The one kind of error that a user's mistake raises."""

import reprlib
from typing import Any


class PockmarkError(Exception):
    """A mistake of the user's, told in one clear sentence: where, what was found, what is allowed."""


_short = reprlib.Repr()
_short.maxstring = _short.maxlong = _short.maxother = 60


def found(value: Any) -> str:
    """ "found 'x'", short enough for a sentence."""
    return f"found {_short.repr(value)}"
