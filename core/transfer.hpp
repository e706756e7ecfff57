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
  PM_HD void load(const GridGeometry<T>& grid, const int (&base)[3], const std::vector<Quad<T>>& nodes) {
    for_each(
        [&](int i, int j, int k) { at[i][j][k] = nodes[grid.index(base[0] + i, base[1] + j, base[2] + k)]; });
  }
  PM_HD void add_to(const GridGeometry<T>& grid, const int (&base)[3], std::vector<Quad<T>>& nodes) const {
    for_each([&](int i, int j, int k) {
      nodes[grid.index(base[0] + i, base[1] + j, base[2] + k)] += at[i][j][k];
    });
  }
};

template <class Shape, class T>
PM_HD Stencil<Shape, T> stencil_of(const Particles<T>& points, const GridGeometry<T>& grid, std::size_t p,
                                   const Run& run) {
  const auto position = points.vector(Field::position, p);
  const T x[3] = {position.x, position.y, position.z};
  return {grid, x, run.base};
}

// Momentum and mass of the points.
template <class Shape, class T>
void add_momentum(const Particles<T>& points, const GridGeometry<T>& geometry, const Run& run,
                  std::vector<Quad<T>>& nodes) {
  Patch<Shape, T> patch;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, geometry, p, run);
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
  patch.add_to(geometry, run.base, nodes);
}

// f_I = -sum_p sigma_p grad N_I V_p (Liu et al. 2015, Eq. 11).
template <class Shape, class T>
void add_internal_force(const Particles<T>& points, Grid<T>& grid, const Run& run) {
  Patch<Shape, T> force;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
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
  force.add_to(grid.geometry, run.base, grid.force);
}

// Rate of strain and spin (Eq. 13).
template <class Shape, class T>
PM_HD VelocityGradient<T> gradient(const Stencil<Shape, T>& n, const Patch<Shape, T>& velocity) {
  Quad<T> d[3];  // derivatives of v along each axis, summed axis by axis
  for (int i = 0; i < Shape::support; ++i) {
    Quad<T> plane, plane_y, plane_z;
    for (int j = 0; j < Shape::support; ++j) {
      Quad<T> line, line_z;
      for (int k = 0; k < Shape::support; ++k) {
        add_scaled(line, n.w[2][k], velocity.at[i][j][k]);
        add_scaled(line_z, n.g[2][k], velocity.at[i][j][k]);
      }
      add_scaled(plane, n.w[1][j], line);
      add_scaled(plane_y, n.g[1][j], line);
      add_scaled(plane_z, n.w[1][j], line_z);
    }
    add_scaled(d[0], n.g[0][i], plane);
    add_scaled(d[1], n.w[0][i], plane_y);
    add_scaled(d[2], n.w[0][i], plane_z);
  }
  const auto l = [&](int component, int axis) { return d[axis].v[component]; };
  const T half = T(0.5);
  return {{l(0, 0), l(1, 1), l(2, 2), half * (l(0, 1) + l(1, 0)), half * (l(1, 2) + l(2, 1)),
           half * (l(2, 0) + l(0, 2))},
          {half * (l(2, 1) - l(1, 2)), half * (l(0, 2) - l(2, 0)), half * (l(1, 0) - l(0, 1))}};
}

template <class Shape, class T>
PM_HD Vec3<T> interpolate(const Stencil<Shape, T>& n, const Patch<Shape, T>& velocity) {
  Quad<T> sum;
  for (int i = 0; i < Shape::support; ++i)
    for (int j = 0; j < Shape::support; ++j) {
      Quad<T> line;
      for (int k = 0; k < Shape::support; ++k) add_scaled(line, n.w[2][k], velocity.at[i][j][k]);
      add_scaled(sum, n.w[0][i] * n.w[1][j], line);
    }
  return sum.vector();
}

// FLIP with a share of PIC: v += sum N (v_after - v_before). Returns the kinetic energy that PIC took (J).
template <class Shape, class T>
double update_velocities(Particles<T>& points, const Grid<T>& grid, const Run& run, T pic) {
  Patch<Shape, T> change, after;
  change.load(grid.geometry, run.base, grid.before);
  after.load(grid.geometry, run.base, grid.after);
  change.for_each(
      [&](int i, int j, int k) { change.at[i][j][k].v = after.at[i][j][k].v - change.at[i][j][k].v; });
  double taken = 0;
  for (std::size_t p = run.begin; p < run.end; ++p) {
    const auto n = stencil_of<Shape>(points, grid.geometry, p, run);
    auto v = points.vector(Field::velocity, p) + interpolate(n, change);
    if (pic > T(0)) {
      const auto flip = v;
      v = (T(1) - pic) * flip + pic * interpolate(n, after);
      taken += 0.5 * double(points.at(Field::mass)[p]) * double(dot(flip, flip) - dot(v, v));
    }
    points.set_vector(Field::velocity, p, v);
  }
  return taken;
}

}  // namespace pockmark
