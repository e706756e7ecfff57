// From points to nodes with SIMD: trilinear functions touch eight nodes, four on each face of the cell across
// x. A lane is a node; what the points of a bundle add stays in registers until the bundle ends. Other shape
// functions add a node's four numbers at a time.
#pragma once
#include <cstring>

#include "../transfer.hpp"

namespace pockmark::cpu {

#ifdef POCKMARK_LANES

// Numbers of nodes (x slowest, z fastest) in registers of 32 bytes: four doubles, the near or the far face,
// or eight floats, both. Of wider ones half would compute the same, and many processors take them in two
// passes.
template <class T>
struct NodeLanes {
  static constexpr int lanes = 32 / int(sizeof(T)), parts = 8 / lanes;
  using Whole = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  typedef T numbers __attribute__((vector_size(32)));
  typedef Whole bits __attribute__((vector_size(32)));
  typedef T in_memory __attribute__((vector_size(32), aligned(alignof(T))));
};
template <class T>
using Nodes = typename NodeLanes<T>::numbers;

template <class T>
PM_HD Nodes<T> in_lanes(const T (&eight)[8]) {
  Nodes<T> out;
  std::memcpy(&out, eight, sizeof(out));
  return out;
}

// The two linear functions of an axis, 1 - f or f, at the nodes of a face across another one: of its two axes
// this is the slow or the fast one; or that across the face, where the lanes hold both. An exclusive or and a
// sum leave the units that multiply to the rest of the work.
template <class T>
struct AxisWeights {
  Nodes<T> start, sign;

