"""Docstrings begin with what a function does. Ruff's D401 looks at all functions but properties; the rest is here."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "src" / "pockmark"
PROPERTIES = {"property", "cached_property"}


def test_the_docstring_of_a_property_begins_with_return():
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.FunctionDef):
                continue
            marks = {d.id for d in node.decorator_list if isinstance(d, ast.Name)}
            if marks & PROPERTIES and (text := ast.get_docstring(node)):
                assert text.startswith("Return "), f"{path.name}: {node.name}: {text}"
