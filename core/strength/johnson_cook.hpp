// Johnson-Cook strength: Liu et al. 2015, Eq. 16; Johnson and Cook 1983.
//   sigma_y = (A + B eps^n)(1 + C ln max(rate/rate0, 1))(1 - T*^m),  T* = (T - T_room)/(T_melt - T_room)
// The rate is the plastic strain rate of the step. Below rate0 the factor is one: the law was fitted above
// it.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../elementary.hpp"

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
      : shear_modulus(shear_modulus_),
        A(A_),
        B(B_),
        n(n_),
        C(C_),
        m(m_),
        reference_rate(reference_rate_),
        t_room(t_room_),
        t_melt(t_melt_) {}
  template <class U>
  explicit JohnsonCook(const JohnsonCook<U>& o)
      : JohnsonCook(T(o.shear_modulus), T(o.A), T(o.B), T(o.n), T(o.C), T(o.m), T(o.reference_rate),
                    T(o.t_room), T(o.t_melt)) {}

  std::string check() const {
    if (!(shear_modulus > 0 && A > 0 && B >= 0 && n > 0 && C >= 0 && m > 0))
      return "shear_modulus, A, n, m must be > 0; B, C >= 0";
    return t_melt > t_room && reference_rate > 0 ? ""
                                                 : "t_melt must exceed t_room; reference_rate must be > 0";
  }

  PM_HD T softening(T temperature) const {
    if (temperature <= t_room) return T(1);
    if (temperature >= t_melt) return T(0);
    const T star = (temperature - t_room) / (t_melt - t_room);
    return T(1) - (m == T(1) ? star : fast_pow(star, m));
  }
  PM_HD T rate_factor(T rate) const {
    const T star = rate / reference_rate;
    return star > T(1) ? T(1) + C * fast_log(star) : T(1);
  }
  PM_HD T hardening(T strain) const { return A + B * fast_pow(strain, n); }
  PM_HD T flow_stress(T strain, T rate, T temperature) const {
    return hardening(strain) * rate_factor(rate) * softening(temperature);
  }

  // Radial return: find d with trial - 3 G d = sigma_y(strain + d, d/dt, T), by Newton inside a bracket (the
  // residual falls monotonically in d). The temperature is the one at the start of the step.
  PM_HD PlasticReturn<T> return_map(T trial, T strain, T temperature, T dt) const {
    const T soft = softening(temperature);
    if (trial <= A * soft) return {};
    const T three_g = T(3) * shear_modulus;
    const T power = B * fast_pow(strain, n);
    const T still = (A + power) * soft;
    if (trial <= still) return {};
    const T rounding = T(8) * std::numeric_limits<T>::epsilon() * trial / three_g;
    const T slowest = dt * reference_rate;  // increment of the reference rate

    // Start: hardening frozen at its old tangent, two rounds for the rate.
    T low = 0, high = (trial - still) / three_g;
    const T tangent = three_g + (strain > high ? soft * n * power / strain : T(0));
    T d = high;
    for (int round = 0; round < 2; ++round) {
      const T next = (trial - still * rate_factor(d / dt)) / tangent;
      d = next > T(0) ? next : d / T(4);
    }
    for (int iteration = 0; iteration < 60; ++iteration) {
      const T total = strain + d;
      const T hardened = B * fast_pow(total, n);
      const T hard = A + hardened;
      const T factor = rate_factor(d / dt);
      const T residual = trial - three_g * d - hard * factor * soft;
      (residual > T(0) ? low : high) = d;
      const T slope = three_g + soft * (n * hardened / total * factor + (d > slowest ? hard * C / d : T(0)));
      const T next = d + residual / slope;
      // Newton squares the relative error: after a change of 1e-6 the next one is below 1e-12. A tiny d
      // cannot be known better than the rounding of the stress allows.
      if (std::abs(next - d) <= T(1e-6) * d + rounding ||
          high - low <= std::numeric_limits<T>::epsilon() * high)
        return {next, true};
      d = next > low && next < high ? next : (low + high) / T(2);
    }
    return {d, false};
  }
};

}  // namespace pockmark
