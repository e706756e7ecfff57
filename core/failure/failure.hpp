// The contract of a failure law: the damage that a step adds to a stressed point. At damage 1 the point has
// failed: it carries neither shear nor tension any more.
#pragma once
#include <concepts>

#include "../lanes.hpp"
#include "../law.hpp"

namespace pockmark {

// What a failure law is told of a point after its stress.
template <class V>
struct Loading {
  V strain_increment, rate;  // plastic
  V mean_stress;             // positive in tension
  V effective_stress, temperature, damage;
  V cell;  // of the grid, m: the layer in which strain without a length of its own gathers is as thick
};

template <class V>
struct DamageStep {
  V increment = V(0);
  mask_t<V> treated = Pack<V>::mask(false);  // a treatment changed the law
};

// `may_fail`: whether anything fails a point, melting among it. `needs_flow`: damage comes with plastic
// strain alone, and only points that yield are looked at; a law without it says with may_act(mean_stress),
// cheaply, which are.
template <class L, class V>
concept FailureLaw = requires(const L law, const Loading<V> loading) {
  { L::declaration } -> std::convertible_to<Declaration>;
  { L::may_fail } -> std::convertible_to<bool>;
  { L::needs_flow } -> std::convertible_to<bool>;
  { law.step(loading) } -> std::same_as<DamageStep<V>>;
} && (L::needs_flow || requires(const L law, V mean_stress) {
                       { law.may_act(mean_stress) } -> std::same_as<mask_t<V>>;
                     });

template <class T>
struct NoFailure {
  static constexpr Declaration declaration{"none", "nothing fails, nor does what melts", "dD = 0", "", {}};
  static constexpr bool may_fail = false, needs_flow = true;

  NoFailure() = default;
  explicit NoFailure(const Constants&) {}
  template <class V>
  PM_HD DamageStep<V> step(const Loading<V>&) const {
    return {};
  }
};

}  // namespace pockmark
