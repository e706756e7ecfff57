"""What the tests of altered run folders share."""

import time
from pathlib import Path

import pytest

from pockmark import PockmarkError, measure
from pockmark.run.measured import surface_of_run
from pockmark.run.pictures import plot_process, plot_run

QUICK = Path(__file__).parents[2] / "examples" / "quick.toml"
LAST = "snapshot-0002.vtkhdf"


def refusal(function, *arguments):
    """The sentence that a function refuses with; it takes less than 10 s."""
    start = time.monotonic()
    with pytest.raises(PockmarkError) as caught:
        function(*arguments)
    sentence = str(caught.value)
    print(function.__name__, sentence)
    assert time.monotonic() - start < 10
    assert "\n" not in sentence
    assert len(sentence) < 500
    return sentence


def every_reader():
    """What reads a run folder's last snapshot and its manifest."""
    return (measure, plot_run, surface_of_run, plot_process)
