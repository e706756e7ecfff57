"""The counters of core/audit.hpp: what each counts, and which make a run doubtful.

This is the one list of them in Python.
"""

from typing import NamedTuple


class Counter(NamedTuple):
    """What a counter counts, and what its points did if that makes a run doubtful.

    `doubt` is empty for a counter of physics, or of the method at work.
    """

    what: str
    doubt: str = ""


COUNTERS = {
    "left_points": Counter("points that left through a free or transmitting face"),
    "lost_points": Counter(
        "points that left through a symmetry or fixed face: a numerical fault",
        "left through a symmetry or fixed face",
    ),
    "failed_points": Counter("points whose damage reached one: no more shear, no tension"),
    "melted_points": Counter("of the failed points, those that reached the melting temperature"),
    "failure_treatments": Counter("plastic steps of a point in which the failure treatment changed the law"),
    "eos_caps": Counter(
        "steps of a point whose compression was capped short of the Hugoniot's pole",
        "were compressed to the limit of their equation of state",
    ),
    "return_failures": Counter(
        "steps of a point whose return to the yield surface did not converge: a numerical fault",
        "did not return to the yield surface",
    ),
    "eos_failures": Counter(
        "steps of a point whose energy and pressure did not converge together: a numerical fault",
        "had an energy and a pressure that did not agree",
    ),
    "node_cutoffs": Counter("steps of a node lighter than numerics.mass_cutoff, whose force was scaled down"),
    "strain_limited_steps": Counter("steps set by numerics.strain_limit, not by the fastest wave"),
    "negative_energies": Counter(
        "steps of a point with less internal energy than at rest, by a thousandth of its heat: impossible",
        "had less internal energy than at rest",
    ),
    "negative_volumes": Counter("steps of a point without volume: impossible", "had no volume left"),
    "negative_temperatures": Counter("steps of a point below 0 K: impossible", "were colder than 0 K"),
}
DOUBTFUL = {name: counter.doubt for name, counter in COUNTERS.items() if counter.doubt}
GONE = ("left_points", "lost_points")  # these and the points in the grid are all points of a run
