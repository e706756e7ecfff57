// From points to nodes with SIMD. Trilinear functions touch the eight nodes of a cell. A lane is a node, and
// the points of a bundle follow one another:
//
//              lower side of the cell, across x      upper side
//   node       0       1       2       3             4       5       6       7
//   (x,y,z)    0,0,0   0,0,1   0,1,0   0,1,1         1,0,0   1,0,1   1,1,0   1,1,1
//
//   point p    w c     w c     w c     w c           w c     w c     w c     w c
//   point p+1  w c     w c     w c     w c           w c     w c     w c     w c
//   ...         |       |       |       |             |       |       |       |
//               v       v       v       v             v       v       v       v
//   sum[c]      s       s       s       s             s       s       s       s
//
// w is the weight of a point at a node, and c what the point carries: momentum along x, y and z, and mass,
// with a sum of its own for each (or other numbers in the momentum's place). All points of a bundle add to
// the same eight nodes. Were a lane a point, lanes would write to one node at the same time. As it is, a lane
// writes to its own node alone, one point after another, and the sums stay in registers until the bundle
// ends. Then they are turned, so that the four numbers of a node lie side by side, and added to the nodes in
// memory:
//
//   sum[x]   x0 x1 x2 x3 ...               node 0   x0 y0 z0 m0
//   sum[y]   y0 y1 y2 y3 ...       ->      node 1   x1 y1 z1 m1
//   sum[z]   z0 z1 z2 z3 ...               node 2   x2 y2 z2 m2
//   sum[m]   m0 m1 m2 m3 ...               ...
//
// Bundles that share nodes follow one another, on the thread that has their tile. Tiles that are worked on at
// the same time share no node (tiling.hpp).
//
// Other shape functions add the four numbers of a node at a time (transfer.hpp).
#pragma once
#include <cstring>

#include "../levers.hpp"

