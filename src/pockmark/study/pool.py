"""What makes the runs of a campaign, wherever that is. The campaign knows no more of it than this."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from .order import Order


class Pool(Protocol):
    """Something that takes orders, and gives the runs as they are over."""

    def finished(self, orders: Sequence[Order], between: Callable[[], None]) -> Iterator[tuple[int, str]]:
        """Give (n, why it failed, or an empty text) for each order n, as the runs are over.

        `between` is called several times a second. What it raises comes through when no process works any more.
        Raises PockmarkError where no run can be made.
        """
