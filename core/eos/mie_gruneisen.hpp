// Mie-Grueneisen on the Hugoniot Us = c0 + s up. Liu et al. 2015, Eqs. 19-20, corrected: both branches carry
// c0^2; E is the current internal energy. Valid to mu = 1/(s-1), the strong-shock limit.
#pragma once
#include <string>

#include "eos.hpp"

namespace pockmark {

template <class T>
struct MieGruneisen {
  T density, c0, s, gamma0;

  MieGruneisen() = default;
  MieGruneisen(T density_, T c0_, T s_, T gamma0_) : density(density_), c0(c0_), s(s_), gamma0(gamma0_) {}
  template <class U>
  explicit MieGruneisen(const MieGruneisen<U>& o)
      : density(T(o.density)), c0(T(o.c0)), s(T(o.s)), gamma0(T(o.gamma0)) {}

  std::string check() const {
    if (!(density > 0 && c0 > 0 && gamma0 >= 0 && s >= 0)) return "density, c0 must be > 0; s, gamma0 >= 0";
    return "";
  }
  PM_HD T bulk_modulus() const { return density * c0 * c0; }

  template <class V>
  PM_HD Isochore<V> at(V mu, V ratio) const {
    const auto compressed = V(0) <= mu;
    if (!any(compressed)) return expanded(mu);
    const auto out = shocked(mu, ratio);
    return any(!compressed) ? select(compressed, out, expanded(mu)) : out;
  }

 private:
  template <class V>
  PM_HD Isochore<V> shocked(V mu, V ratio) const {
    // 0.95 of the pole: p_H is 5000 times the bulk modulus there.
    const T cap = s > T(1) ? T(0.95) / (s - T(1)) : T(20);
    const auto capped = V(cap) < mu;
    mu = select(capped, V(cap), mu);
    ratio = select(capped, V(T(1) / (T(1) + cap)), ratio);
    const V half_gamma = T(0.5) * gamma0 * ratio;  // gamma = gamma0 / (1 + mu), Eq. 19
    const V g = V(1) - half_gamma * mu, g_slope = -(half_gamma * ratio);
    const V d = V(1) / (V(1) - (s - T(1)) * mu), kd2 = bulk_modulus() * d * d;
    const V hugoniot = kd2 * mu * (V(1) + mu);
    const V hugoniot_slope = kd2 * d * (V(1) + (s + T(1)) * mu);
    return {hugoniot * g, V(gamma0), hugoniot_slope * g + hugoniot * g_slope, V(0), capped};
  }
  // gamma stays gamma0. The paper's gamma rho = gamma0 rho0 would make gamma, and the heat of recompression
  // (E ~ exp(gamma0 rho0/rho)), grow without bound as a fragment expands.
  template <class V>
  PM_HD Isochore<V> expanded(V mu) const {
    const T k = bulk_modulus();
    return {k * mu * (V(1) - T(0.5) * gamma0 * mu), gamma0 * (V(1) + mu), k * (V(1) - gamma0 * mu),
            V(gamma0)};
  }
};

}  // namespace pockmark
