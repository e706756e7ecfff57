"""What is said elsewhere of a crater's measure, as a report shows it."""

from typing import NamedTuple


class Claim(NamedTuple):
    """What an equation or a measurement says of a measure: from `low` to `high`, None where it says nothing.

    `note` says of what, or why nothing is said.
    """

    source: str
    low: float | None
    high: float | None
    note: str


class Compared(NamedTuple):
    """A measure without a unit, its value in a run (None without a crater), and what is said of it elsewhere."""

    name: str
    value: float | None
    claims: tuple[Claim, ...]

    def over(self, claim: Claim) -> float | None:
        """Return the run's value over the claimed one, 1 within a claimed range; None if one is not known."""
        if self.value is None or not claim.low or not claim.high:
            return None
        return self.value / min(max(self.value, claim.low), claim.high)