namespace pockmark::cpu {

#ifdef POCKMARK_LANES

// Numbers of nodes in registers of 32 bytes: two of four doubles, one for each side of the cell, or one of
// eight floats. In a wider register of doubles half of the lanes would compute the same as the other half,
// and many processors take it in two passes.
template <class T>
struct NodeLanes {
  static constexpr int lanes = 32 / int(sizeof(T)), registers = 8 / lanes;
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

// The weights of the nodes along one axis, for a point at f:
//
//   node       0    1    2    3    4    5    6    7
//   slowest   1-f  1-f  1-f  1-f   f    f    f    f     along x
//   slow      1-f  1-f   f    f   1-f  1-f   f    f     along y; along the first of the two axes of a side
//   fast      1-f   f   1-f   f   1-f   f   1-f   f     along z; along the second of them
//
// A weight is start + sign f: 1 - f or 0 + f. The sign is set by an exclusive or, for the units that multiply
// have enough to do.
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

// Adds four components of eight nodes, turned into four numbers a node. PM_PICK takes lanes of two registers.
template <class T, Nodal quantity>
PM_HD void add_to_nodes(const GridGeometry<T>& grid, const Bundle& bundle,
                        const Nodes<T> (&sum)[4][NodeLanes<T>::registers], NodeField<T, quantity> nodes) {
  Quad<T>* const first = nodes.data + bundle.node;
  for (int i = 0; i < 2; ++i) {
    Quad<T>* at[2] = {first + grid.index(i, 0, 0), first + grid.index(i, 1, 0)};
    if constexpr (NodeLanes<T>::registers == 2) {
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

// Spreads the weights of the four nodes of a side over the eight nodes: 1 - f to the lower side, f to the
// upper.
template <class T>
PM_HD void spread(T f, const Nodes<T>& side, Nodes<T> (&out)[NodeLanes<T>::registers]) {
  if constexpr (NodeLanes<T>::registers == 2) {
    out[1] = f * side;
    out[0] = side - out[1];
  } else {
    out[0] = AxisWeights<T>::slowest()(f) * side;
  }
}

template <class T>
PM_HD void add_carried_lanes(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle,
                             const Carried<T>& of, Momentum<T> momentum) {
  const auto y = AxisWeights<T>::slow(), z = AxisWeights<T>::fast();
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  constexpr int registers = NodeLanes<T>::registers;
  Nodes<T> sum[4][registers]{}, weight[registers];
  std::size_t p = bundle.begin;
  do {  // a bundle is never empty
    const std::size_t at = p - of.first;
    spread(fx[p], of.mass[at] * (y(fy[p]) * z(fz[p])), weight);
    for (int i = 0; i < registers; ++i) {
      sum[0][i] += of.per_mass[0][at] * weight[i];
      sum[1][i] += of.per_mass[1][at] * weight[i];
      sum[2][i] += of.per_mass[2][at] * weight[i];
      sum[3][i] += weight[i];
    }
  } while (++p < bundle.end);
  add_to_nodes(grid, bundle, sum, momentum);
}

// Finds what the eight nodes get of the stress. Along x a shape function rises to the upper side and falls to
// the lower one, so all four nodes of a side get what is spread over it (`by_x`), with its sign; so too along
// y and z:
//
//   node            0   1   2   3   4   5   6   7
//   lane of by_x   -0  -1  -2  -3  +0  +1  +2  +3       lane 2 y + z of a side across x
//   lane of by_y   -0  -1  +0  +1  -2  -3  +2  +3       lane 2 x + z of a side across y
//   lane of by_z   -0  +0  -1  +1  -2  +2  -3  +3       lane 2 x + y of a side across z
template <class T>
PM_HD void find_slopes(const Nodes<T>& by_x, const Nodes<T>& by_y, const Nodes<T>& by_z,
                       Nodes<T> (&out)[NodeLanes<T>::registers]) {
  const auto slow = AxisWeights<T>::slow().sign, fast = AxisWeights<T>::fast().sign;
  if constexpr (NodeLanes<T>::registers == 2) {
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
  Nodes<T> by_x[3]{}, by_y[3]{}, by_z[3]{};  // the stress, spread over a side across each axis
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
  Nodes<T> sum[4][NodeLanes<T>::registers]{};
  for (int c = 0; c < 3; ++c) {
    find_slopes<T>(by_x[c], by_y[c], by_z[c], sum[c]);
    for (auto& one : sum[c]) one *= grid.per_metre;
  }
  add_to_nodes(grid, bundle, sum, force);
}

// Does what add_moments does (levers.hpp).
template <class T, class Mass>
PM_HD T add_moments_lanes(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle,
                          Mass&& mass, NodeField<T, Nodal::lever> moments) {
  constexpr int registers = NodeLanes<T>::registers;
  const auto y = AxisWeights<T>::slow(), z = AxisWeights<T>::fast();
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  // Where the nodes lie.
  const Nodes<T> at_y = T(1) - y.start, at_z = T(1) - z.start;
  Nodes<T> at_x[registers], sum[4][registers]{}, weight[registers];
  spread(T(1), Nodes<T>{} + T(1), at_x);
  T all = 0;
  std::size_t p = bundle.begin;
  do {
    const T m = mass(p);
    all += m;
    spread(fx[p], m * (y(fy[p]) * z(fz[p])), weight);
    for (int i = 0; i < registers; ++i) {
      sum[0][i] += (fx[p] - at_x[i]) * weight[i];
      sum[1][i] += (fy[p] - at_y) * weight[i];
      sum[2][i] += (fz[p] - at_z) * weight[i];
      sum[3][i] += weight[i];
    }
  } while (++p < bundle.end);
  add_to_nodes(grid, bundle, sum, moments);
  return all;
}

#endif

// Add what the points of a block carry, or push with, to the nodes: the CPU's driver calls these.
template <class Shape, class V, class T = number_t<V>>
void scatter_carried(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                     const Carried<T>& carried, Momentum<T> momentum) {
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
#ifdef POCKMARK_LANES
    if constexpr (Pack<V>::width > 1 && Shape::support == 2)
      return add_carried_lanes(points, grid, bundle, carried, momentum);
#endif
    add_carried<Shape>(points, grid, bundle, carried, momentum);
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
template <class V, class Mass, class T = number_t<V>>
T scatter_moments(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, Mass&& mass,
                  NodeField<T, Nodal::lever> moments) {
#ifdef POCKMARK_LANES
  if constexpr (Pack<V>::width > 1) return add_moments_lanes(points, grid, bundle, mass, moments);
#endif
  return add_moments(points, grid, bundle, mass, moments);
}

}  // namespace pockmark::cpu
