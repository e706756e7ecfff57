// Johnson-Cook strength: Liu et al. 2015, Eq. 16; Johnson and Cook 1983.
//   sigma_y = (A + B eps^n)(1 + C ln max(rate/rate0, 1))(1 - T*^m),  T* = (T - T_room)/(T_melt - T_room)
// The rate is the plastic strain rate of the step. Below rate0 the factor is one: the law was fitted above
// it.
#pragma once
#include <limits>
#include <string>

#include "../elementary.hpp"
#include "../homologous.hpp"

namespace pockmark {

template <class V>
struct PlasticReturn {
  V strain_increment = V(0);
  mask_t<V> converged = Pack<V>::mask(true);
};

template <class T>
struct JohnsonCook {
  static constexpr bool per_initial_volume = false;  // yield bounds the deviator (simple.hpp)
  T shear_modulus, A, B, n, C, m, reference_rate;
  HomologousTemperature<T> homologous;

  JohnsonCook() = default;
  JohnsonCook(T shear_modulus_, T A_, T B_, T n_, T C_, T m_, T reference_rate_, T t_room_, T t_melt_)
      : shear_modulus(shear_modulus_),
        A(A_),
        B(B_),
        n(n_),
        C(C_),
        m(m_),
        reference_rate(reference_rate_),
        homologous(t_room_, t_melt_) {}
  template <class U>
  explicit JohnsonCook(const JohnsonCook<U>& o)
      : JohnsonCook(T(o.shear_modulus), T(o.A), T(o.B), T(o.n), T(o.C), T(o.m), T(o.reference_rate),
                    T(o.homologous.t_room), T(o.homologous.t_melt)) {}

  std::string check() const {
    if (!(shear_modulus > 0 && A > 0 && B >= 0 && n > 0 && C >= 0 && m > 0))
      return "shear_modulus, A, n, m must be > 0; B, C >= 0";
    return homologous.t_melt > homologous.t_room && reference_rate > 0
               ? ""
               : "t_melt must exceed t_room; reference_rate must be > 0";
  }

  template <class V>
  PM_HD V softening(V temperature) const {
    const V star = homologous(temperature);
    return V(1) - (m == T(1) ? star : fast_pow(star, m));
  }
  PM_HD T flow_stress(T strain, T rate, T temperature) const {
    const T star = rate / reference_rate;
    return (A + B * fast_pow(strain, n)) * (T(1) + C * fast_log(max(star, T(1)))) * softening(temperature);
  }

  // Whether a trial stress, of which the square is given, is above the least flow stress at that temperature:
  // without it nothing yields.
  template <class V>
  PM_HD mask_t<V> may_yield(V trial_squared, V temperature) const {
    const V least = A * softening(temperature);
    return least * least < trial_squared;
  }
  // Radial return: find d with r(d) = trial - 3 G d - sigma_y(strain + d, d/dt, T) = 0, by Newton's method in
  // x = ln d. There r is concave and falls, the kink at the reference rate included, so the iteration comes
  // down on the root from above and needs no bracket. The temperature is the one at the start of the step.
  template <class V>
  PM_HD PlasticReturn<V> return_map(V trial, V strain, V temperature, T dt) const {
    const V soft = softening(temperature);
    const V power = B * fast_pow(strain, n), still = (A + power) * soft;
    const auto yields = still < trial;
    if (!any(yields)) return {};
    const T three_g = T(3) * shear_modulus;
    const T x_slow = fast_log(dt * reference_rate);  // increment of the reference rate

    const V excess = select(yields, trial - still, T(1e-6) * trial);
    const V most = excess * (T(1) / three_g),
            x_most = rough_log(most);  // the root with neither rate nor hardening
    const V rated = soft * (V(1) + C * max(x_most - T(1) - x_slow, V(0)));
    const V tangent = three_g + select(most < strain, rated * n * power / max(strain, most), V(0));
    V d = min(start(excess, tangent, C * still, x_slow), most), x = fast_log(d);
    const V rounding = T(8) * std::numeric_limits<T>::epsilon() * trial;
    V found = V(0);
    auto open = yields;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const V total = strain + d, share = d / total;
      const V hardened = B * fast_pow(total, n), hard = A + hardened;
      const V factor = V(1) + C * max(x - x_slow, V(0)), factor1 = select(V(x_slow) < x, V(C), V(0));
      const V residual = trial - three_g * d - soft * hard * factor;
      // Derivatives by x.
      const V hard1 = n * hardened * share, hard2 = hard1 * (V(1) - (T(1) - n) * share);
      const V slope = three_g * d + soft * (hard1 * factor + hard * factor1);
      const V newton = residual / slope;
      // One of Halley's steps leaves less than slope newton^3: of the stress, below 1e-12; unless it crosses
      // the kink. A tiny d cannot be known better than the rounding of the stress allows.
      const auto exact = absolute(residual) <= rounding;
      const auto fast = V(x_slow) < x, falls = fast && x + newton <= V(x_slow);
      const auto crosses = falls || (!fast && V(x_slow) < x + newton);
      const auto near = slope * absolute(newton * newton * newton) <= T(1e-12) * trial &&
                        absolute(newton) <= V(1e-3) && !crosses;
      const V curve = three_g * d + soft * (hard2 * factor + T(2) * hard1 * factor1);
      const V step = newton / (V(1) + T(0.5) * newton * curve / slope);
      const V refined = select(exact, d, d * (V(1) + step + T(0.5) * step * step));
      found = select(open, refined, found);
      open = open && !(exact || near);
      if (!any(open)) break;
      x = select(falls, V(x_slow), min(x + newton, x_most + T(1e-5)));
      d = fast_exp(x);
    }
    return {found, !open};
  }

 private:
  // The root of excess - tangent d - rate (ln d - x_slow), for hardening at its old tangent: w + ln w = L,
  // Lambert's W, by one step of Fritsch, Shafer and Crowley (1973) from W's asymptotes. Right to 1e-4 or so.
  template <class V>
  PM_HD V start(V excess, V tangent, V rate, T x_slow) const {
    rate = max(rate, T(1e-6) * excess);  // C, or the strength of a melt, may be zero
    const V scale = rate / tangent;
    const V L = excess / rate + V(x_slow) - rough_log(scale);
    const V above = max(L, V(1)), l = rough_log(above), below = min(L, V(1)) - T(1);
    V w = select(V(1) < L, above - l + l / above, V(1) + below * (T(0.5) + T(0.0625) * below));
    const auto small = L < V(-1);
    if (any(small)) w = select(small, fast_exp(L), w);
    const V z = L - w - rough_log(w), w1 = V(1) + w;
    const V q = T(2) * w1 * (w1 + T(2.0 / 3.0) * z);
    return scale * w * (V(1) + z / w1 * (q - z) / (q - T(2) * z));
  }
};

}  // namespace pockmark
