// What an equation of state is given, and what it gives the stress update: pressure as a linear function of
// the energy.
#pragma once
#include "../lanes.hpp"

namespace pockmark {

// A change of volume in the three forms in which laws are written.
template <class V>
struct Compression {
  V mu;     // rho/rho0 - 1
  V eta;    // 1 - rho0/rho
  V ratio;  // V/V0 = rho0/rho
};

// p = cold + thermal E at a given compression mu = rho/rho0 - 1 (Pa; E in J per m^3 of initial volume).
// The slopes are by mu.
template <class V>
struct Isochore {
  V cold, thermal, cold_slope, thermal_slope;
  mask_t<V> capped = Pack<V>::mask(false);  // mu was limited

  PM_HD V pressure(V energy) const { return cold + thermal * energy; }
  // rho0 c^2, c^2 = dp/drho at constant entropy: dE = p rho0 drho / rho^2; ratio = V/V0.
  PM_HD V stiffness(V p, V energy, V ratio) const {
    return cold_slope + thermal_slope * energy + thermal * p * ratio * ratio;
  }
};

template <class M, class V>
PM_HD Isochore<V> select(M m, const Isochore<V>& a, const Isochore<V>& b) {
  return {select(m, a.cold, b.cold), select(m, a.thermal, b.thermal), select(m, a.cold_slope, b.cold_slope),
          select(m, a.thermal_slope, b.thermal_slope), (m && a.capped) || (!m && b.capped)};
}

}  // namespace pockmark
