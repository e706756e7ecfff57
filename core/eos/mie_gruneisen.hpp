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
  MieGruneisen(T density_, T c0_, T s_, T gamma0_) : density(density_), c0(c0_), s(s_), gamma0(gamma0_) {
    // mu at 0.95 of the pole: p_H is 5000 times the bulk modulus there.
    const T most = s > T(1) ? T(0.95) / (s - T(1)) : T(20);
    eta_cap_ = most / (T(1) + most);
  }
  template <class U>
  explicit MieGruneisen(const MieGruneisen<U>& o)
      : MieGruneisen(T(o.density), T(o.c0), T(o.s), T(o.gamma0)) {}

  std::string check() const {
    if (!(density > 0 && c0 > 0 && gamma0 >= 0 && s >= 0)) return "density, c0 must be > 0; s, gamma0 >= 0";
    return "";
  }
  PM_HD T bulk_modulus() const { return density * c0 * c0; }

  template <class V>
  PM_HD Isochore<V> at(const Compression<V>& c) const {
    const auto compressed = V(0) <= c.eta;
    if (!any(compressed)) return expanded(c.mu);
    const auto out = shocked(c.eta, c.ratio);
    return any(!compressed) ? select(compressed, out, expanded(c.mu)) : out;
  }

 private:
  // With eta = mu/(1 + mu) the Hugoniot is p_H = rho0 c0^2 eta/(1 - s eta)^2, and gamma = gamma0/(1 + mu),
  // Eq. 19, makes gamma mu = gamma0 eta.
  template <class V>
  PM_HD Isochore<V> shocked(V eta, V ratio) const {
    const auto capped = V(eta_cap_) < eta;
    eta = select(capped, V(eta_cap_), eta);
    ratio = select(capped, V(T(1) - eta_cap_), ratio);
    const V d = V(1) / (V(1) - s * eta), kd2 = bulk_modulus() * d * d;
    const V hugoniot = kd2 * eta, hugoniot_slope = kd2 * d * (V(1) + s * eta);  // this one by eta
    const T half_gamma = T(0.5) * gamma0;
    const V g = V(1) - half_gamma * eta;
    return {hugoniot * g, V(gamma0), ratio * ratio * (hugoniot_slope * g - half_gamma * hugoniot), V(0),
            capped};
  }
  // gamma stays gamma0. The paper's gamma rho = gamma0 rho0 would make gamma, and the heat of recompression
  // (E ~ exp(gamma0 rho0/rho)), grow without bound as a fragment expands.
  template <class V>
  PM_HD Isochore<V> expanded(V mu) const {
    const T k = bulk_modulus();
    return {k * mu * (V(1) - T(0.5) * gamma0 * mu), gamma0 * (V(1) + mu), k * (V(1) - gamma0 * mu),
            V(gamma0)};
  }

  T eta_cap_;  // kept: its divisions would be done for every pack
};

}  // namespace pockmark
