"""What the laws declare of themselves, and docs/input.md, which says it again. Run as a script it writes it there."""

import re
from pathlib import Path

import pytest

import pockmark._core as core
from pockmark.base.units import to_si

PAGE = Path(__file__).parents[2] / "docs" / "input.md"
SECTION = re.compile("(?<=<!-- laws -->\n).*(?=<!-- end of laws -->)", re.DOTALL)
LAWS = [(kind, law) for kind, laws in core.laws().items() for law in laws]


def described(kind, law):
    """Yield the lines of a law for the page."""
    yield f'### `{kind}.model = "{law["name"]}"`'
    yield ""
    yield f"{law['doc'][0].upper()}{law['doc'][1:]}: `{law['equation']}`." + (
        f" {law['source']}." if law["source"] else ""
    )
    yield ""
    if law["constants"]:
        yield "| constant | allowed | default | what it is |"
        yield "|---|---|---|---|"
    for c in law["constants"]:
        allowed = ", ".join(f"`{name}`" for name in c["choices"])
        allowed = allowed or f"{c['least']:g} to {c['most']:g} {c['unit']}".strip()
        if c["above"]:
            allowed += f", more than `{c['above']}`"
        default = "" if c["default"] is None else f"{c['default']:g}"
        yield f"| `{c['name']}` | {allowed} | {default} | {c['doc']} |"
    if law["constants"]:
        yield ""


def section():
    return "\n".join(line for kind, law in LAWS for line in described(kind, law)) + "\n"


def test_the_page_says_what_the_laws_declare():
    assert SECTION.search(PAGE.read_text(encoding="utf-8"))[0] == section(), f"run {Path(__file__).name}"


@pytest.mark.parametrize(("kind", "law"), LAWS, ids=[f"{kind}: {law['name']}" for kind, law in LAWS])
def test_a_declaration_is_complete(kind, law):
    assert law["doc"]
    assert law["equation"]
    for c in law["constants"]:
        assert c["doc"]
        assert c["least"] < c["most"]
        if c["unit"]:
            assert to_si(f"{c['most']!r} {c['unit']}", c["unit"]) == pytest.approx(c["most"])
        if c["default"] is not None:
            assert c["least"] <= c["default"] <= c["most"]


if __name__ == "__main__":
    PAGE.write_text(SECTION.sub(lambda _: section(), PAGE.read_text(encoding="utf-8")), encoding="utf-8")
