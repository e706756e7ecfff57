"""What the terminal shows of a user's texts: the texts themselves."""

from rich.console import Console
from rich.text import Text

from .errors import shown


def make_console() -> Console:
    """Return a console to which square brackets and colons are no markup; colours are given as styles."""
    return Console(markup=False, emoji=False)


def literal(text: object, style: str = "", limit: int = 1000) -> Text:
    """Return a text that any console prints as it is, but for control characters and what is beyond `limit` characters, in a
    style of rich's."""
    return Text(shown(text, limit), style)
