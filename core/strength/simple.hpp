// Strength models without a yield surface: a linear elastic solid and a fluid.
//
// Nothing bounds the deviator s of an elastic solid, and one per current volume, ds = 2 G dev D, pays work
// that depends on the path: shear, compress, shear back, expand, and energy is won. Per initial volume, tau =
// s V/V0, dtau = 2 G dev D, the work tau : D dt is the change of tau : tau / 4G, whatever the path.
#pragma once
#include <array>

#include "strength.hpp"

namespace pockmark {

inline constexpr std::array elastic_constants{
    Constant{"shear_modulus", "Pa", 1, 1e13, "shear modulus G"},
};

template <class T>
struct Elastic {
  static constexpr Declaration declaration{"elastic", "a linear elastic solid", "ds = 2 G dev D",
                                           "Hooke's law, per initial volume", elastic_constants};
  static constexpr bool per_initial_volume = true;
  T shear_modulus;

  Elastic() = default;
  explicit Elastic(const Constants& given) : shear_modulus(T(given["shear_modulus"])) {}
};

template <class T>
struct Fluid {
  static constexpr Declaration declaration{"fluid", "no stress but pressure", "s = 0", "Pascal's law", {}};
  static constexpr bool per_initial_volume = false;
  static constexpr T shear_modulus = T(0);

  Fluid() = default;
  explicit Fluid(const Constants&) {}
};

}  // namespace pockmark
