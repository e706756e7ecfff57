// Steinberg-Guinan: a shear modulus and a yield strength that rise with pressure and fall with heat, for
// strain rates beyond about 1e5 1/s, where the rate no longer counts. Steinberg, Cochran, Guinan, J. Appl.
// Phys. 51 (1980) 1498; Steinberg, UCRL-MA-106439. With h = rho/rho0:
//   G = G0 g, g = 1 + A p h^(-1/3) - B (T - 300 K),   Y = min(Y0 (1 + beta (e + e_i))^n, Y_max) g
// and no strength above T_m = T_m0 exp(2 a (1 - 1/h)) h^(2 (gamma0 - a - 1/3)). g is at least a hundredth.
#pragma once
#include <algorithm>
#include <array>

#include "../elementary.hpp"
#include "strength.hpp"

namespace pockmark {

inline constexpr std::array steinberg_guinan_constants{
    Constant{"shear_modulus", "Pa", 1, 1e13, "shear modulus G0 at rest"},
    Constant{"Y0", "Pa", 1, 1e12, "yield strength at rest"},
    Constant{"Y_max", "Pa", 1, 1e12, "the most that hardening makes of it"},
    Constant{"beta", "", 0, 1e5, "hardening"},
    Constant{"n", "", 0, 20, "exponent of the hardening"},
    Constant{"e_i", "", 0, 10, "plastic strain from before", 0},
    Constant{"A", "1/Pa", 0, 1e-8, "growth of both with pressure"},
    Constant{"B", "1/K", 0, 0.1, "fall of both with temperature"},
    Constant{"T_m0", "K", 1, 1e5, "melting temperature at the density of rest"},
    Constant{"a", "", 0, 10, "volume correction of Grueneisen's gamma in it"},
    Constant{"gamma0", "", 0, 20, "Grueneisen's gamma in it"},
};

template <class T>
struct SteinbergGuinan {
  static constexpr Declaration declaration{
      "steinberg-guinan", "strength by pressure and temperature, whatever the rate",
      "G = G0 g, Y = min(Y0 (1 + beta (e + e_i))^n, Y_max) g, g = 1 + A p h^(-1/3) - B (T - 300 K)",
      "Steinberg, Cochran, Guinan 1980; Steinberg 1996, UCRL-MA-106439", steinberg_guinan_constants};
  static constexpr bool per_initial_volume = false;
  T shear_modulus, Y0, Y_max, beta, n, e_i, A, B, T_m0, a, gamma0;

  SteinbergGuinan() = default;
  explicit SteinbergGuinan(const Constants& given)
      : shear_modulus(T(given["shear_modulus"])),
        Y0(T(given["Y0"])),
        Y_max(T(given["Y_max"])),
        beta(T(given["beta"])),
        n(T(given["n"])),
        e_i(T(given["e_i"])),
        A(T(given["A"])),
        B(T(given["B"])),
        T_m0(T(given["T_m0"])),
        a(T(given["a"])),
        gamma0(T(given["gamma0"])),
        least_(std::min(T(given["Y0"] * std::pow(1 + given["beta"] * given["e_i"], given["n"])), Y_max)) {}

  template <class V>
  struct YieldSurface {
    const SteinbergGuinan& law;
    V factor;  // g, and nothing where the material is molten

    PM_HD Flow<V> at(V strain, V) const {
      const V hard = law.beta * strain, base = V(T(1) + law.beta * law.e_i) + hard;
      const V stress = law.Y0 * factor * fast_pow(base, law.n), share = hard / base;
      const V slope = law.n * stress * share;
      return {stress, slope, (law.n - T(1)) * slope * share};
    }
    PM_HD V ceiling() const { return law.Y_max * factor; }
  };

  template <class V>
  PM_HD V shear(const Conditions<V>& at) const {
    return shear_modulus * factor(at);
  }
  template <class V>
  PM_HD V least(const Conditions<V>& at) const {
    return least_ * solid_factor(at);
  }
  template <class V>
  PM_HD YieldSurface<V> yield_surface(const Conditions<V>& at) const {
    return {*this, solid_factor(at)};
  }

 private:
  template <class V>
  PM_HD V factor(const Conditions<V>& at) const {
    const V stiffer = A * at.pressure * fast_pow(at.ratio, T(1.0 / 3));
    return max(V(1) + stiffer - B * (at.temperature - T(300)), V(0.01));
  }
  template <class V>
  PM_HD V solid_factor(const Conditions<V>& at) const {
    const V ratio = max(at.ratio, V(T(1e-3)));
    const V melt =
        T_m0 * fast_exp(T(2) * a * (V(1) - ratio) - T(2) * (gamma0 - a - T(1.0 / 3)) * fast_log(ratio));
    return select(at.temperature < melt, factor(at), V(0));
  }

  T least_;
};

}  // namespace pockmark
