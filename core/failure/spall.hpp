// A spall pressure: what is pulled apart harder fails, whatever its strength. Fits where the strain rate at
// which the constant was measured is that of the impact.
#pragma once
#include <array>

#include "failure.hpp"

namespace pockmark {

inline constexpr std::array spall_constants{
    Constant{"pressure", "Pa", 1, 1e12, "tension at which the material comes apart"},
};

template <class T>
struct Spall {
  static constexpr Declaration declaration{"spall", "fails at a tension, plastic strain or not",
                                           "D = 1 where -p >= pressure", "", spall_constants};
  static constexpr bool may_fail = true, needs_flow = false;
  T pressure;

  Spall() = default;
  explicit Spall(const Constants& given) : pressure(T(given["pressure"])) {}

  template <class V>
  PM_HD mask_t<V> may_act(V mean_stress) const {
    return V(pressure) <= mean_stress;
  }
  template <class V>
  PM_HD DamageStep<V> step(const Loading<V>& at) const {
    return {select(may_act(at.mean_stress), V(1), V(0))};
  }
};

}  // namespace pockmark
