// Strength models without a yield surface: a linear elastic solid and a fluid.
//
// Nothing bounds the deviator s of an elastic solid, and one per current volume, ds = 2 G dev D, pays work
// that depends on the path: shear, compress, shear back, expand, and energy is won. Per initial volume, tau =
// s V/V0, dtau = 2 G dev D, the work tau : D dt is the change of tau : tau / 4G, whatever the path.
#pragma once
#include <string>

#include "johnson_cook.hpp"

namespace pockmark {

template <class T>
struct Elastic {
  static constexpr bool per_initial_volume = true;
  T shear_modulus;

  Elastic() = default;
  explicit Elastic(T g) : shear_modulus(g) {}
  template <class U>
  explicit Elastic(const Elastic<U>& o) : shear_modulus(T(o.shear_modulus)) {}
  std::string check() const { return shear_modulus >= 0 ? "" : "shear_modulus must be >= 0"; }
  template <class V>
  PM_HD mask_t<V> may_yield(V, V) const {
    return Pack<V>::mask(false);
  }
  template <class V>
  PM_HD PlasticReturn<V> return_map(V, V, V, T) const {
    return {};
  }
};

template <class T>
struct Fluid {
  static constexpr bool per_initial_volume = false;
  static constexpr T shear_modulus = T(0);

  Fluid() = default;
  template <class U>
  explicit Fluid(const Fluid<U>&) {}
  std::string check() const { return ""; }
  template <class V>
  PM_HD mask_t<V> may_yield(V, V) const {
    return Pack<V>::mask(false);
  }
  template <class V>
  PM_HD PlasticReturn<V> return_map(V, V, V, T) const {
    return {};
  }
};

}  // namespace pockmark
