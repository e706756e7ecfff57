// Mie-Grueneisen on the Hugoniot Us = c0 + s up. Liu et al. 2015, Eqs. 19-20, corrected: both branches carry
// c0^2; E is the current internal energy. Valid to mu = 1/(s-1), the strong-shock limit.
#pragma once
#include <array>

#include "eos.hpp"

namespace pockmark {

inline constexpr std::array mie_gruneisen_constants{
    Constant{"c0", "m/s", 50, 1e5, "speed of sound at rest"},
    Constant{"s", "", 0, 20, "slope of the shock's speed over that of the material behind it"},
    Constant{"gamma0", "", 0, 20, "Grueneisen's gamma at rest"},
};

template <class T>
struct MieGruneisen {
  static constexpr Declaration declaration{"mie-gruneisen",
                                           "the Hugoniot Us = c0 + s up, and a Grueneisen gamma off it",
                                           "p = p_H (1 - gamma mu/2) + gamma (1 + mu) E",
                                           "Liu et al. 2015, Eqs. 19-20, corrected", mie_gruneisen_constants};
  static constexpr bool linear_in_energy = true;
  T bulk_modulus, s, gamma0;

  MieGruneisen() = default;
  explicit MieGruneisen(const Constants& given)
      : bulk_modulus(T(given["density"]) * T(given["c0"]) * T(given["c0"])),
        s(T(given["s"])),
        gamma0(T(given["gamma0"])) {
    // mu at 0.95 of the pole: p_H is 5000 times the bulk modulus there.
    const T most = s > T(1) ? T(0.95) / (s - T(1)) : T(20);
    eta_cap_ = most / (T(1) + most);
  }

  template <class V>
  PM_HD EosPoint<V> at(const Compression<V>& c, V energy) const {
    const auto compressed = V(0) <= c.eta;
    if (!any(compressed)) return expanded(c.mu, energy);
    auto out = shocked(c.eta, c.ratio, energy);  // not chosen by ?:, which copies all of it through memory
    if (any(!compressed)) out = select(compressed, out, expanded(c.mu, energy));
    return out;
  }

 private:
  // With eta = mu/(1 + mu) the Hugoniot is p_H = rho0 c0^2 eta/(1 - s eta)^2, and gamma = gamma0/(1 + mu),
  // Eq. 19, makes gamma mu = gamma0 eta.
  template <class V>
  PM_HD EosPoint<V> shocked(V eta, V ratio, V energy) const {
    const auto capped = V(eta_cap_) < eta;
    eta = select(capped, V(eta_cap_), eta);
    ratio = select(capped, V(T(1) - eta_cap_), ratio);
    const V d = V(1) / (V(1) - s * eta), kd2 = bulk_modulus * d * d;
    const V hugoniot = kd2 * eta, hugoniot_slope = kd2 * d * (V(1) + s * eta);  // this one by eta
    const T half_gamma = T(0.5) * gamma0;
    const V g = V(1) - half_gamma * eta;
    return {hugoniot * g + gamma0 * energy, ratio * ratio * (hugoniot_slope * g - half_gamma * hugoniot),
            V(gamma0), capped};
  }
  // gamma stays gamma0. The paper's gamma rho = gamma0 rho0 would make gamma, and the heat of recompression
  // (E ~ exp(gamma0 rho0/rho)), grow without bound as a fragment expands.
  template <class V>
  PM_HD EosPoint<V> expanded(V mu, V energy) const {
    const T k = bulk_modulus;
    const V thermal = gamma0 * (V(1) + mu);
    return {k * mu * (V(1) - T(0.5) * gamma0 * mu) + thermal * energy,
            k * (V(1) - gamma0 * mu) + gamma0 * energy, thermal};
  }

  T eta_cap_;  // kept: its divisions would be done for every pack
};

}  // namespace pockmark
