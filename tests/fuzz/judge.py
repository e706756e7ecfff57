"""What an answer may be: a result, or one clear sentence. Anything else is a fault, named "kind: detail"."""

import contextlib
import io
import math
import sys
import traceback
import unicodedata
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from unittest import mock

from pockmark import PockmarkError, cli

LONGEST = 500  # characters of a sentence
LARGEST, SMALLEST = 1e100, 1e-100  # of any quantity in SI units: beyond is no physics
OUTCOMES = ("accepted", "doubtful, nothing found", "doubtful", "stopped", "refused", "traceback")


@dataclass
class Verdict:
    """How a case ended, the worst of its answers, and what was wrong with them."""

    outcome: str = OUTCOMES[0]
    faults: list[str] = field(default_factory=list)

    def ends(self, outcome: str) -> None:
        """Note an outcome, unless there was a worse one."""
        self.outcome = max(self.outcome, outcome, key=OUTCOMES.index)


def answer(verdict: Verdict, ask: Callable[[], Any], otherwise: str = "refused") -> Any:
    """Return what `ask` returns, None where it refuses in one sentence, which is the outcome `otherwise`. Faults go into the
    verdict."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            result = ask()
        except PockmarkError as error:
            result = None
            verdict.ends(otherwise)
            verdict.faults += faults_of_sentence(str(error))
        except (Exception, SystemExit) as error:
            result = None
            verdict.ends("traceback")
            verdict.faults.append(f"traceback: {type(error).__name__} {_place(error)}: {str(error)[:100]!r}")
    said = {f"warning: {w.category.__name__} {str(w.message)[:100]!r}" for w in warned}
    verdict.faults += sorted(said)
    return result


def _place(error: BaseException) -> str:
    """Return where pockmark's last function was, as "file:function"."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "/pockmark/" in f.filename]
    return f"{frames[-1].filename.rpartition('/')[2]}:{frames[-1].name}" if frames else "outside pockmark"


def faults_of_sentence(text: str) -> Iterator[str]:
    """Yield what is wrong with a sentence for the terminal."""
    if not text.strip():
        yield "empty sentence: "
    if len(text) > LONGEST:
        yield f"long sentence: {len(text)} characters: {text[:80]!r}"
    if len(text.splitlines()) > 1:
        yield f"more than a line: {text[:80]!r}"
    elif control := controls(text):
        yield f"control character: {control!r} in {text[:80]!r}"


def controls(text: str, allowed: str = "") -> str:
    """Return the characters of a text that steer a terminal or that no terminal has."""
    return "".join(
        sorted({c for c in text if c not in allowed and unicodedata.category(c) in ("Cc", "Zl", "Zp", "Cs")})
    )


def absurd(table: Mapping[str, Any], key: str = "") -> Iterator[str]:
    """Yield a fault for each number of an accepted scene that no physics has."""
    for name, value in table.items():
        yield from _absurd(value, f"{key}.{name}" if key else str(name))


def _absurd(value: Any, key: str) -> Iterable[str]:
    if isinstance(value, Mapping):
        return absurd(value, key)
    if isinstance(value, list):
        return (fault for item in value for fault in _absurd(item, key))
    if isinstance(value, float) and value and not SMALLEST < abs(value) < LARGEST:
        return [f"absurd value: {key} = {value:g}"]
    return []


def command(arguments: list[str]) -> tuple[Any, str, str]:
    """Run the command line here. Returns the exit code, and what it wrote to stdout and stderr, both as UTF-8."""
    out, err = (
        io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors=how) for how in ("strict", "backslashreplace")
    )
    code: Any = 0
    argv = mock.patch.object(sys, "argv", ["pockmark", *arguments])
    with argv, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main()
        except SystemExit as stop:
            code = stop.code or 0
    texts = []
    for stream in (out, err):
        stream.flush()
        texts.append(stream.buffer.getvalue().decode())  # type: ignore[attr-defined]
    return code, texts[0], texts[1]


def faults_of_command(code: Any, out: str, err: str) -> Iterator[str]:
    """Yield what is wrong with what a command wrote and returned: 0, or 2 (130, 3) with a sentence."""
    if code not in (0, 2, 3):
        yield f"exit code: {code!r}, {err[:80]!r}"
    if code == 2:
        yield from faults_of_sentence(err.removesuffix("\n"))
    elif err:
        yield f"noise: {err[:80]!r}"
    if control := controls(out, allowed="\n"):
        yield f"control character: {control!r} in the output"


def faults_of_forecast(expected: Any) -> Iterator[str]:
    """Yield what is wrong with a forecast: it is finite, and warns in sentences."""
    for name in ("points", "cells", "steps", "memory", "seconds"):
        value = getattr(expected, name)
        if not (math.isfinite(value) and value > 0):
            yield f"forecast: {name} is {value}"
    for warning in expected.warnings:
        yield from faults_of_sentence(warning)
