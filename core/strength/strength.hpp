// The contract of a strength law: a shear modulus, and, of a law that yields, the flow stress and its slopes.
// The return to the yield surface is in return_map.hpp, once for all laws.
#pragma once
#include <concepts>

#include "../lanes.hpp"
#include "../law.hpp"

namespace pockmark {

// What a strength law is told of a point: what stays while the point returns to the yield surface.
template <class V>
struct Conditions {
  V temperature, pressure, ratio, damage;  // ratio: V/V0
};

// Flow stress (Pa) at a plastic strain and the logarithm of its rate. Slopes are by the logarithms of both,
// and finite where the strain is 0.
template <class V>
struct Flow {
  V stress;
  V by_strain = V(0), by_strain2 = V(0);  // e dY/de, e^2 d2Y/de2
  V by_rate = V(0), by_both = V(0);       // dY/d ln rate, e d2Y/de d ln rate
};

// `shear_modulus` is the one at rest; shear(conditions), an optional member, the one elsewhere.
template <class L, class V>
concept StrengthLaw = requires(const L law) {
  { L::declaration } -> std::convertible_to<Declaration>;
  { L::per_initial_volume } -> std::convertible_to<bool>;
  { law.shear_modulus } -> std::convertible_to<number_t<V>>;
};

// least(conditions): the least flow stress, whatever the strain and its rate; below it nothing yields.
// yield_surface(conditions): the yield surface there. Its at(strain, log_rate) gives a Flow whose stress
// times -1 is concave in the logarithm of the strain's increment; ceiling(), an optional member, bounds that
// stress from above.
template <class L, class V>
concept YieldingLaw = StrengthLaw<L, V> && requires(const L law, const Conditions<V> conditions, V strain) {
  { law.least(conditions) } -> std::same_as<V>;
  { law.yield_surface(conditions).at(strain, strain) } -> std::same_as<Flow<V>>;
};

// A law that depends on the rate says from which on: log_kink, its logarithm.
template <class L>
concept RateLaw = requires(const L law) { law.log_kink; };

// Returns the shear modulus of a law, Pa: a number where it is a constant.
template <class L, class V>
PM_HD auto shear_modulus_of(const L& law, const Conditions<V>& conditions) {
  if constexpr (requires { law.shear(conditions); })
    return law.shear(conditions);
  else
    return number_t<V>(law.shear_modulus);
}

}  // namespace pockmark
