// From points to nodes with SIMD: trilinear functions touch eight nodes, a lane for each. What the points of
// a run add stays in registers until the run ends. Other shape functions add a node's four numbers at a time.
#pragma once
#include "../transfer.hpp"

namespace pockmark::cpu {

#ifdef POCKMARK_LANES

// Eight numbers, one a node of the cell (x slowest, z fastest), in as many registers as they need.
template <class T>
struct Eight {
  static constexpr int bytes = 8 * sizeof(T) < lane_bytes ? int(8 * sizeof(T)) : lane_bytes;
  static constexpr int parts = int(8 * sizeof(T)) / bytes;
  struct Vector {
    using Whole = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    typedef T type __attribute__((vector_size(bytes)));
    typedef Whole bits __attribute__((vector_size(bytes)));
    typedef T in_memory __attribute__((vector_size(bytes), aligned(alignof(T))));
  };
  using Part = typename Vector::type;
  using Bits = typename Vector::bits;
  using InMemory = typename Vector::in_memory;
  Part part[parts]{};

  PM_HD friend Eight operator*(const Eight& a, const Eight& b) {
    Eight out;
    for (int i = 0; i < parts; ++i) out.part[i] = a.part[i] * b.part[i];
    return out;
  }
  PM_HD friend Eight operator*(T a, const Eight& b) {
    Eight out;
    for (int i = 0; i < parts; ++i) out.part[i] = a * b.part[i];
    return out;
  }
  PM_HD void add(const Eight& a) {
    for (int i = 0; i < parts; ++i) part[i] += a.part[i];
  }
  // this += f a
  PM_HD void add_scaled(T f, const Eight& a) {
    for (int i = 0; i < parts; ++i) part[i] += f * a.part[i];
  }
};

// The two linear functions of one axis at the eight nodes: 1 - f or f. An exclusive or and a sum leave the
// units that multiply to the rest of the work.
template <class T>
struct AxisWeights {
  static constexpr T near[3][8]{{1, 1, 1, 1, 0, 0, 0, 0}, {1, 1, 0, 0, 1, 1, 0, 0}, {1, 0, 1, 0, 1, 0, 1, 0}};
  static constexpr T signs[3][8]{
      {-1, -1, -1, -1, 1, 1, 1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, 1, -1, 1, -1, 1, -1, 1}};
  Eight<T> start, sign;

