// How the points of a block take velocities from the nodes, move with them, change their cells and leave the
// grid. V is a number or a pack.
#pragma once
#include <cmath>
#include <limits>

#include "transfer.hpp"

namespace pockmark {

// A point that left, and through which face.
struct Exit {
  std::size_t point;
  int face;
};

// Changes the velocities of the points: FLIP with a share of PIC, v += sum N (v_after - v_before) (6).
// Returns the kinetic energy that PIC took (J / Model::mass_unit).
template <class Shape, class V, class Hints, class T = number_t<V>>
double update_velocities(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                         Velocity<T> before, Velocity<T> after, T pic) {
  Columns<T, 3> change, now;
  gather_values<Shape, V>(points, block, change, [&](Patch<Shape, T>& patch, const Bundle& bundle) {
    Patch<Shape, T> old;
    patch.load(grid, bundle, after);
    old.load(grid, bundle, before);
    patch.subtract(old);
  });
  if (pic > T(0))
    gather_values<Shape, V>(points, block, now, [&](Patch<Shape, T>& patch, const Bundle& bundle) {
      patch.load(grid, bundle, after);
    });
  V taken = V(0);
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    Hints::template before<Pass::velocity>(points, p);
    const auto flip =
        points.template vector<V>(Field::velocity, p, n) + change.template vector<V>(p - block.begin);
    if (!(pic > T(0))) return points.set_vector(Field::velocity, p, flip, n);
    const auto v = V(T(1) - pic) * flip + V(pic) * now.template vector<V>(p - block.begin);
    const V lost = T(0.5) * points.template load<V>(Field::mass, p, n) * (dot(flip, flip) - dot(v, v));
    taken += select(first_lanes<V>(n), lost, V(0));
    points.set_vector(Field::velocity, p, v, n);
  });
  return sum_of(taken);
}

// Returns the face behind which a point lies, or -1. It is `f` cells from `base`, the first node of its
// stencil. Not-a-number counts as outside.
template <class T>
PM_HD int face_crossed(const GridGeometry<T>& grid, const int (&base)[3], const Vec3<T>& f) {
  for (int a = 0; a < 3; ++a) {
    const T xi = T(base[a]) + f[a];
    if (!(xi >= T(grid.pad))) return 2 * a;
    if (!(xi < T(grid.pad + grid.cells[a]))) return 2 * a + 1;
  }
  return -1;
}

// Gives a point that has crossed a plane of symmetry the place and the motion of its image: as much as leaves
// the half that is computed enters it from the other half. `base` and `f` are as for face_crossed().
template <class Shape, class T>
PM_HD void reflect(const Points<T>& points, const GridGeometry<T>& grid, std::size_t p, int (&base)[3],
                   Vec3<T>& f) {
  for (int face = 0; face < 6; ++face) {
    if (!grid.is_symmetric[face]) continue;
    const int a = face / 2, plane = face % 2 ? grid.pad + grid.cells[a] : grid.pad;
    const T beyond = (T(base[a] - plane) + f[a]) * (face % 2 ? T(1) : T(-1));  // cells
    // The upper plane itself is outside.
    if (!(beyond > T(0) || (face % 2 && beyond == T(0))) || !(beyond < T(grid.cells[a]))) continue;
    const T inside = face % 2 ? -max(beyond, std::numeric_limits<T>::epsilon()) : beyond;  // from the plane
    const T shift = std::floor(inside - T(Shape::offset));
    base[a] = plane + int(shift);
    f[a] = inside - shift;
    T* v = points.at(Field::velocity, a);
    v[p] = -v[p];
    // A mirror turns the sign of those two of xy, yz, zx that have its axis.
    for (int c = 3; c < 6; ++c)
      if (c - 3 == a || (c - 2) % 3 == a) points.at(Field::deviator, c)[p] *= T(-1);
  }
}

