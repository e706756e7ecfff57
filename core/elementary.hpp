// log, exp and pow without branches or tables: the same code for numbers, SIMD lanes and CUDA. Relative error
// below 1e-14 in double, 4e-7 in single (tests/kernels). Arguments must be finite and normal, > 0 for log and
// pow.
#pragma once
#include <bit>

#include "lanes.hpp"
#include "twice.hpp"

namespace pockmark {

template <class T>
struct Layout;
template <>
struct Layout<double> {
  static constexpr std::uint64_t one = 0x3ff0000000000000, root_half = 0x3fe6a09e667f3bcd, bias = 1023;
  static constexpr std::uint64_t integers = 0x4330000000000000;  // 2^52: its last bits count whole numbers
  static constexpr int mantissa = 52;
  static constexpr double largest_exponent = 690;
};
template <>
struct Layout<float> {
  static constexpr std::uint32_t one = 0x3f800000, root_half = 0x3f3504f3, bias = 127, integers = 0x4b000000;
  static constexpr int mantissa = 23;
  static constexpr float largest_exponent = 86;
};

// Splits x = 2^e m with m in [sqrt(1/2), sqrt(2)).
template <class V>
PM_HD void split_exponent(V x, V& e, V& m) {
  using T = number_t<V>;
  using Bits = typename Pack<V>::Bits;
  using L = Layout<T>;
  const Bits bits = std::bit_cast<Bits>(raw(x));
  const Bits biased = (bits - L::root_half + L::one) >> L::mantissa;
  e = V(std::bit_cast<decltype(raw(x))>(biased | L::integers)) - V(std::bit_cast<T>(L::integers | L::bias));
  m = V(std::bit_cast<decltype(raw(x))>(bits - (biased << L::mantissa) + L::one));
}

template <class V>
PM_HD V fast_log(V x) {
  using T = number_t<V>;
  V e, m;
  split_exponent(x, e, m);
  const V f = (m - T(1)) / (m + T(1)), z = f * f, z2 = z * z;  // log m = 2 atanh(f)
  V series = (V(1.0 / 3) + z * T(1.0 / 5)) + z2 * (V(1.0 / 7) + z * T(1.0 / 9));
  if constexpr (sizeof(T) == 8)
    series += z2 * z2 *
              ((V(1.0 / 11) + z * T(1.0 / 13)) + z2 * (V(1.0 / 15) + z * (V(1.0 / 17) + z * T(1.0 / 19))));
  return e * T(0.6931471805599453) + T(2) * (f + f * z * series);
}

// Returns log x within 4e-6, without a division: for what an iteration starts from.
template <class V>
PM_HD V rough_log(V x) {
  using T = number_t<V>;
  V e, m;
  split_exponent(x, e, m);
  const V t = m - T(1), t2 = t * t;  // log m / t, interpolated at Chebyshev's points
  const V series = (V(1.00000468) - t * T(0.49990362)) + t2 * (V(0.33256778) - t * T(0.25397832)) +
                   t2 * t2 * (V(0.220703) - t * T(0.14338313));
  return e * T(0.6931471805599453) + t * series;
}

// Returns e^x, cut at e^-690 and e^690 (single: e^-86, e^86).
template <class V>
PM_HD V fast_exp(V x) {
  using T = number_t<V>;
  using Bits = typename Pack<V>::Bits;
  using L = Layout<T>;
  // e^x = 2^n e^r, |r| <= ln(2)/2. Adding 3/2 2^52 rounds to a whole number and leaves it in the last bits.
  x = min(max(x, V(-L::largest_exponent)), V(L::largest_exponent));
  const T magic = T(1.5) * std::bit_cast<T>(L::integers);
  const V shifted = x * T(1.4426950408889634) + V(magic);
  const V n = shifted - V(magic);
  const V r = sizeof(T) == 8 ? (x - n * T(0.6931471803691238)) - n * T(1.9082149292705877e-10)
                             : (x - n * T(0.693359375)) - n * T(-2.12194440e-4);
  const V r2 = r * r, r4 = r2 * r2;
  const V a = (V(1) + r) + r2 * (V(1.0 / 2) + r * T(1.0 / 6));
  V b = (V(1.0 / 24) + r * T(1.0 / 120)) + r2 * (V(1.0 / 720) + r * T(1.0 / 5040));
  if constexpr (sizeof(T) == 8)
    b += r4 * ((V(1.0 / 40320) + r * T(1.0 / 362880)) + r2 * (V(1.0 / 3628800) + r * T(1.0 / 39916800)));
  const Bits power = (std::bit_cast<Bits>(raw(shifted)) + L::bias) << L::mantissa;
  return (a + r4 * b) * V(std::bit_cast<decltype(raw(x))>(power));
}

template <class V>
PM_HD Twice<V> fast_log(Twice<V> x) {
  return {fast_log(x.a), fast_log(x.b)};
}
template <class V>
PM_HD Twice<V> rough_log(Twice<V> x) {
  return {rough_log(x.a), rough_log(x.b)};
}
template <class V>
PM_HD Twice<V> fast_exp(Twice<V> x) {
  return {fast_exp(x.a), fast_exp(x.b)};
}

// Returns x^n for x >= 0, n > 0.
template <class V>
PM_HD V fast_pow(V x, number_t<V> n) {
  using T = number_t<V>;
  const auto positive = x > V(0);
  return select(positive, fast_exp(T(n) * fast_log(select(positive, x, V(1)))), V(0));
}

}  // namespace pockmark
