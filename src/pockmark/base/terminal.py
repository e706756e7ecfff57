"""A user's texts on the terminal: shown as they are, never read as markup."""

from rich.console import Console
from rich.text import Text

from .errors import shown


def make_console() -> Console:
    """Return a console to which square brackets and colons are no markup. Colours are given as styles."""
    return Console(markup=False, emoji=False)


def literal(text: object, style: str = "", limit: int = 1000) -> Text:
    """Return a text that any console prints as it is, in a style of rich's.

    Control characters become escapes. What exceeds `limit` characters is cut out of the middle.
    """
    return Text(shown(text, limit), style)
