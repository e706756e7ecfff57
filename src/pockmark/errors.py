"""The one kind of error that a user's mistake raises."""


class PockmarkError(Exception):
    """A mistake of the user's, told in one clear sentence: where, what was found, what is allowed."""
