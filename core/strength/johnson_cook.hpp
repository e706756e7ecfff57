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
    return rate > reference_rate ? T(1) + C * fast_log(rate / reference_rate) : T(1);
  }
  PM_HD T hardening(T strain) const { return A + B * fast_pow(strain, n); }
  PM_HD T flow_stress(T strain, T rate, T temperature) const {
    return hardening(strain) * rate_factor(rate) * softening(temperature);
  }

  // Radial return: find d with r(d) = trial - 3 G d - sigma_y(strain + d, d/dt, T) = 0, by Newton's method in
  // x = ln d. There r is concave and falls, the kink at the reference rate included, so the iteration comes
  // down on the root from above and needs no bracket. The temperature is the one at the start of the step.
  PM_HD PlasticReturn<T> return_map(T trial, T strain, T temperature, T dt) const {
    const T soft = softening(temperature);
    if (trial <= A * soft) return {};
    const T power = B * fast_pow(strain, n);
    const T still = (A + power) * soft;
    if (trial <= still) return {};
    const T three_g = T(3) * shear_modulus;
    const T x_slow = fast_log(dt * reference_rate);  // increment of the reference rate

    // Start: hardening at its old tangent, the rate at that of no hardening; at most the root without either.
    const T most = (trial - still) / three_g, x_most = fast_log(most);
    const T tangent = three_g + (strain > most ? soft * n * power / strain : T(0));
    const T guess = (trial - still * (T(1) + C * std::max(x_most - x_slow, T(0)))) / tangent;
    T d = guess > T(0.01) * most ? guess : T(0.01) * most;
    T x = fast_log(d);
    const T rounding = T(8) * std::numeric_limits<T>::epsilon() * trial;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const T total = strain + d, share = d / total;
      const T hardened = B * fast_pow(total, n), hard = A + hardened;
      const T factor = T(1) + C * std::max(x - x_slow, T(0)), factor1 = x > x_slow ? C : T(0);
      const T residual = trial - three_g * d - soft * hard * factor;
      if (std::abs(residual) <= rounding) return {d, true};
      // Derivatives by x.
      const T hard1 = n * hardened * share, hard2 = hard1 * (T(1) - (T(1) - n) * share);
      const T slope = three_g * d + soft * (hard1 * factor + hard * factor1);
      const T newton = residual / slope;
      if (std::abs(newton) <= T(1e-4)) {
        // One of Halley's steps leaves an error below 1e-12.
        const T curve = three_g * d + soft * (hard2 * factor + T(2) * hard1 * factor1);
        const T step = newton / (T(1) + T(0.5) * newton * curve / slope);
        return {d * (T(1) + step + T(0.5) * step * step), true};
      }
      x = std::min(x + newton, x_most);
      d = fast_exp(x);
    }
    return {d, false};
  }
};

}  // namespace pockmark
