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

  PM_HD Isochore<T> at(T mu) const {
    Isochore<T> out{};
    // 0.95 of the pole: p_H is 5000 times the bulk modulus there.
    const T cap = s > T(1) ? T(0.95) / (s - T(1)) : T(20);
    if (mu > cap) mu = cap, out.capped = true;
    const T k = bulk_modulus();
    if (mu >= T(0)) {
      // gamma = gamma0 / (1 + mu), Eq. 19.
      const T ratio = T(1) / (T(1) + mu), half_gamma = T(0.5) * gamma0 * ratio;
      const T g = T(1) - half_gamma * mu;
      const T g_slope = -half_gamma * ratio;
      const T d = T(1) / (T(1) - (s - T(1)) * mu), kd2 = k * d * d;
      const T hugoniot = kd2 * mu * (T(1) + mu);
      const T hugoniot_slope = kd2 * d * (T(1) + (s + T(1)) * mu);
      out.cold = hugoniot * g;
      out.cold_slope = hugoniot_slope * g + hugoniot * g_slope;
      out.thermal = gamma0;
      out.thermal_slope = T(0);
    } else {
      // Expanded: gamma stays gamma0. The paper's gamma rho = gamma0 rho0 would make gamma, and the heat of
      // recompression (E ~ exp(gamma0 rho0/rho)), grow without bound as a fragment expands.
      const T g = T(1) - T(0.5) * gamma0 * mu;
      out.cold = k * mu * g;
      out.cold_slope = k * (T(1) - gamma0 * mu);
      out.thermal = gamma0 * (T(1) + mu);
      out.thermal_slope = gamma0;
    }
    return out;
  }
};

}  // namespace pockmark
