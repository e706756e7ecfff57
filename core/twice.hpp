// Two numbers, or two packs, side by side: for long chains of operations that wait for each other. Two take
// little longer than one.
#pragma once
#include "pack.hpp"

namespace pockmark {

template <class M>
struct TwiceMask {
  M a, b;
  PM_HD friend TwiceMask operator&&(TwiceMask x, TwiceMask y) { return {x.a && y.a, x.b && y.b}; }
  PM_HD friend TwiceMask operator||(TwiceMask x, TwiceMask y) { return {x.a || y.a, x.b || y.b}; }
  PM_HD friend TwiceMask operator!(TwiceMask x) { return {!x.a, !x.b}; }
};
template <class V>
struct Twice {
  using Mask = TwiceMask<mask_t<V>>;
  V a, b;

  Twice() = default;
  PM_HD Twice(V a_, V b_) : a(a_), b(b_) {}
  PM_HD Twice(number_t<V> s) : a(s), b(s) {}
  PM_HD friend Twice operator+(Twice x, Twice y) { return {x.a + y.a, x.b + y.b}; }
  PM_HD friend Twice operator-(Twice x, Twice y) { return {x.a - y.a, x.b - y.b}; }
  PM_HD friend Twice operator*(Twice x, Twice y) { return {x.a * y.a, x.b * y.b}; }
  PM_HD friend Twice operator/(Twice x, Twice y) { return {x.a / y.a, x.b / y.b}; }
  PM_HD friend Twice operator-(Twice x) { return {-x.a, -x.b}; }
  PM_HD friend Mask operator<(Twice x, Twice y) { return {x.a < y.a, x.b < y.b}; }
  PM_HD friend Mask operator<=(Twice x, Twice y) { return {x.a <= y.a, x.b <= y.b}; }
  PM_HD friend Mask operator>(Twice x, Twice y) { return y < x; }
};
template <class V>
struct Pack<Twice<V>> {
  using Number = number_t<V>;
  using Mask = typename Twice<V>::Mask;
  PM_HD static Mask mask(bool b) { return {Pack<V>::mask(b), Pack<V>::mask(b)}; }
};
template <class M, class V>
PM_HD Twice<V> select(TwiceMask<M> m, const Twice<V>& yes, const Twice<V>& no) {
  return {select(m.a, yes.a, no.a), select(m.b, yes.b, no.b)};
}
template <class M>
PM_HD bool any(TwiceMask<M> m) {
  return any(m.a || m.b);
}

}  // namespace pockmark
