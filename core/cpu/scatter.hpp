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
    typedef T type __attribute__((vector_size(bytes)));
  };
  using Part = typename Vector::type;
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

// The two linear functions of one axis at the eight nodes: start + sign f.
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
    auto out = start;
    out.add_scaled(f, sign);
    return out;
  }
};

// nodes of the cell += the sums, four numbers a node.
template <class T>
PM_HD void add_to_nodes(const GridGeometry<T>& grid, const Run& run, const Eight<T> (&sum)[4],
                        std::vector<Quad<T>>& nodes) {
  alignas(64) T at[4][8];
  for (int c = 0; c < 4; ++c) std::memcpy(at[c], sum[c].part, sizeof(at[c]));
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      Quad<T>* node = nodes.data() + run.node + grid.index(i, j, 0);
      for (int k = 0; k < 2; ++k) {
        const int l = 4 * i + 2 * j + k;
        node[k] += Quad<T>{{at[0][l], at[1][l], at[2][l], at[3][l]}};
      }
    }
}

// Where in its cell each point of a pack lies, 0 to 1.
template <class V, class T>
PM_HD void store_fractions(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                           std::size_t p, int n, T (&f)[3][Pack<V>::width]) {
  const auto x = points.template vector<V>(Field::position, p, n);
  for (int a = 0; a < 3; ++a) Pack<V>::store(f[a], grid.local(x[a], a) - T(run.base[a]));
}

template <class T>
void add_momentum_lanes(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                        std::vector<Quad<T>>& nodes) {
  using V = Lanes<T>;
  const AxisWeights<T> x(0), y(1), z(2);
  Eight<T> sum[4];
  for_each_pack<V>(run, [&](std::size_t p, int n) {
    alignas(64) T f[3][V::width];
    store_fractions<V>(points, grid, run, p, n, f);
    for (int i = 0; i < n; ++i) {
      const auto weight = points.at(Field::mass)[p + i] * (x(f[0][i]) * y(f[1][i]) * z(f[2][i]));
      for (int c = 0; c < 3; ++c) sum[c].add_scaled(points.at(Field::velocity, c)[p + i], weight);
      sum[3].add(weight);
    }
  });
  add_to_nodes(grid, run, sum, nodes);
}

template <class T>
void add_internal_force_lanes(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                              std::vector<Quad<T>>& nodes) {
  using V = Lanes<T>;
  const AxisWeights<T> x(0), y(1), z(2);
  Eight<T> by_x[3], by_y[3], by_z[3];  // sums of the stress, but for the slope's sign along the axis
  for_each_pack<V>(run, [&](std::size_t p, int n) {
    alignas(64) T f[3][V::width], s[6][V::width];
    store_fractions<V>(points, grid, run, p, n, f);
    const V volume = -grid.per_metre * points.template load<V>(Field::volume, p, n);
    const auto stress = points.template stress<V>(p, n);
    const V all[6] = {stress.xx, stress.yy, stress.zz, stress.xy, stress.yz, stress.zx};
    for (int c = 0; c < 6; ++c) Pack<V>::store(s[c], volume * all[c]);
    for (int i = 0; i < n; ++i) {
      const auto wx = x(f[0][i]), wy = y(f[1][i]), wz = z(f[2][i]);
      const auto yz = wy * wz, zx = wz * wx, xy = wx * wy;
      by_x[0].add_scaled(s[0][i], yz), by_x[1].add_scaled(s[3][i], yz), by_x[2].add_scaled(s[5][i], yz);
      by_y[0].add_scaled(s[3][i], zx), by_y[1].add_scaled(s[1][i], zx), by_y[2].add_scaled(s[4][i], zx);
      by_z[0].add_scaled(s[5][i], xy), by_z[1].add_scaled(s[4][i], xy), by_z[2].add_scaled(s[2][i], xy);
    }
  });
  Eight<T> sum[4];
  for (int c = 0; c < 3; ++c) {
    sum[c].add(x.sign * by_x[c]), sum[c].add(y.sign * by_y[c]), sum[c].add(z.sign * by_z[c]);
  }
  add_to_nodes(grid, run, sum, nodes);
}

#endif

// The kernels that a driver with shape functions `Shape` and numbers or packs `V` uses.
template <class Shape, class V, class T = number_t<V>>
void scatter_momentum(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                      std::vector<Quad<T>>& nodes) {
#ifdef POCKMARK_LANES
  if constexpr (Pack<V>::width > 1 && Shape::support == 2)
    return add_momentum_lanes(points, grid, run, nodes);
#endif
  add_momentum<Shape>(points, grid, run, nodes);
}
template <class Shape, class V, class T = number_t<V>>
void scatter_force(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                   std::vector<Quad<T>>& nodes) {
#ifdef POCKMARK_LANES
  if constexpr (Pack<V>::width > 1 && Shape::support == 2)
    return add_internal_force_lanes(points, grid, run, nodes);
#endif
  add_internal_force<Shape>(points, grid, run, nodes);
}

}  // namespace pockmark::cpu
