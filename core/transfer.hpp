// Between material points and nodes: kernels over a block of points, written for numbers (V = T) or packs.
#pragma once
#include <cstddef>

#include "shape.hpp"
#include "state.hpp"

namespace pockmark {

// Consecutive points of a block whose stencil starts at the same node.
struct Run {
  std::size_t begin, end;
  std::size_t node;
  int base[3];
};

// Consecutive points; few enough that what one kernel leaves of them is still in the cache for the next.
struct Block {
  static constexpr std::size_t most = 256;
  std::size_t begin, end;
  int run_count = 0;
  Run runs[most];

  template <class T>
  Block(const Particles<T>& points, const GridGeometry<T>& grid, std::size_t begin_, std::size_t end_)
      : begin(begin_), end(end_) {
    for (std::size_t p = begin; p < end;) {
      Run& run = runs[run_count++];
      run.begin = p;
      run.node = points.cell[p];
      grid.split(run.node, run.base);
      while (++p < end && points.cell[p] == run.node) {
      }
      run.end = p;
    }
  }
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
  for (; p + width <= range.end; p += width) f(p, int(width));
  if (p < range.end) f(p, int(range.end - p));
}

// A column of numbers of the points of a block. Packs may write past their points' end: what follows is
// written later, or is spare.
template <class T>
struct Column {
  alignas(64) T at[Block::most + 16];
};

template <class Shape, class T>
PM_HD Stencil<Shape, T> stencil_of(const Particles<T>& points, const GridGeometry<T>& grid, std::size_t p,
                                   const Run& run) {
  return {grid, points.vector(Field::position, p), run.base};
}

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
  PM_HD void load(const GridGeometry<T>& grid, const Run& run, const std::vector<Quad<T>>& nodes) {
    const Quad<T>* first = nodes.data() + run.node;
    for_each([&](int i, int j, int k) { at[i][j][k] = first[grid.index(i, j, k)]; });
  }
  PM_HD void subtract(const Patch& other) {
    for_each([&](int i, int j, int k) { at[i][j][k].v -= other.at[i][j][k].v; });
  }
  PM_HD void add_to(const GridGeometry<T>& grid, const Run& run, std::vector<Quad<T>>& nodes) const {
    Quad<T>* first = nodes.data() + run.node;
    for_each([&](int i, int j, int k) { first[grid.index(i, j, k)] += at[i][j][k]; });
  }
};

// A nodal vector field as a function of position within one stencil.
template <class Shape, class T>
class Interpolant {
 public:
  PM_HD explicit Interpolant(const Patch<Shape, T>& patch) : nodes_(patch) {}

  template <class V>
  PM_HD Vec3<V> value(const GridGeometry<T>& grid, const Vec3<V>& x, const int (&base)[3]) const {
    const Stencil<Shape, V> n(grid, x, base);
    Vec3<V> sum{V(0), V(0), V(0)};
    nodes_.for_each([&](int i, int j, int k) {
      const V w = n.weight(i, j, k);
      for (int c = 0; c < 3; ++c) sum[c] += w * nodes_.at[i][j][k].v[c];
    });
    return sum;
  }
  // derivative[c][a] = d v_c / d x_a (Eq. 13), summed axis by axis.
  template <class V>
  PM_HD void gradient(const GridGeometry<T>& grid, const Vec3<V>& x, const int (&base)[3],
                      V (&derivative)[3][3]) const {
    constexpr int S = Shape::support;
    const Stencil<Shape, V> n(grid, x, base);
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
          plane += n.w[1][j] * line, plane_y += n.g[1][j] * line, plane_z += n.w[1][j] * line_z;
        }
        dx += n.g[0][i] * plane, dy += n.w[0][i] * plane_y, dz += n.w[0][i] * plane_z;
      }
      derivative[c][0] = dx, derivative[c][1] = dy, derivative[c][2] = dz;
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
    one_.v = n[0][0][0].v, x_.v = x0, y_.v = y0, z_.v = z0;
    xy_.v = x1 - x0, yz_.v = y2 - y0, zx_.v = x2 - x0, xyz_.v = (x3 - x2) - (x1 - x0);
  }

  template <class V>
  PM_HD Vec3<V> value(const GridGeometry<T>& grid, const Vec3<V>& position, const int (&base)[3]) const {
    const auto f = fraction(grid, position, base);
    Vec3<V> out;
    for (int c = 0; c < 3; ++c)
      out[c] = (one_.v[c] + f.z * z_.v[c]) + f.y * (y_.v[c] + f.z * yz_.v[c]) +
               f.x * ((x_.v[c] + f.z * zx_.v[c]) + f.y * (xy_.v[c] + f.z * xyz_.v[c]));
    return out;
  }
  template <class V>
  PM_HD void gradient(const GridGeometry<T>& grid, const Vec3<V>& position, const int (&base)[3],
                      V (&derivative)[3][3]) const {
    const auto f = fraction(grid, position, base);
    const V per_metre = V(grid.per_metre);
    for (int c = 0; c < 3; ++c) {
      const V yz = yz_.v[c] + f.x * xyz_.v[c];
      derivative[c][0] = per_metre * ((x_.v[c] + f.z * zx_.v[c]) + f.y * (xy_.v[c] + f.z * xyz_.v[c]));
      derivative[c][1] = per_metre * ((y_.v[c] + f.x * xy_.v[c]) + f.z * yz);
      derivative[c][2] = per_metre * ((z_.v[c] + f.x * zx_.v[c]) + f.y * yz);
    }
  }

 private:
  template <class V>
  PM_HD static Vec3<V> fraction(const GridGeometry<T>& grid, const Vec3<V>& x, const int (&base)[3]) {
    return {grid.local(x.x, 0) - T(base[0]), grid.local(x.y, 1) - T(base[1]),
            grid.local(x.z, 2) - T(base[2])};
  }

  Quad<T> one_, x_, y_, z_, xy_, yz_, zx_, xyz_;
};