// Gives a point that moved out of its stencil's reach a new one, or has it leave the grid: leave(point,
// face). Returns whether it changed its cell.
template <class Shape, class T, class Leave>
PM_NOINLINE bool relocate(const Points<T>& points, const GridGeometry<T>& grid, std::size_t p,
                          Leave&& leave) {
  int base[3];
  grid.split(points.cell[p], base);
  auto f = points.vector(Field::place, p);
  for (int a = 0; a < 3; ++a) {
    const T shift = std::floor(f[a] - T(Shape::offset));
    if (!(std::abs(shift) < T(1e6))) continue;  // it has left
    base[a] += int(shift);
    f[a] -= shift;
  }
  reflect<Shape>(points, grid, p, base, f);
  const int face = face_crossed(grid, base, f);
  if (face >= 0) leave(p, face);
  const std::size_t node = grid.field_of(points.cell[p]) + grid.index(base[0], base[1], base[2]);
  const std::uint32_t cell = face >= 0 ? gone : std::uint32_t(node);
  const bool changed = cell != points.cell[p];
  points.cell[p] = cell;
  points.set_vector(Field::place, p, f);
  return changed;
}

// Moves the points of a block, x += factor times a vector that each has, in cells. Calls leave(point, face)
// for a point that leaves the grid. Returns whether a point changed its cell.
template <class Shape, class V, class T, class Leave>
bool move_points(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                 const Columns<T, 3>& vectors, T factor, Leave&& leave) {
  bool changed = false;
  const V low = V(T(Shape::offset)), high = V(T(Shape::offset) + T(1));
  const auto inside = [&](V f) PM_INLINE { return low <= f && f < high; };
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const auto f = points.template vector<V>(Field::place, p, n) +
                   V(factor) * vectors.template vector<V>(p - block.begin);
    points.set_vector(Field::place, p, f, n);
    if (any(!(inside(f.x) && inside(f.y) && inside(f.z)) && first_lanes<V>(n)))
      for (int i = 0; i < n; ++i) changed |= relocate<Shape>(points, grid, p + i, leave);
  });
  if (Shape::offset == 0) return changed;
  // These functions reach beyond the faces: a point can leave the grid and keep its stencil.
  for_each_bundle(block, [&](const Bundle& bundle) {
    bool rim = false;
    for (int a = 0; a < 3; ++a)
      rim = rim || bundle.base[a] < grid.pad || bundle.base[a] >= grid.pad + grid.cells[a] - 1;
    if (!rim) return;
    for (std::size_t p = bundle.begin; p < bundle.end; ++p)
      if (points.cell[p] == bundle.node &&
          face_crossed(grid, bundle.base, points.vector(Field::place, p)) >= 0)
        changed |= relocate<Shape>(points, grid, p, leave);
  });
  return changed;
}
// Moves them by a nodal velocity, x += dt sum N v_after (6).
template <class Shape, class V, class T, class Leave>
bool move_points(const Points<T>& points, const GridGeometry<T>& grid, const Block& block, Velocity<T> after,
                 T dt, Leave&& leave) {
  Columns<T, 3> velocity;
  gather_values<Shape, V>(points, block, velocity, [&](Patch<Shape, T>& patch, const Bundle& bundle) {
    patch.load(grid, bundle, after);
  });
  return move_points<Shape, V>(points, grid, block, velocity, dt * grid.per_metre, leave);
}

// Returns whether a step in which no node moves would leave the points of a block as they are.
template <class T>
PM_HD bool rests(const Points<T>& points, const Block& block) {
  for (std::size_t p = block.begin; p < block.end; ++p) {
    const auto point = points.state(p);
    const auto v = points.vector(Field::velocity, p);
    if (!(v.x == T(0) && v.y == T(0) && v.z == T(0) && effective(point.deviator) == T(0) &&
          point.dilation == T(0) && point.energy == T(0) && point.pressure == T(0) &&
          point.viscosity == T(0)))
      return false;
  }
  return true;
}

}  // namespace pockmark
