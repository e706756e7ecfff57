"""The ledger's keys, and what each means.

The core adds them up, the history and the manifest keep them, results and pictures show them. This is the one list of
them in Python.
"""

LEDGER = {
    "kinetic": "energy of the points' motion in the grid, J",
    "internal": "internal energy of the points in the grid, J",
    "absorbed": "energy that the transmitting faces took, J",
    "left_kinetic": "energy of motion that points took with them as they left, J",
    "left_internal": "internal energy that points took with them as they left, J",
    "viscous": "what bulk viscosity has turned into internal energy so far, J: a part of `internal`, not beside it",
    "plastic": "what plastic flow has turned into internal energy so far, J: a part of `internal`, not beside it",
    "filtered": "what filters have turned into internal energy so far, J: a part of `internal`, not beside it",
    "pic": "energy that the PIC share took, J",
    "contact": "energy that contact and its friction took, J",
    "initial": "kinetic and internal energy at the start, J",
    "error": "sum of all energies but `viscous`, `plastic` and `filtered`, less `initial`, J",
    "mass": "mass of the points in the grid, kg",
    "left_mass": "mass of the points that left, kg",
    "momentum_x": "momentum along x of the points in the grid, kg m/s",
    "momentum_y": "momentum along y of the points in the grid, kg m/s",
    "momentum_z": "momentum along z of the points in the grid, kg m/s",
    "left_momentum_x": "momentum along x of the points that left, kg m/s",
    "left_momentum_y": "momentum along y of the points that left, kg m/s",
    "left_momentum_z": "momentum along z of the points that left, kg m/s",
}


def unit_of(key: str) -> str:
    """Return the unit in which a key of the ledger is kept."""
    return "kg" if key.endswith("mass") else "kg m/s" if "momentum" in key else "J"


# Keys in the order in which tables and pictures show them:
SHARES = (
    "internal",
    "kinetic",
    "absorbed",
    "left_kinetic",
    "left_internal",
    "pic",
    "contact",
    "viscous",
    "filtered",
)
DRAWN = ("kinetic", "internal", "absorbed")
LEFT_ENERGIES = ("left_kinetic", "left_internal")
LEFT_MOMENTUM = ("left_momentum_x", "left_momentum_y", "left_momentum_z")
