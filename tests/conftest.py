"""Lets the tests of each folder import the folder's helpers."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "verification"))
