"""What comes with the package beside its code: examples and campaigns.

A wheel has them in `shipped`; in a checkout they lie beside `src`.
"""

from pathlib import Path

from .errors import PockmarkError, nearest, shown

_PACKAGE = Path(__file__).parents[1]


def shipped(kind: str) -> Path:
    """Return the folder of the "examples" or of the "studies"."""
    inside = _PACKAGE / "shipped" / kind
    return inside if inside.is_dir() else _PACKAGE.parents[1] / kind


def examples() -> dict[str, Path]:
    """Return the scenes that come with the package, by name."""
    return {path.stem: path for path in sorted(shipped("examples").glob("*.toml"))}


def example(name: str) -> Path:
    """Return the file of an example. Raises PockmarkError with the nearest names for one that is not there."""
    if name not in (known := examples()):
        near = ", ".join(nearest(name, known))
        raise PockmarkError(
            f"{shown(name, 60)}: is no example, nearest are {near} (pockmark new --list has all)"
        )
    return known[name]
