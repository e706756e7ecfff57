// Energy and pressure of a step, solved together: E1 = known - work p1, p1 = p(mu, E1).
#pragma once
#include <limits>

#include "eos.hpp"

namespace pockmark {

// Returns p1 by Newton's method from a point at the energy known - paid: exact for a law that is linear in
// the energy.
template <class V>
PM_HD V corrected_pressure(const EosPoint<V>& point, V paid, V work) {
  const V share = V(1) / (V(1) + point.by_energy * work);  // ready before what it multiplies
  return share * (point.pressure + point.by_energy * paid);
}

template <class V>
struct SolvedPressure {
  V pressure;
  mask_t<V> converged;
};

// Returns p1 of a law that is not linear in the energy, from a first estimate. Two corrections are the rule;
// at a kink of the law they come down by the share of the work in the pressure, a tenth or so, each.
template <class Law, class V>
PM_HD SolvedPressure<V> refined_pressure(const Law& law, const Compression<V>& change, V pressure, V known,
                                         V work) {
  using T = number_t<V>;
  constexpr T tolerance = sizeof(T) == 8 ? T(1e-10) : T(32) * std::numeric_limits<T>::epsilon();
  auto converged = Pack<V>::mask(false);
  for (int correction = 0; correction < 12; ++correction) {
    const V energy = known - work * pressure;
    const auto point = law.at(change, energy);
    const V next = corrected_pressure(point, known - energy, work);
    const V scale = absolute(next) + absolute(point.by_mu * change.mu) + absolute(point.by_energy * energy);
    converged = absolute(next - pressure) <= tolerance * scale;
    pressure = next;
    if (!any(!converged)) break;
  }
  return {pressure, converged};
}

}  // namespace pockmark
