// p = K mu: no thermal part. For exact elastic solutions.
#pragma once
#include <array>

#include "eos.hpp"

namespace pockmark {

inline constexpr std::array linear_eos_constants{
    Constant{"bulk_modulus", "Pa", 1, 1e13, "bulk modulus K"},
};

template <class T>
struct LinearEos {
  static constexpr Declaration declaration{"linear", "a pressure without a thermal part", "p = K mu",
                                           "Hooke's law", linear_eos_constants};
  static constexpr bool linear_in_energy = true;
  T bulk_modulus;

  LinearEos() = default;
  explicit LinearEos(const Constants& given) : bulk_modulus(T(given["bulk_modulus"])) {}

  template <class V>
  PM_HD EosPoint<V> at(const Compression<V>& c, V) const {
    return {bulk_modulus * c.mu, V(bulk_modulus), V(0)};
  }
};

}  // namespace pockmark