// The nodal velocity's rate of strain and spin at the points of a block.
template <class T>
struct Gradients {
  Column<T> derivative[3][3];

  template <class Shape, class V>
  PM_HD void gather(const Particles<T>& points, const GridGeometry<T>& grid, const Block& block,
                    const std::vector<Quad<T>>& nodes) {
    for_each_run(block, [&](const Run& run) {
      Patch<Shape, T> patch;
      patch.load(grid, run, nodes);
      const Interpolant<Shape, T> velocity(patch);
      for_each_pack<V>(run, [&](std::size_t p, int n) {
        V d[3][3];
        velocity.gradient(grid, points.template vector<V>(Field::position, p, n), run.base, d);
        for (int c = 0; c < 3; ++c)
          for (int a = 0; a < 3; ++a) Pack<V>::store(derivative[c][a].at + (p - block.begin), d[c][a]);
      });
    });
  }
  // Of the pack that starts with the block's point i.
  template <class V>
  PM_HD VelocityGradient<V> at(std::size_t i) const {
    const auto l = [&](int c, int a) { return Pack<V>::load(derivative[c][a].at + i); };
    const V half = V(0.5);
    const V xy = l(0, 1), yx = l(1, 0), yz = l(1, 2), zy = l(2, 1), zx = l(2, 0), xz = l(0, 2);
    return {{l(0, 0), l(1, 1), l(2, 2), half * (xy + yx), half * (yz + zy), half * (zx + xz)},
            {half * (zy - yz), half * (xz - zx), half * (yx - xy)}};
  }
};

// Nodal values at the points of a block.
template <class T>
struct Values {
  Column<T> component[3];

  template <class Shape, class V>
  PM_HD void gather(const Particles<T>& points, const GridGeometry<T>& grid, const Block& block,
                    const std::vector<Quad<T>>& nodes, const std::vector<Quad<T>>* minus = nullptr) {
    for_each_run(block, [&](const Run& run) {
      Patch<Shape, T> patch;
      patch.load(grid, run, nodes);
      if (minus) {
        Patch<Shape, T> other;
        other.load(grid, run, *minus);
        patch.subtract(other);
      }
      const Interpolant<Shape, T> field(patch);
      for_each_pack<V>(run, [&](std::size_t p, int n) {
        const auto v = field.value(grid, points.template vector<V>(Field::position, p, n), run.base);
        for (int c = 0; c < 3; ++c) Pack<V>::store(component[c].at + (p - block.begin), v[c]);
      });
    });
  }
  template <class V>
  PM_HD Vec3<V> at(std::size_t i) const {
    const auto v = [&](int c) { return Pack<V>::load(component[c].at + i); };
    return {v(0), v(1), v(2)};
  }
};

// Momentum and mass of the points.
template <class Shape, class T>
void add_momentum(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                  std::vector<Quad<T>>& nodes) {
  Patch<Shape, T> patch;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid, p, run);
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
  patch.add_to(grid, run, nodes);
}

// f_I = -sum_p sigma_p grad N_I V_p (Liu et al. 2015, Eq. 11).
template <class Shape, class T>
void add_internal_force(const Particles<T>& points, const GridGeometry<T>& grid, const Run& run,
                        std::vector<Quad<T>>& nodes) {
  Patch<Shape, T> force;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid, p, run);
    const auto s = -points.at(Field::volume)[p] * points.stress(p);
    const Quad<T> column[3] = {
        {{s.xx, s.xy, s.zx, T(0)}}, {{s.xy, s.yy, s.yz, T(0)}}, {{s.zx, s.yz, s.zz, T(0)}}};
    for (int i = 0; i < Shape::support; ++i)
      for (int j = 0; j < Shape::support; ++j) {
        Quad<T> across, along;  // shares of the line of nodes (i, j)
        add_scaled(across, n.g[0][i] * n.w[1][j], column[0]);
        add_scaled(across, n.w[0][i] * n.g[1][j], column[1]);
        add_scaled(along, n.w[0][i] * n.w[1][j], column[2]);
        for (int k = 0; k < Shape::support; ++k) {
          add_scaled(force.at[i][j][k], n.w[2][k], across);
          add_scaled(force.at[i][j][k], n.g[2][k], along);
        }
      }
  }
  force.add_to(grid, run, nodes);
}

}  // namespace pockmark
