// Between material points and nodes: the kernels of one run of points that share a stencil of nodes.
#pragma once
#include <cstddef>

#include "shape.hpp"
#include "state.hpp"

namespace pockmark {

// Consecutive points [begin, end) whose stencil starts at the same node.
struct Run {
  std::size_t begin, end;
  int base[3];
};

// The S^3 values of a nodal field under a stencil, in registers or on the stack.
template <class Shape, class Value>
struct Patch {
  static constexpr int S = Shape::support;
  Value at[S][S][S]{};

  template <class F>
  static void for_each(F&& f) {
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        for (int k = 0; k < S; ++k) f(i, j, k);
  }
  template <class Geometry>
  void load(const Geometry& grid, const int (&base)[3], const Value* nodes) {
    for_each([&](int i, int j, int k) { at[i][j][k] = nodes[grid.index(base[0] + i, base[1] + j, base[2] + k)]; });
  }
  template <class Geometry>
  void add_to(const Geometry& grid, const int (&base)[3], Value* nodes) const {
    for_each([&](int i, int j, int k) { nodes[grid.index(base[0] + i, base[1] + j, base[2] + k)] += at[i][j][k]; });
  }
};

template <class Shape, class T>
Stencil<Shape, T> stencil_of(const Particles<T>& points, const GridGeometry<T>& grid, std::size_t p, const Run& run) {
  const auto position = points.vector(Field::position, p);
  const T x[3] = {position.x, position.y, position.z};
  return {grid, x, run.base};
}

template <class Shape, class T>
void add_mass_momentum(const Particles<T>& points, Grid<T>& grid, const Run& run) {
  Patch<Shape, T> mass;
  Patch<Shape, Vec3<T>> momentum;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
    const T m = points.at(Field::mass)[p];
    const auto v = points.vector(Field::velocity, p);
    mass.for_each([&](int i, int j, int k) {
      const T nm = n.weight(i, j, k) * m;
      mass.at[i][j][k] += nm;
      momentum.at[i][j][k] += nm * v;
    });
  }
  mass.add_to(grid.geometry, run.base, grid.mass.data());
  momentum.add_to(grid.geometry, run.base, grid.before.data());
}

template <class Shape, class T>
void add_momentum(const Particles<T>& points, const GridGeometry<T>& geometry, const Run& run, Vec3<T>* nodes) {
  Patch<Shape, Vec3<T>> momentum;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, geometry, p, run);
    const auto mv = points.at(Field::mass)[p] * points.vector(Field::velocity, p);
    momentum.for_each([&](int i, int j, int k) { momentum.at[i][j][k] += n.weight(i, j, k) * mv; });
  }
  momentum.add_to(geometry, run.base, nodes);
}

// f_I = -sum_p sigma_p grad N_I V_p (Liu et al. 2015, Eq. 11).
template <class Shape, class T>
void add_internal_force(const Particles<T>& points, Grid<T>& grid, const Run& run) {
  Patch<Shape, Vec3<T>> force;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
    const auto s = -points.at(Field::volume)[p] * points.stress(p);
    force.for_each([&](int i, int j, int k) {
      const T gx = n.g[0][i] * n.w[1][j] * n.w[2][k];
      const T gy = n.w[0][i] * n.g[1][j] * n.w[2][k];
      const T gz = n.w[0][i] * n.w[1][j] * n.g[2][k];
      force.at[i][j][k] +=
          Vec3<T>{s.xx * gx + s.xy * gy + s.zx * gz, s.xy * gx + s.yy * gy + s.yz * gz,
                  s.zx * gx + s.yz * gy + s.zz * gz};
    });
  }
  force.add_to(grid.geometry, run.base, grid.force.data());
}

// Rate of strain and spin (Eq. 13).
template <class Shape, class T>
VelocityGradient<T> gradient(const Stencil<Shape, T>& n, const Patch<Shape, Vec3<T>>& velocity) {
  Vec3<T> dx, dy, dz;  // derivatives of v along each axis
  velocity.for_each([&](int i, int j, int k) {
    const auto& v = velocity.at[i][j][k];
    dx += (n.g[0][i] * n.w[1][j] * n.w[2][k]) * v;
    dy += (n.w[0][i] * n.g[1][j] * n.w[2][k]) * v;
    dz += (n.w[0][i] * n.w[1][j] * n.g[2][k]) * v;
  });
  const T half = T(0.5);
  return {{dx.x, dy.y, dz.z, half * (dx.y + dy.x), half * (dy.z + dz.y), half * (dz.x + dx.z)},
          {half * (dy.z - dz.y), half * (dz.x - dx.z), half * (dx.y - dy.x)}};
}

// FLIP with a share of PIC: v += sum N (v_after - v_before). Returns the kinetic energy that PIC took (J).
template <class Shape, class T>
double update_velocities(Particles<T>& points, const Grid<T>& grid, const Run& run, T pic) {
  Patch<Shape, Vec3<T>> before, after;
  before.load(grid.geometry, run.base, grid.before.data());
  after.load(grid.geometry, run.base, grid.after.data());
  double taken = 0;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
    Vec3<T> change, velocity;
    after.for_each([&](int i, int j, int k) {
      const T w = n.weight(i, j, k);
      change += w * (after.at[i][j][k] - before.at[i][j][k]);
      velocity += w * after.at[i][j][k];
    });
    const auto flip = points.vector(Field::velocity, p) + change;
    const auto mixed = (T(1) - pic) * flip + pic * velocity;
    taken += 0.5 * double(points.at(Field::mass)[p]) * double(dot(flip, flip) - dot(mixed, mixed));
    points.set_vector(Field::velocity, p, mixed);
  }
  return taken;
}

// x += dt sum N v_after.
template <class Shape, class T>
void move_points(Particles<T>& points, const Grid<T>& grid, const Run& run, T dt) {
  Patch<Shape, Vec3<T>> after;
  after.load(grid.geometry, run.base, grid.after.data());
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
    Vec3<T> velocity;
    after.for_each([&](int i, int j, int k) { velocity += n.weight(i, j, k) * after.at[i][j][k]; });
    points.set_vector(Field::position, p, points.vector(Field::position, p) + dt * velocity);
  }
}

}  // namespace pockmark
