// Johnson-Cook strength: Liu et al. 2015, Eq. 16; Johnson and Cook 1983.
//   sigma_y = (A + B eps^n)(1 + C ln max(rate/rate0, 1))(1 - T*^m),  T* = (T - T_room)/(T_melt - T_room)
// The rate is the plastic strain rate of the step. Below rate0 the factor is one: the law was fitted above it.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../portable.hpp"

namespace pockmark {

template <class T>
struct PlasticReturn {
  T strain_increment = 0;
  bool converged = true;
};

template <class T>
struct JohnsonCook {
  T shear_modulus, A, B, n, C, m, reference_rate, t_room, t_melt;

  JohnsonCook() = default;
  JohnsonCook(T shear_modulus_, T A_, T B_, T n_, T C_, T m_, T reference_rate_, T t_room_, T t_melt_)
      : shear_modulus(shear_modulus_), A(A_), B(B_), n(n_), C(C_), m(m_), reference_rate(reference_rate_),
        t_room(t_room_), t_melt(t_melt_) {}
  template <class U>
  explicit JohnsonCook(const JohnsonCook<U>& o)
      : JohnsonCook(T(o.shear_modulus), T(o.A), T(o.B), T(o.n), T(o.C), T(o.m), T(o.reference_rate),
                    T(o.t_room), T(o.t_melt)) {}

  std::string check() const {
    if (!(shear_modulus > 0 && A > 0 && B >= 0 && n > 0 && C >= 0 && m > 0))
      return "shear_modulus, A, n, m must be > 0; B, C >= 0";
    return t_melt > t_room && reference_rate > 0 ? "" : "t_melt must exceed t_room; reference_rate must be > 0";
  }

  PM_HD T softening(T temperature) const {
    if (temperature <= t_room) return T(1);
    if (temperature >= t_melt) return T(0);
    return T(1) - std::pow((temperature - t_room) / (t_melt - t_room), m);
  }
  PM_HD T hardening(T strain) const { return A + B * std::pow(strain, n); }
  PM_HD T flow_stress(T strain, T rate, T temperature) const {
    const T star = std::max(rate / reference_rate, T(1));
    return hardening(strain) * (T(1) + C * std::log(star)) * softening(temperature);
  }

  // Radial return: find d with trial - 3 G d = sigma_y(strain + d, d/dt, T). Newton inside a bracket; the
  // residual falls monotonically in d. The temperature is the one at the start of the step.
  PM_HD PlasticReturn<T> return_map(T trial, T strain, T temperature, T dt) const {
    if (trial <= T(0)) return {};
    const T soft = softening(temperature);
    const T three_g = T(3) * shear_modulus;
    const T still = hardening(strain) * soft;
    if (trial <= still) return {};
    T low = 0, high = (trial - still) / three_g, d = high;
    const T tolerance = T(64) * std::numeric_limits<T>::epsilon() * trial;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const T total = strain + d;
      const T power = std::pow(total, n);
      const T star = d / (dt * reference_rate);
      const bool fast = star > T(1);
      const T rate_factor = fast ? T(1) + C * std::log(star) : T(1);
      const T hard = A + B * power;
      const T residual = trial - three_g * d - hard * rate_factor * soft;
      if (std::abs(residual) <= tolerance) return {d, true};
      (residual > T(0) ? low : high) = d;
      const T slope =
          -three_g - soft * (n * B * power / total * rate_factor + (fast ? hard * C / d : T(0)));
      const T next = d - residual / slope;
      const bool inside = next > low && next < high;
      if (!inside && high - low <= std::numeric_limits<T>::epsilon() * high) return {d, true};
      d = inside ? next : (low + high) / T(2);
    }
    return {d, false};
  }
};

}  // namespace pockmark
