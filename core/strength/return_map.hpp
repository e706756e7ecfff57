// The radial return, for every strength law: find the plastic strain d of a step that leaves the stress on
// the yield surface, r(d) = trial - 3 G d - Y(strain + d, d/dt) = 0.
#pragma once
#include <limits>

#include "../elementary.hpp"
#include "strength.hpp"

namespace pockmark {

template <class V>
struct PlasticReturn {
  V strain_increment = V(0);
  mask_t<V> converged = Pack<V>::mask(true);
};

// Newton's method in x = ln d. There r is concave and falls, a kink at a reference rate included, so the
// iteration comes down on the root from above and needs no bracket.
template <class V, class YieldSurface, class Modulus, bool has_rate>
struct ReturnMap {
  using T = number_t<V>;
  using Mask = mask_t<V>;
  const YieldSurface& yield_surface;
  Modulus three_g;  // a number where the modulus is a constant
  T log_dt;
  T x_kink;  // the logarithm of the increment below which the rate does not count

  PM_HD PlasticReturn<V> operator()(V trial, V strain) const {
    const V still = yield_surface.at(strain, V(x_kink - log_dt)).stress;
    const auto yields = still < trial;
    if (!any(yields)) return {};
    const V excess = select(yields, trial - still, T(1e-6) * trial);
    const V most = excess * (Modulus(1) / three_g),
            x_most = rough_log(most);  // the root with neither rate nor hardening
    V d = min(start(strain, excess, most, x_most), most), x = fast_log(d);
    const V rounding = T(8) * std::numeric_limits<T>::epsilon() * trial;
    V found = V(0);
    auto open = yields;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const V total = strain + d, share = d / total;
      const auto flow = yield_surface.at(total, x - log_dt);
      const V residual = trial - three_g * d - flow.stress;
      // Derivatives by x.
      const V hard1 = flow.by_strain * share, slope = three_g * d + hard1 + flow.by_rate;
      const V newton = residual / slope;
      // One of Halley's steps leaves less than slope newton^3: of the stress, below 1e-12; unless it crosses
      // the kink. A tiny d cannot be known better than the rounding of the stress allows.
      const auto exact = absolute(residual) <= rounding;
      auto near =
          slope * absolute(newton * newton * newton) <= T(1e-12) * trial && absolute(newton) <= V(1e-3);
      V next = min(x + newton, x_most + T(1e-5));
      if constexpr (has_rate) stop_at_kink(x, newton, near, next);
      const V curve = three_g * d + hard1 + share * (flow.by_strain2 * share + T(2) * flow.by_both);
      const V step = newton / (V(1) + T(0.5) * newton * curve / slope);
      const V refined = select(exact, d, d * (V(1) + step + T(0.5) * step * step));
      found = select(open, refined, found);
      open = open && !(exact || near);
      if (!any(open)) break;
      x = next;
      d = fast_exp(x);
    }
    return {found, !open};
  }

 private:
  // From above a kink the iteration goes to the kink first; no step across it is the last.
  PM_HD void stop_at_kink(V x, V newton, Mask& near, V& next) const {
    const V kink = V(x_kink);
    const auto fast = kink < x, falls = fast && x + newton <= kink;
    near = near && !(falls || (!fast && kink < x + newton));
    next = select(falls, kink, next);
  }
  // Returns the root for hardening at its old tangent.
  PM_HD V start(V strain, V excess, V most, V x_most) const {
    const auto flow = yield_surface.at(strain, max(x_most - T(1), V(x_kink + T(1e-3))) - log_dt);
    const V tangent = three_g + select(most < strain, flow.by_strain / max(strain, most), V(0));
    if constexpr (has_rate)
      return logarithmic_start(excess, tangent, flow.by_rate);
    else
      return excess / tangent;
  }
  // Returns the root of excess - tangent d - rate (ln d - x_kink): w + ln w = L, Lambert's W, by one step of
  // Fritsch, Shafer and Crowley (1973) from W's asymptotes. Right to 1e-4 or so.
  PM_HD V logarithmic_start(V excess, V tangent, V rate) const {
    rate = max(rate, T(1e-6) * excess);  // the rate, or the strength of a melt, may count for nothing
    const V scale = rate / tangent;
    const V L = excess / rate + V(x_kink) - rough_log(scale);
    const V above = max(L, V(1)), l = rough_log(above), below = min(L, V(1)) - T(1);
    V w = select(V(1) < L, above - l + l / above, V(1) + below * (T(0.5) + T(0.0625) * below));
    const auto small = L < V(-1);
    if (any(small)) w = select(small, fast_exp(L), w);
    const V z = L - w - rough_log(w), w1 = V(1) + w;
    const V q = T(2) * w1 * (w1 + T(2.0 / 3.0) * z);
    return scale * w * (V(1) + z / w1 * (q - z) / (q - T(2) * z));
  }
};

// Returns the plastic strain that takes a trial stress to the yield surface in dt. The conditions are those
// at the start of the step.
template <class Law, class V>
PM_HD PlasticReturn<V> return_to_yield_surface(const Law& law, V trial, V strain,
                                               const Conditions<V>& conditions, number_t<V> dt) {
  using T = number_t<V>;
  if constexpr (YieldingLaw<Law, V>) {
    const auto three_g = T(3) * shear_modulus_of(law, conditions);
    const auto yield_surface = law.yield_surface(conditions);
    constexpr bool has_rate = RateLaw<Law>;
    T log_dt = T(0), x_kink = T(0);
    if constexpr (has_rate) {
      log_dt = fast_log(dt);
      x_kink = law.log_kink + log_dt;
    }
    auto out = ReturnMap<V, decltype(yield_surface), decltype(three_g), has_rate>{
        yield_surface, three_g, log_dt, x_kink}(trial, strain);
    // The lesser of two flow stresses is met by the greater of the two strains.
    if constexpr (requires { yield_surface.ceiling(); })
      out.strain_increment = max(out.strain_increment, (trial - yield_surface.ceiling()) / three_g);
    return out;
  } else {
    return {};
  }
}

}  // namespace pockmark
