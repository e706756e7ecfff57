"""What is done again and again, but not too often."""

import time
from collections.abc import Callable

PACE = 1.0  # s between questions to a file system that others share, or to a scheduler


def every(seconds: float, act: Callable[[], None]) -> Callable[[], None]:
    """Return a function that acts when it is called, but not again before so many seconds are over."""
    last = -float("inf")

    def paced() -> None:
        nonlocal last
        if time.monotonic() - last >= seconds:
            last = time.monotonic()
            act()

    return paced
