"""What each counter of core/audit.hpp counts, for who reads a result."""

COUNTERS = {
    "left_points": "points that left through a free or transmitting face",
    "lost_points": "points that left through a symmetry or fixed face: a numerical fault",
    "failed_points": "points whose damage reached one: no more shear, no tension",
    "melted_points": "of the failed points, those that reached the melting temperature",
    "failure_treatments": "plastic steps of a point in which the failure treatment changed the law",
    "eos_caps": "steps of a point whose compression was capped short of the Hugoniot's pole",
    "return_failures": "steps of a point whose return to the yield surface did not converge: a numerical fault",
    "eos_failures": "steps of a point whose energy and pressure did not converge together: a numerical fault",
    "node_cutoffs": "steps of a node lighter than numerics.mass_cutoff, whose force was scaled down",
    "strain_limited_steps": "steps set by numerics.strain_limit, not by the fastest wave",
    "negative_energies": "steps of a point with less internal energy than at rest, by a thousandth of its heat: impossible",
    "negative_volumes": "steps of a point without volume: impossible",
    "negative_temperatures": "steps of a point below 0 K: impossible",
}
