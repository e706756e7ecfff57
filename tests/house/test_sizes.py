"""No function and no file is too long to read at once.

`python tests/house/test_sizes.py 589cf36 HEAD` prints the longest ones of some commits.
"""

import ast
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
LONGEST_FUNCTION, LONGEST_FILE = 60, 300  # lines, of Python in src
CPP = (".cpp", ".hpp", ".cu", ".cuh")


def python_functions(text):
    """Return the lines and the name of each function, its docstring and decorators included."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
            yield node.end_lineno - first + 1, node.name


def cpp_functions(text):
    """Return the lines and the name of each function, found by its braces: about right, without a compiler."""
    text = re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', "", text)
    blocks, start = [], 0  # of each open brace: the line of a function's head, and its name; None of another
    for at in (m.start() for m in re.finditer(r"[{};]", text)):
        head, line = text[start:at], text.count("\n", 0, at) + 1
        start = at + 1
        if text[at] == "{":
            called = re.search(r"([\w~:]+|operator\W+)\s*\(", head)
            is_function = (
                called
                and re.search(r"\)[\s\w:>&<,*.()-]*$", head)
                and "[" not in head
                and called[1] not in ("if", "for", "while", "switch", "catch", "requires")
                and all(block is None for block in blocks)
            )
            inner = (
                re.search(r"\b(if|for|while|switch|else|do|try|catch)\b", head) or "[" in head or "=" in head
            )
            opening = line - head.lstrip().count("\n")
            blocks.append((opening, called[1]) if is_function else (0, "") if inner else None)
        elif text[at] == "}" and blocks and (block := blocks.pop()) and block[1]:
            yield line - block[0] + 1, block[1]


def sizes(files):
    """Return rows of what is longest among some files (path: text): functions and files, of Python and of C++."""
    rows = {}
    for name, endings, functions in (
        ("Python", (".py",), python_functions),
        ("C++", CPP, cpp_functions),
    ):
        own = {path: text for path, text in files.items() if path.endswith(endings)}
        found = [(n, f"{path}: {f}") for path, text in own.items() for n, f in functions(text)]
        lengths = sorted(((text.count("\n"), path) for path, text in own.items()), reverse=True)
        rows[f"longest function, {name}"] = "{} ({})".format(*max(found))
        rows[f"longest file, {name}"] = "{} ({})".format(*lengths[0])
        rows[f"files over {LONGEST_FILE} lines, {name}"] = str(sum(n > LONGEST_FILE for n, _ in lengths))
    return rows


def at_commit(commit):
    """Return the text of each file of src and core at a commit, by its path."""

    def git(*arguments):
        return subprocess.run(
            ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout

    paths = git("ls-tree", "-r", "--name-only", commit, "src", "core").splitlines()
    return {path: git("show", f"{commit}:{path}") for path in paths if path.endswith((".py", *CPP))}


def test_python_is_short():
    for path in sorted((ROOT / "src").rglob("*.py")):
        text = path.read_text()
        assert text.count("\n") <= LONGEST_FILE, f"{path.name} has {text.count(chr(10))} lines"
        for lines, function in python_functions(text):
            assert lines <= LONGEST_FUNCTION, f"{path.name}: {function} has {lines} lines"


if __name__ == "__main__":
    tables = {commit: sizes(at_commit(commit)) for commit in sys.argv[1:]}
    print(f"| lines | {' | '.join(tables)} |\n|---|{'---|' * len(tables)}")
    for row in next(iter(tables.values())):
        print(f"| {row} | {' | '.join(table[row] for table in tables.values())} |")
