// Between material points and nodes: kernels over a block of points, written for numbers (V = T) or packs.
#pragma once
#include <cstddef>

#include "grid.hpp"
#include "points.hpp"
#include "shape.hpp"

namespace pockmark {

// Consecutive points of a block whose stencil starts at the same node.
struct Run {
  std::uint32_t begin, end;
  std::uint32_t node;
  int base[3];
};

// Consecutive points; few enough that what one kernel leaves of them is still in the cache for the next.
struct Block {
  static constexpr std::size_t most = 48;
  std::size_t begin, end;
  bool one_body;
  int run_count;
  const Run* runs;
};

template <class F>
PM_HD void for_each_run(const Block& block, F&& f) {
  for (int r = 0; r < block.run_count; ++r) f(block.runs[r]);
}

// f(first point, number of points) for each pack.
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
};

// Columns of numbers of the points of a block. Packs may write past their points' end: what follows is
// written later, or is spare.
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

// The S^3 values of a nodal field under a stencil.
template <class Shape, class T>
struct Patch {
  static constexpr int S = Shape::support;
  Quad<T> at[S][S][S]{};

  template <class F>
  PM_HD static void for_each(F&& f) {
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        for (int k = 0; k < S; ++k) f(i, j, k);
  }
  template <Nodal quantity>
  PM_HD void load(const GridGeometry<T>& grid, const Run& run, NodeField<T, quantity> nodes) {
    const Quad<T>* first = nodes.data + run.node;
    for_each([&](int i, int j, int k) { at[i][j][k] = first[grid.index(i, j, k)]; });
  }
  PM_HD void scale(T factor) {
    for_each([&](int i, int j, int k) { at[i][j][k].v = factor * at[i][j][k].v; });
  }
  PM_HD void subtract(const Patch& other) {
    for_each([&](int i, int j, int k) { at[i][j][k].v -= other.at[i][j][k].v; });
  }
  template <Nodal quantity>
  PM_HD void add_to(const GridGeometry<T>& grid, const Run& run, NodeField<T, quantity> nodes) const {
    Quad<T>* first = nodes.data + run.node;
    for_each([&](int i, int j, int k) { first[grid.index(i, j, k)] += at[i][j][k]; });
  }
};

// A nodal vector field as a function of the place within one stencil.
template <class Shape, class T>
class Interpolant {
 public:
  PM_HD explicit Interpolant(const Patch<Shape, T>& patch) : nodes_(patch) {}

  template <class V>
  PM_HD Vec3<V> value(const Vec3<V>& f) const {
    const Stencil<Shape, V> n(f, T(1));
    Vec3<V> sum{V(0), V(0), V(0)};
    nodes_.for_each([&](int i, int j, int k) {
      const V w = n.weight(i, j, k);
      for (int c = 0; c < 3; ++c) sum[c] += w * nodes_.at[i][j][k].v[c];
    });
    return sum;
  }
  // derivative[c][a] = d v_c / d f_a (Eq. 13), summed axis by axis.
  template <class V>
  PM_HD void slopes(const Vec3<V>& f, V (&derivative)[3][3]) const {
    constexpr int S = Shape::support;
    const Stencil<Shape, V> n(f, T(1));
    for (int c = 0; c < 3; ++c) {
      V dx = V(0), dy = V(0), dz = V(0);
      for (int i = 0; i < S; ++i) {
        V plane = V(0), plane_y = V(0), plane_z = V(0);
        for (int j = 0; j < S; ++j) {
          V line = V(0), line_z = V(0);
          for (int k = 0; k < S; ++k) {
            line += n.w[2][k] * nodes_.at[i][j][k].v[c];
            line_z += n.g[2][k] * nodes_.at[i][j][k].v[c];
          }
          plane += n.w[1][j] * line;
          plane_y += n.g[1][j] * line;
          plane_z += n.w[1][j] * line_z;
        }
        dx += n.g[0][i] * plane;
        dy += n.w[0][i] * plane_y;
        dz += n.w[0][i] * plane_z;
      }
      derivative[c][0] = dx;
      derivative[c][1] = dy;
      derivative[c][2] = dz;
    }
  }

