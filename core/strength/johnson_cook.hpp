// Johnson-Cook strength: Liu et al. 2015, Eq. 16; Johnson and Cook 1983.
//   sigma_y = (A + B eps^n)(1 + C ln max(rate/rate0, 1))(1 - T*^m),  T* = (T - T_room)/(T_melt - T_room)
// The rate is the plastic strain rate of the step. Below rate0 the factor is one: the law was fitted above
// it.
#pragma once
#include <array>

#include "../elementary.hpp"
#include "../homologous.hpp"
#include "strength.hpp"

namespace pockmark {

inline constexpr std::array johnson_cook_constants{
    Constant{"shear_modulus", "Pa", 1, 1e13, "shear modulus G"},
    Constant{"A", "Pa", 1, 1e12, "flow stress without plastic strain"},
    Constant{"B", "Pa", 0, 1e12, "hardening"},
    Constant{"n", "", 1e-3, 20, "exponent of the hardening"},
    Constant{"C", "", 0, 10, "share of the flow stress that a rate e times as high adds"},
    Constant{"m", "", 1e-3, 20, "exponent of the softening with temperature"},
    Constant{"reference_rate", "1/s", 1e-8, 1e8, "rate at and below which the rate does not count", 1},
};

template <class T>
struct JohnsonCook {
  static constexpr Declaration declaration{"johnson-cook", "hardening, rate and temperature as factors",
                                           "Y = (A + B e^n)(1 + C ln max(rate/rate0, 1))(1 - T*^m)",
                                           "Johnson and Cook 1983; Liu et al. 2015, Eq. 16",
                                           johnson_cook_constants};
  static constexpr bool per_initial_volume = false;  // yield bounds the deviator (simple.hpp)
  T shear_modulus, A, B, n, C, m, log_kink;
  HomologousTemperature<T> homologous;

  JohnsonCook() = default;
  explicit JohnsonCook(const Constants& given)
      : shear_modulus(T(given["shear_modulus"])),
        A(T(given["A"])),
        B(T(given["B"])),
        n(T(given["n"])),
        C(T(given["C"])),
        m(T(given["m"])),
        log_kink(T(std::log(given["reference_rate"]))),
        homologous(T(given["room_temperature"]), T(given["melt_temperature"])) {}

  template <class V>
  struct YieldSurface {
    const JohnsonCook& law;
    V soft;  // 1 - T*^m

    PM_HD Flow<V> at(V strain, V log_rate) const {
      const V hardened = law.B * fast_pow(strain, law.n), hard = law.A + hardened;
      const V over = log_rate - law.log_kink, factor1 = select(V(0) < over, V(law.C), V(0));
      const V rated = soft * (V(1) + law.C * max(over, V(0)));
      const V slope = law.n * hardened, by_strain = rated * slope;
      return {rated * hard, by_strain, (law.n - T(1)) * by_strain, soft * (hard * factor1),
              soft * (slope * factor1)};
    }
  };

  template <class V>
  PM_HD V softening(V temperature) const {
    const V star = homologous(temperature);
    return V(1) - (m == T(1) ? star : fast_pow(star, m));
  }
  template <class V>
  PM_HD V least(const Conditions<V>& conditions) const {
    return A * softening(conditions.temperature);
  }
  template <class V>
  PM_HD YieldSurface<V> yield_surface(const Conditions<V>& conditions) const {
    return {*this, softening(conditions.temperature)};
  }
};

}  // namespace pockmark