  PM_HD explicit AxisWeights(int axis) {
    std::memcpy(start.part, near[axis], sizeof(start));
    std::memcpy(sign.part, signs[axis], sizeof(sign));
  }
  PM_HD Eight<T> operator()(T f) const {
    using E = Eight<T>;
    constexpr auto sign_bit = T(-0.0);
    E out;
    for (int i = 0; i < E::parts; ++i) {
      const auto minus = (typename E::Bits)sign.part[i] & (typename E::Bits)(sign_bit - typename E::Part{});
      out.part[i] = start.part[i] + (typename E::Part)((typename E::Bits)(f - typename E::Part{}) ^ minus);
    }
    return out;
  }
};

#define PM_PICK(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

// Four components of eight numbers (two registers of four nodes on AVX2) as the nodes hold them: four
// components a node.
template <class T>
PM_HD void add_to_nodes(const GridGeometry<T>& grid, const Run& run, const Eight<T> (&sum)[4],
                        Array<Quad<T>>& nodes) {
  Quad<T>* const first = nodes.data() + run.node;
  for (int i = 0; i < 2; ++i) {
    Quad<T>* at[2] = {first + grid.index(i, 0, 0), first + grid.index(i, 1, 0)};
    if constexpr (Eight<T>::parts == 2) {
      const auto a = sum[0].part[i], b = sum[1].part[i], c = sum[2].part[i], d = sum[3].part[i];
      const auto ab0 = PM_PICK(a, b, 0, 4, 2, 6), ab1 = PM_PICK(a, b, 1, 5, 3, 7);
      const auto cd0 = PM_PICK(c, d, 0, 4, 2, 6), cd1 = PM_PICK(c, d, 1, 5, 3, 7);
      at[0][0].v += PM_PICK(ab0, cd0, 0, 1, 4, 5), at[0][1].v += PM_PICK(ab1, cd1, 0, 1, 4, 5);
      at[1][0].v += PM_PICK(ab0, cd0, 2, 3, 6, 7), at[1][1].v += PM_PICK(ab1, cd1, 2, 3, 6, 7);
    } else {
      const auto a = sum[0].part[0], b = sum[1].part[0], c = sum[2].part[0], d = sum[3].part[0];
      const auto ab0 = PM_PICK(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
                 ab1 = PM_PICK(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
      const auto cd0 = PM_PICK(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
                 cd1 = PM_PICK(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
      const auto even = i == 0 ? PM_PICK(ab0, cd0, 0, 1, 8, 9, 2, 3, 10, 11)
                               : PM_PICK(ab0, cd0, 4, 5, 12, 13, 6, 7, 14, 15);
      const auto odd = i == 0 ? PM_PICK(ab1, cd1, 0, 1, 8, 9, 2, 3, 10, 11)
                              : PM_PICK(ab1, cd1, 4, 5, 12, 13, 6, 7, 14, 15);
      using Two = typename Eight<T>::InMemory;
      *reinterpret_cast<Two*>(at[0]) += PM_PICK(even, odd, 0, 1, 2, 3, 8, 9, 10, 11);
      *reinterpret_cast<Two*>(at[1]) += PM_PICK(even, odd, 4, 5, 6, 7, 12, 13, 14, 15);
    }
  }
}

#undef PM_PICK

template <class T>
void add_momentum_lanes(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                        Array<Quad<T>>& nodes) {
  const AxisWeights<T> x(0), y(1), z(2);
  const T* mass = points.at(Field::mass);
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  const T *vx = points.at(Field::velocity, 0), *vy = points.at(Field::velocity, 1),
          *vz = points.at(Field::velocity, 2);
  points.prefetch_motion(run.begin);
  Eight<T> sum[4];
  std::size_t p = run.begin;
  do {  // a run is never empty
    const auto weight = (mass[p] * x(fx[p])) * (y(fy[p]) * z(fz[p]));
    sum[0].add_scaled(vx[p], weight), sum[1].add_scaled(vy[p], weight), sum[2].add_scaled(vz[p], weight);
    sum[3].add(weight);
  } while (++p < run.end);
  add_to_nodes(grid, run, sum, nodes);
}

template <class T>
void add_internal_force_lanes(const Particles<T>& points, const GridGeometry<T>& grid, const Block& block,
                              const Columns<T, 6>& push, const Run& run, Array<Quad<T>>& nodes) {
  const AxisWeights<T> x(0), y(1), z(2);
  const T *fx = points.at(Field::place, 0), *fy = points.at(Field::place, 1),
          *fz = points.at(Field::place, 2);
  Eight<T> by_x[3], by_y[3], by_z[3];  // sums of the stress, but for the slope's sign along the axis
  std::size_t p = run.begin;
  do {
    const auto s = [&](int c) { return push.load(c, p - block.begin); };
    const auto wx = x(fx[p]), wy = y(fy[p]), wz = z(fz[p]);
    const auto yz = wy * wz, zx = wz * wx, xy = wx * wy;
    by_x[0].add_scaled(s(0), yz), by_x[1].add_scaled(s(3), yz), by_x[2].add_scaled(s(5), yz);
    by_y[0].add_scaled(s(3), zx), by_y[1].add_scaled(s(1), zx), by_y[2].add_scaled(s(4), zx);
    by_z[0].add_scaled(s(5), xy), by_z[1].add_scaled(s(4), xy), by_z[2].add_scaled(s(2), xy);
  } while (++p < run.end);
  Eight<T> sum[4];
  const T slope = grid.per_metre;
  for (int c = 0; c < 3; ++c) {
    sum[c].add(x.sign * by_x[c]), sum[c].add(y.sign * by_y[c]), sum[c].add(z.sign * by_z[c]);
    sum[c] = slope * sum[c];
  }
  add_to_nodes(grid, run, sum, nodes);
}

#endif

// The kernels that a driver with shape functions `Shape` and numbers or packs `V` uses, over a block.
template <class Shape, class V, class T = number_t<V>>
void scatter_momentum(const Particles<T>& points, const GridGeometry<T>& grid, const Block& block,
                      Array<Quad<T>>& nodes) {
  for_each_run(block, [&](const Run& run) {
#ifdef POCKMARK_LANES
    if constexpr (Pack<V>::width > 1 && Shape::support == 2)
      return add_momentum_lanes(points, grid, run, nodes);
#endif
    add_momentum<Shape>(points, grid, run, nodes);
  });
}
template <class Shape, class V, class T = number_t<V>>
void scatter_force(const Particles<T>& points, const GridGeometry<T>& grid, const Block& block,
                   const Columns<T, 6>& push, Array<Quad<T>>& nodes) {
  for_each_run(block, [&](const Run& run) {
#ifdef POCKMARK_LANES
    if constexpr (Pack<V>::width > 1 && Shape::support == 2)
      return add_internal_force_lanes(points, grid, block, push, run, nodes);
#endif
    add_internal_force<Shape>(points, grid, block, push, run, nodes);
  });
}

}  // namespace pockmark::cpu
