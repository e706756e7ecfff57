"""Lets the tests of each folder import the helpers of some, and asks for the fuzzer's long form."""

import sys
from pathlib import Path

for folder in ("verification", "run", "cli"):
    sys.path.insert(0, str(Path(__file__).parent / folder))


def pytest_addoption(parser):
    parser.addoption(
        "--fuzz-long", action="store_true", help="tests/fuzz: 20,000 scenes, 300 folders, 300 runs"
    )
