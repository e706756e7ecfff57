// The contract of an equation of state: pressure and its slopes at a compression and an energy. It may be any
// function of both, a table among them.
#pragma once
#include <concepts>

#include "../lanes.hpp"
#include "../law.hpp"

namespace pockmark {

// A change of volume in the three forms in which laws are written.
template <class V>
struct Compression {
  V mu;     // rho/rho0 - 1
  V eta;    // 1 - rho0/rho
  V ratio;  // V/V0 = rho0/rho

  // Makes one from V/V0 - 1, which keeps the digits of small strains.
  PM_HD static Compression of(V dilation) {
    const V ratio = V(1) + dilation;
    return {-dilation * (V(1) / ratio), -dilation, ratio};
  }
};

// What a law gives at a compression and an energy (J per m^3 of initial volume).
template <class V>
struct EosPoint {
  V pressure;                               // Pa
  V by_mu, by_energy;                       // its slopes, each with the other held
  mask_t<V> capped = Pack<V>::mask(false);  // the law limited the compression

  // Returns rho0 c^2, c^2 = dp/drho at constant entropy: dE = p rho0 drho / rho^2, where p is the pressure
  // that works.
  PM_HD V stiffness(V p, V ratio) const { return by_mu + by_energy * p * ratio * ratio; }
};

template <class M, class V>
PM_HD EosPoint<V> select(M m, const EosPoint<V>& a, const EosPoint<V>& b) {
  return {select(m, a.pressure, b.pressure), select(m, a.by_mu, b.by_mu), select(m, a.by_energy, b.by_energy),
          (m && a.capped) || (!m && b.capped)};
}

// `linear_in_energy`: one correction of the energy is exact. Optional members, of the same arguments as `at`:
// temperature (K) and phase (0 condensed, 1 partly vapour, 2 vapour), where the law knows them.
template <class L, class V>
concept EquationOfState = requires(const L law, const Compression<V> compression, V energy) {
  { L::declaration } -> std::convertible_to<Declaration>;
  { L::linear_in_energy } -> std::convertible_to<bool>;
  { law.at(compression, energy) } -> std::same_as<EosPoint<V>>;
};

}  // namespace pockmark
