// The points that a kernel works on at a time, and what it leaves of them for the next kernel.
#pragma once
#include <cstddef>
#include <cstdint>

#include "points.hpp"

namespace pockmark {

// Consecutive points of a block whose stencils start at the same node.
struct Bundle {
  std::uint32_t begin, end;
  std::uint32_t node;
  int base[3];
};

// Consecutive points; few enough that what one kernel leaves of them is still in the cache for the next.
struct Block {
  static constexpr std::size_t most = 48;
  std::size_t begin, end;
  bool one_body;
  int bundle_count;
  const Bundle* bundles;
};

template <class F>
PM_HD void for_each_bundle(const Block& block, F&& f) {
  for (int r = 0; r < block.bundle_count; ++r) f(block.bundles[r]);
}

// Calls f(first point, number of points) for each pack of a block, a bundle or another range.
template <class V, class Range, class F>
PM_HD void for_each_pack(const Range& range, F&& f) {
  constexpr std::size_t width = Pack<V>::width;
  std::size_t p = range.begin;
  const std::size_t end = range.end;
  for (; p + width <= end; p += width) f(p, int(width));
  if (p < end) f(p, int(end - p));
}

// The passes over the points of a block that read fields first. Before each pack a kernel calls
// Hints::before<pass>(points, p): a driver may ask its memory for what comes next.
enum class Pass { gradient, strain, pressure, velocity, last_strain };
struct NoHints {
  template <Pass pass, class T>
  PM_HD static void before(const Points<T>&, std::size_t) {}
  template <class T>
  PM_HD static void moments(const Points<T>&, const Bundle&) {}
};

// Columns of numbers, a place in each for every point of a block. A pack may write past the last of its
// points: the places there are written later, or are spare.
template <class T, int count>
struct Columns {
  alignas(64) T at[count][Block::most + 16];

  template <class V = T>
  PM_HD V load(int c, std::size_t i) const {
    return Pack<V>::load(at[c] + i);
  }
  template <class V>
  PM_HD void store(int c, std::size_t i, V v, int n = Pack<V>::width) {
    Pack<V>::store(at[c] + i, v, n);
  }
  template <class V = T>
  PM_HD Vec3<V> vector(std::size_t i) const {
    return {load<V>(0, i), load<V>(1, i), load<V>(2, i)};
  }
};

// What points carry to the nodes: a mass each, and three numbers per mass. Point p has the number p - first
// of every array.
template <class T>
struct Carried {
  const T* mass;
  const T* per_mass[3];
  std::size_t first;
};
template <class T>
PM_HD Carried<T> momentum_of(const Points<T>& points) {
  const auto v = [&](int a) { return points.at(Field::velocity, a); };
  return {points.at(Field::mass), {v(0), v(1), v(2)}, 0};
}

}  // namespace pockmark
