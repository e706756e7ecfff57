"""The one kind of error that a user's mistake raises, and how its sentence is kept short and printable."""

import difflib
import reprlib
from collections.abc import Iterable, Sequence
from typing import Any

MAX_SENTENCE = 480  # characters of an error
MAX_FAULTS = 360  # characters of faults that are told together


class PockmarkError(Exception):
    """A mistake of the user's, told in one clear sentence: where, what was found, what is allowed."""

    def __init__(self, sentence: str) -> None:
        """Keep a sentence that a terminal can print."""
        super().__init__(shown(sentence, MAX_SENTENCE))


_short = reprlib.Repr()
_short.maxstring = _short.maxlong = _short.maxother = 60


def found(value: Any) -> str:
    """Return "found 'x'", short enough for a sentence."""
    return f"found {_short.repr(value)}"


def shown(text: object, limit: int = 200) -> str:
    """Return a user's text as a terminal or a picture may show it, in at most `limit` characters.

    Control characters, direction characters and line ends become escapes. A long text keeps its beginning and its
    end.
    """
    escaped = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in _cut(str(text), limit))
    return _cut(escaped, limit)


def _cut(text: str, limit: int) -> str:
    """Return a text, or its beginning and its end if it has more than `limit` characters."""
    if len(text) <= limit:
        return text
    end = limit // 4
    return f"{text[: limit - end - 5]} ... {text[-end:]}"


def nearest(name: str, known: Iterable[str]) -> list[str]:
    """Return the three known names that are most like one that is not known."""
    return difflib.get_close_matches(name[:100], [*known], n=3, cutoff=0.0)


def together(faults: Sequence[str]) -> str:
    """Return faults as one sentence. Those that would make it too long are only counted."""
    told = list(dict.fromkeys(faults))
    if len(told) > 1:
        told = [shown(fault, MAX_FAULTS * 2 // 3) for fault in told]
    length = 0
    for n, fault in enumerate(told):
        length += len(fault) + 2
        if n and length > MAX_FAULTS:
            return f"{'; '.join(told[:n])}; and {len(told) - n} more"
    return "; ".join(told)