  PM_HD static AxisWeights slowest() {
    return {in_lanes<T>({1, 1, 1, 1, 0, 0, 0, 0}), in_lanes<T>({-1, -1, -1, -1, 1, 1, 1, 1})};
  }
  PM_HD static AxisWeights slow() {
    return {in_lanes<T>({1, 1, 0, 0, 1, 1, 0, 0}), in_lanes<T>({-1, -1, 1, 1, -1, -1, 1, 1})};
  }
  PM_HD static AxisWeights fast() {
    return {in_lanes<T>({1, 0, 1, 0, 1, 0, 1, 0}), in_lanes<T>({-1, 1, -1, 1, -1, 1, -1, 1})};
  }
  PM_HD Nodes<T> operator()(T f) const {
    using Bits = typename NodeLanes<T>::bits;
    const Nodes<T> all = f - Nodes<T>{}, sign_bit = T(-0.0) - Nodes<T>{};
    return start + (Nodes<T>)((Bits)all ^ ((Bits)sign & (Bits)sign_bit));
  }
};

#define PM_PICK(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

// Four components at the eight nodes as these hold them: four components a node.
template <class T, Nodal quantity>
PM_HD void add_to_nodes(const GridGeometry<T>& grid, const Bundle& bundle,
                        const Nodes<T> (&sum)[4][NodeLanes<T>::parts], NodeField<T, quantity> nodes) {
  Quad<T>* const first = nodes.data + bundle.node;
  for (int i = 0; i < 2; ++i) {
    Quad<T>* at[2] = {first + grid.index(i, 0, 0), first + grid.index(i, 1, 0)};
    if constexpr (NodeLanes<T>::parts == 2) {
      const auto a = sum[0][i], b = sum[1][i], c = sum[2][i], d = sum[3][i];
      const auto ab0 = PM_PICK(a, b, 0, 4, 2, 6), ab1 = PM_PICK(a, b, 1, 5, 3, 7);
      const auto cd0 = PM_PICK(c, d, 0, 4, 2, 6), cd1 = PM_PICK(c, d, 1, 5, 3, 7);
      at[0][0].v += PM_PICK(ab0, cd0, 0, 1, 4, 5);
      at[0][1].v += PM_PICK(ab1, cd1, 0, 1, 4, 5);
      at[1][0].v += PM_PICK(ab0, cd0, 2, 3, 6, 7);
      at[1][1].v += PM_PICK(ab1, cd1, 2, 3, 6, 7);
    } else {
      const auto a = sum[0][0], b = sum[1][0], c = sum[2][0], d = sum[3][0];
      const auto ab0 = PM_PICK(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
                 ab1 = PM_PICK(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
      const auto cd0 = PM_PICK(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
                 cd1 = PM_PICK(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
      const auto even = i == 0 ? PM_PICK(ab0, cd0, 0, 1, 8, 9, 2, 3, 10, 11)
                               : PM_PICK(ab0, cd0, 4, 5, 12, 13, 6, 7, 14, 15);
      const auto odd = i == 0 ? PM_PICK(ab1, cd1, 0, 1, 8, 9, 2, 3, 10, 11)
                              : PM_PICK(ab1, cd1, 4, 5, 12, 13, 6, 7, 14, 15);
      using Two = typename NodeLanes<T>::in_memory;
      *reinterpret_cast<Two*>(at[0]) += PM_PICK(even, odd, 0, 1, 2, 3, 8, 9, 10, 11);
      *reinterpret_cast<Two*>(at[1]) += PM_PICK(even, odd, 4, 5, 6, 7, 12, 13, 14, 15);
    }
  }
}

// The weights of a face, of which the nodes at the far one get a share f, at the eight nodes.
template <class T>
PM_HD void spread(T f, const Nodes<T>& face, Nodes<T> (&out)[NodeLanes<T>::parts]) {
  if constexpr (NodeLanes<T>::parts == 2) {
    out[1] = f * face;
    out[0] = face - out[1];
  } else {
    out[0] = AxisWeights<T>::slowest()(f) * face;
  }
}

template <class T>
PM_HD void add_momentum_lanes(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle,
                              Momentum<T> momentum) {
  const auto y = AxisWeights<T>::slow(), z = AxisWeights<T>::fast();
  const T* mass = points.at(Field::mass);
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  const T *vx = points.at(Field::velocity, 0), *vy = points.at(Field::velocity, 1),
          *vz = points.at(Field::velocity, 2);
  constexpr int parts = NodeLanes<T>::parts;
  Nodes<T> sum[4][parts]{}, weight[parts];
  std::size_t p = bundle.begin;
  do {  // a bundle is never empty
    spread(fx[p], mass[p] * (y(fy[p]) * z(fz[p])), weight);
    for (int i = 0; i < parts; ++i) {
      sum[0][i] += vx[p] * weight[i];
      sum[1][i] += vy[p] * weight[i];
      sum[2][i] += vz[p] * weight[i];
      sum[3][i] += weight[i];
    }
  } while (++p < bundle.end);
  add_to_nodes(grid, bundle, sum, momentum);
}

// The slopes along x, y and z of what the faces across them carry; of a node's two faces across an axis the
// near one has the minus sign.
template <class T>
PM_HD void add_slopes(const Nodes<T>& by_x, const Nodes<T>& by_y, const Nodes<T>& by_z,
                      Nodes<T> (&out)[NodeLanes<T>::parts]) {
  const auto slow = AxisWeights<T>::slow().sign, fast = AxisWeights<T>::fast().sign;
  if constexpr (NodeLanes<T>::parts == 2) {
    out[0] = slow * PM_PICK(by_y, by_y, 0, 1, 0, 1) + fast * PM_PICK(by_z, by_z, 0, 0, 1, 1) - by_x;
    out[1] = slow * PM_PICK(by_y, by_y, 2, 3, 2, 3) + fast * PM_PICK(by_z, by_z, 2, 2, 3, 3) + by_x;
  } else {
    const auto slowest = AxisWeights<T>::slowest().sign;
    out[0] = slow * PM_PICK(by_y, by_y, 0, 1, 0, 1, 2, 3, 2, 3) +
             fast * PM_PICK(by_z, by_z, 0, 0, 1, 1, 2, 2, 3, 3) + slowest * by_x;
  }
}

#undef PM_PICK

template <class T>
PM_HD void add_internal_force_lanes(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                                    const Columns<T, 6>& push, const Bundle& bundle, Force<T> force) {
  const auto slow = AxisWeights<T>::slow(), fast = AxisWeights<T>::fast();
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  Nodes<T> by_x[3]{}, by_y[3]{}, by_z[3]{};  // sums of the stress, shared out over a face across each axis
  std::size_t p = bundle.begin;
  do {
    const auto s = [&](int c) { return push.load(c, p - block.begin); };
    const auto x = slow(fx[p]), z = fast(fz[p]);
    const auto yz = slow(fy[p]) * z, xz = x * z, xy = x * fast(fy[p]);
    by_x[0] += s(0) * yz;
    by_x[1] += s(3) * yz;
    by_x[2] += s(5) * yz;
    by_y[0] += s(3) * xz;
    by_y[1] += s(1) * xz;
    by_y[2] += s(4) * xz;
    by_z[0] += s(5) * xy;
    by_z[1] += s(4) * xy;
    by_z[2] += s(2) * xy;
  } while (++p < bundle.end);
  Nodes<T> sum[4][NodeLanes<T>::parts]{};
  for (int c = 0; c < 3; ++c) {
    add_slopes<T>(by_x[c], by_y[c], by_z[c], sum[c]);
    for (auto& part : sum[c]) part *= grid.per_metre;
  }
  add_to_nodes(grid, bundle, sum, force);
}

#endif

// The kernels that a driver with shape functions `Shape` and numbers or packs `V` uses, over a block.
template <class Shape, class V, class T = number_t<V>>
void scatter_momentum(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                      Momentum<T> momentum) {
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
#ifdef POCKMARK_LANES
    if constexpr (Pack<V>::width > 1 && Shape::support == 2)
      return add_momentum_lanes(points, grid, bundle, momentum);
#endif
    add_momentum<Shape>(points, grid, bundle, momentum);
  });
}
template <class Shape, class V, class T = number_t<V>>
void scatter_force(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                   const Columns<T, 6>& push, Force<T> force) {
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
#ifdef POCKMARK_LANES
    if constexpr (Pack<V>::width > 1 && Shape::support == 2)
      return add_internal_force_lanes(points, grid, block, push, bundle, force);
#endif
    add_internal_force<Shape>(points, grid, block, push, bundle, force);
  });
}

}  // namespace pockmark::cpu
