// p = K mu: no thermal part. For exact elastic solutions.
#pragma once
#include <string>

#include "eos.hpp"

namespace pockmark {

template <class T>
struct LinearEos {
  T density, bulk_modulus_;

  LinearEos() = default;
  LinearEos(T density_, T bulk_modulus) : density(density_), bulk_modulus_(bulk_modulus) {}
  template <class U>
  explicit LinearEos(const LinearEos<U>& o) : density(T(o.density)), bulk_modulus_(T(o.bulk_modulus_)) {}

  std::string check() const {
    return density > 0 && bulk_modulus_ > 0 ? "" : "density and bulk_modulus must be > 0";
  }
  PM_HD T bulk_modulus() const { return bulk_modulus_; }
  template <class V>
  PM_HD Isochore<V> at(const Compression<V>& c) const {
    return {bulk_modulus_ * c.mu, V(0), V(bulk_modulus_), V(0)};
  }
};

}  // namespace pockmark
