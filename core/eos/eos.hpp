// What an equation of state gives the stress update: pressure as a linear function of the energy.
#pragma once
#include "../portable.hpp"

namespace pockmark {

// p = cold + thermal E at a given compression mu = rho/rho0 - 1 (Pa; E in J per m^3 of initial volume).
// The slopes are by mu.
template <class T>
struct Isochore {
  T cold, thermal, cold_slope, thermal_slope;
  bool capped = false;  // mu was limited

  PM_HD T pressure(T energy) const { return cold + thermal * energy; }
  // rho0 c^2, c^2 = dp/drho at constant entropy: dE = p rho0 drho / rho^2; ratio = V/V0.
  PM_HD T stiffness(T p, T energy, T ratio) const {
    return cold_slope + thermal_slope * energy + thermal * p * ratio * ratio;
  }
};

}  // namespace pockmark