 private:
  Patch<Shape, T> nodes_;
};

// Trilinear: the polynomial 1, x, y, z, xy, yz, zx, xyz in the cell's own coordinates, 0 to 1.
template <class T>
class Interpolant<Linear<T>, T> {
 public:
  PM_HD explicit Interpolant(const Patch<Linear<T>, T>& patch) {
    const auto& n = patch.at;
    const auto x0 = n[1][0][0].v - n[0][0][0].v, x1 = n[1][1][0].v - n[0][1][0].v;
    const auto x2 = n[1][0][1].v - n[0][0][1].v, x3 = n[1][1][1].v - n[0][1][1].v;
    const auto y0 = n[0][1][0].v - n[0][0][0].v, y2 = n[0][1][1].v - n[0][0][1].v;
    const auto z0 = n[0][0][1].v - n[0][0][0].v;
    one_.v = n[0][0][0].v;
    x_.v = x0;
    y_.v = y0;
    z_.v = z0;
    xy_.v = x1 - x0;
    yz_.v = y2 - y0;
    zx_.v = x2 - x0;
    xyz_.v = (x3 - x2) - (x1 - x0);
  }

  template <class V>
  PM_HD Vec3<V> value(const Vec3<V>& f) const {
    Vec3<V> out;
    for (int c = 0; c < 3; ++c)
      out[c] = (one_.v[c] + f.z * z_.v[c]) + f.y * (y_.v[c] + f.z * yz_.v[c]) +
               f.x * ((x_.v[c] + f.z * zx_.v[c]) + f.y * (xy_.v[c] + f.z * xyz_.v[c]));
    return out;
  }
  template <class V>
  PM_HD void slopes(const Vec3<V>& f, V (&derivative)[3][3]) const {
    for (int c = 0; c < 3; ++c) {
      const V yz = yz_.v[c] + f.x * xyz_.v[c];
      derivative[c][0] = (x_.v[c] + f.z * zx_.v[c]) + f.y * (xy_.v[c] + f.z * xyz_.v[c]);
      derivative[c][1] = (y_.v[c] + f.x * xy_.v[c]) + f.z * yz;
      derivative[c][2] = (z_.v[c] + f.x * zx_.v[c]) + f.y * yz;
    }
  }

 private:
  Quad<T> one_, x_, y_, z_, xy_, yz_, zx_, xyz_;
};

// The strain of each point of a block: the numbers of a Strain in their order.
template <class T>
using StrainColumns = Columns<T, 11>;

template <class V, class T>
PM_HD void store_strain(StrainColumns<T>& out, std::size_t i, const Strain<V>& strain) {
  const auto& [d, w, growth, turn] = strain;
  const V columns[11] = {d.xx, d.yy, d.zz, d.xy, d.yz, d.zx, w.x, w.y, w.z, growth, turn};
  for (int c = 0; c < 11; ++c) out.store(c, i, columns[c]);
}
template <class V, class T>
PM_HD Strain<V> load_strain(const StrainColumns<T>& from, std::size_t i) {
  const auto at = [&](int c) { return from.template load<V>(c, i); };
  Strain<V> strain;
  strain.small = {at(0), at(1), at(2), at(3), at(4), at(5)};
  strain.half_turn = {at(6), at(7), at(8)};
  strain.growth = at(9);
  strain.turn = at(10);
  return strain;
}

// How a nodal velocity strains the points of a block in a time dt.
template <class Shape, class V, class Hints, class T>
void gather_strain(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                   Velocity<T> velocity, T dt, StrainColumns<T>& out) {
  for_each_run(block, [&](const Run& run) PM_INLINE {
    Patch<Shape, T> patch;
    patch.load(grid, run, velocity);
    patch.scale(T(0.5) * dt * grid.per_metre);
    const Interpolant<Shape, T> displacement(patch);
    using R = run_pack_t<V>;
    for_each_pack<R>(run, [&](std::size_t p, int n) PM_INLINE {
      Hints::template before<Pass::gradient>(points, p);
      R d[3][3];  // dt/2 d v_c / d x_a
      displacement.slopes(points.template vector<R>(Field::place, p, n), d);
      const Sym3<R> small{d[0][0] + d[0][0], d[1][1] + d[1][1], d[2][2] + d[2][2],
                          d[0][1] + d[1][0], d[1][2] + d[2][1], d[2][0] + d[0][2]};
      const Vec3<R> turn{d[2][1] - d[1][2], d[0][2] - d[2][0], d[1][0] - d[0][1]};
      store_strain(out, p - block.begin, Strain<R>(small, R(T(0.5)) * turn));
    });
  });
}

