"""Ctrl-C, SIGTERM and SIGHUP during a run."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class _Note:
    """A signal handler that only notes that it was called."""

    asked = False

    def __call__(self, _number: int, _frame: FrameType | None) -> None:
        self.asked = True

    def stop_if_asked(self) -> None:
        """Raise KeyboardInterrupt if the handler was called."""
        if self.asked:
            raise KeyboardInterrupt


@contextmanager
def heard_between_steps() -> Iterator[Callable[[], None]]:
    """Give a function that raises KeyboardInterrupt if one of SIGNALS has come. They do nothing else meanwhile.

    So no file is torn, and an impatient second Ctrl-C does not lose what the first one keeps. An inner one of these
    shares what the outer one has noted.
    """
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    note = next((handler for handler in handlers.values() if isinstance(handler, _Note)), None) or _Note()
    old = {}
    if threading.current_thread() is threading.main_thread():  # no other may set handlers
        for number, handler in handlers.items():
            if handler not in (signal.SIG_IGN, None):  # ignored as under nohup; or not set by Python
                old[number] = signal.signal(number, note)
    try:
        yield note.stop_if_asked
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
