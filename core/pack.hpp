// What the physics computes with: a type V that is a number or a pack of W of them (lanes.hpp). Here is what
// is to be known of a V, and the case of one number.
#pragma once
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "portable.hpp"

namespace pockmark {

template <class T>
  requires std::is_arithmetic_v<T>
PM_HD T select(bool condition, const T& yes, const T& no) {
  return condition ? yes : no;
}
PM_HD bool any(bool m) { return m; }
PM_HD int count(bool m) { return m; }
PM_HD unsigned bits_of(bool m) { return m; }
PM_HD double root(double x) { return std::sqrt(x); }
PM_HD float root(float x) { return std::sqrt(x); }

PM_HD double raw(double x) { return x; }
PM_HD float raw(float x) { return x; }

// What is to be known of a V, and how it meets memory. With `n` only the first n lanes are read or written.
template <class V>
struct Pack {
  using Number = V;
  using Mask = bool;
  using Bits = std::conditional_t<sizeof(V) == 8, std::uint64_t, std::uint32_t>;
  static constexpr int width = 1;
  PM_HD static bool mask(bool b) { return b; }
  PM_HD static bool first(int n) { return n > 0; }
  PM_HD static V load(const V* at, int = 1) { return *at; }
  PM_HD static void store(V* at, V v, int = 1) { *at = v; }
};
template <class V>
using number_t = typename Pack<V>::Number;
template <class V>
using mask_t = typename Pack<V>::Mask;
template <class V>
struct BundlePack {
  using type = V;
};
template <class V>
using bundle_pack_t = typename BundlePack<V>::type;
template <class V>
PM_HD mask_t<V> first_lanes(int n) {
  return Pack<V>::first(n);
}

template <class V>
PM_HD V max(V a, V b) {
  return select(a < b, b, a);
}
template <class V>
PM_HD V min(V a, V b) {
  return select(b < a, b, a);
}
PM_HD double positive_part(double a) { return a > 0 ? a : 0; }
PM_HD float positive_part(float a) { return a > 0 ? a : 0; }
template <class V>
PM_HD V absolute(V a) {
  return max(a, -a);
}
// Return the sum and the largest of all lanes, in double.
template <class V>
PM_HD double sum_of(V v) {
  number_t<V> at[Pack<V>::width];
  Pack<V>::store(at, v);
  double sum = 0;
  for (const auto x : at) sum += double(x);
  return sum;
}
template <class V>
PM_HD double largest_of(V v) {
  number_t<V> at[Pack<V>::width];
  Pack<V>::store(at, v);
  double largest = double(at[0]);
  for (const auto x : at) largest = double(x) > largest ? double(x) : largest;
  return largest;
}

}  // namespace pockmark