// A nodal vector field at the points of a block; load(patch, run) fetches the nodes of a run.
template <class Shape, class V, class T, class Load>
void gather_values(const Points<T>& points, const Block& block, Columns<T, 3>& out, Load&& load) {
  for_each_run(block, [&](const Run& run) PM_INLINE {
    Patch<Shape, T> patch;
    load(patch, run);
    const Interpolant<Shape, T> field(patch);
    using R = run_pack_t<V>;
    for_each_pack<R>(run, [&](std::size_t p, int n) PM_INLINE {
      const auto v = field.value(points.template vector<R>(Field::place, p, n));
      for (int c = 0; c < 3; ++c) out.store(c, p - block.begin, v[c]);
    });
  });
}

// Momentum and mass of the points.
template <class Shape, class T>
void add_momentum(const Points<T>& points, const GridGeometry<T>& grid, const Run& run,
                  Momentum<T> momentum) {
  Patch<Shape, T> patch;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const Stencil<Shape, T> n(points.vector(Field::place, p), grid.per_metre);
    const T m = points.at(Field::mass)[p];
    const auto v = points.vector(Field::velocity, p);
    const Quad<T> carried{{m * v.x, m * v.y, m * v.z, m}};
    for (int i = 0; i < Shape::support; ++i)
      for (int j = 0; j < Shape::support; ++j) {
        Quad<T> line;
        add_scaled(line, n.w[0][i] * n.w[1][j], carried);
        for (int k = 0; k < Shape::support; ++k) add_scaled(patch.at[i][j][k], n.w[2][k], line);
      }
  }
  patch.add_to(grid, run, momentum);
}

// What the points of a block push their nodes with: -V sigma (J), its six components in their columns.
template <class V, class T>
PM_HD void store_push(Columns<T, 6>& push, std::size_t i, const PointState<V>& point, V reference_volume,
                      int n) {
  const V volume = -(point.ratio() * reference_volume), mean = point.pressure + point.viscosity;
  const auto& s = point.deviator;
  const V stress[6] = {s.xx - mean, s.yy - mean, s.zz - mean, s.xy, s.yz, s.zx};
  for (int c = 0; c < 6; ++c) push.store(c, i, volume * stress[c], n);
}

// f_I = -sum_p sigma_p grad N_I V_p (Liu et al. 2015, Eq. 11).
template <class Shape, class T>
void add_internal_force(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                        const Columns<T, 6>& push, const Run& run, Force<T> force) {
  Patch<Shape, T> sum;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const Stencil<Shape, T> n(points.vector(Field::place, p), grid.per_metre);
    const auto s = [&](int c) { return push.load(c, p - block.begin); };
    const Quad<T> column[3] = {
        {{s(0), s(3), s(5), T(0)}}, {{s(3), s(1), s(4), T(0)}}, {{s(5), s(4), s(2), T(0)}}};
    for (int i = 0; i < Shape::support; ++i)
      for (int j = 0; j < Shape::support; ++j) {
        Quad<T> across, along;  // shares of the line of nodes (i, j)
        add_scaled(across, n.g[0][i] * n.w[1][j], column[0]);
        add_scaled(across, n.w[0][i] * n.g[1][j], column[1]);
        add_scaled(along, n.w[0][i] * n.w[1][j], column[2]);
        for (int k = 0; k < Shape::support; ++k) {
          add_scaled(sum.at[i][j][k], n.w[2][k], across);
          add_scaled(sum.at[i][j][k], n.g[2][k], along);
        }
      }
  }
  sum.add_to(grid, run, force);
}

}  // namespace pockmark
