// Contact of two bodies at a node, with Coulomb friction: Huang, Zhang, Ma and Huang (2011), Int. J. Numer.
// Meth. Engng 85, 498-517 (docs/theory.md, Eqs. 18 to 20).
#pragma once
#include <cmath>
#include <cstddef>
#include <limits>

#include "transfer.hpp"

namespace pockmark {

// A node that two velocity fields share; kg stands for Model::mass_unit.
template <class T>
struct Meeting {
  std::size_t node;  // of the first field
  T mass[2]{};       // of the two bodies there
  Vec3<T> normal{};  // out of the first body (18)
  // How far (m) each body reaches beyond the node: the first along the normal, the second against it.
  T reach[2] = {std::numeric_limits<T>::lowest() / 4, std::numeric_limits<T>::lowest() / 4};
  T closing{};   // approach (m/s) that closes the gap between them by the end of the step (19)
  T approach{};  // (m/s) of the velocities that the points bring along
  // Impulses of the first body on the second (kg m/s, (20)): the one that the points feel, and the sum of
  // those two that take the approach out of the nodal velocities which strain and move them.
  Vec3<T> impulse{}, twice_fitted{};

  // Sets the approach that just closes the gap by the end of the step. Contact stops only what exceeds it: an
  // impulse grows from zero as bodies meet, and no sign of a gap switches contact on.
  PM_HD void allow_closing(T dt) { closing = max(-(reach[0] + reach[1]), T(0)) / dt; }
  PM_HD T beyond_closing(T now) const { return max(now - closing, T(0)); }
  // Returns the share of the step that is left once the gap has closed.
  PM_HD T share_in_contact(T now) const { return T(1) - closing / max(now, max(approach, closing)); }
};

template <class T>
PM_HD Vec3<T> unit(const Vec3<T>& a) {
  const T length = root(dot(a, a));
  return length > T(0) ? (T(1) / length) * a : Vec3<T>{};
}

// Adds to the nodes, for each point of a bundle, its volume times the gradient of their shape function (m^2
// times the cell), with the hoop part of a divergence, and, as the fourth number, times the function.
template <class Shape, class T, class Volume>
void add_surface(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle,
                 Surface<T> surface, Volume&& volume) {
  Patch<Shape, T> patch;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
    const Stencil<Shape, T> n(points.vector(Field::place, p), T(1));
    const auto &w = n.w, &g = n.g;
    T hoop[Shape::support]{};
    if (grid.is_axisymmetric) hoop_weights<Shape>(grid, bundle, n, points.at(Field::place)[p], T(1), hoop);
    const T v = T(volume(p));
    Patch<Shape, T>::for_each([&](int i, int j, int k) {
      add_scaled(patch.at[i][j][k], v,
                 Quad<T>{{(g[0][i] + hoop[i]) * w[1][j] * w[2][k], w[0][i] * g[1][j] * w[2][k],
                          w[0][i] * w[1][j] * g[2][k], n.weight(i, j, k)}});
    });
  }
  patch.add_to(grid, bundle, surface);
}

// Returns the first body's outward normal (18), from what add_surface() found of each body. The second body's
// surface helps where a node lies within the first: there the first's own gradient is the small difference of
// what lies on both sides, and may point the wrong way.
template <class T>
PM_HD Vec3<T> contact_normal(const Quad<T>& first, const Quad<T>& second) {
  const Vec3<T> own = first.vector();
  const T within = max(T(1) - root(dot(own, own)) / first.v[3], T(0));
  return unit(own - within * second.vector());
}

// Takes `stop` (m/s) from the bodies' approach and, with no more than `friction` times that impulse, ends
// their sliding (20).
template <class T>
PM_HD Vec3<T> contact_impulse(const Vec3<T>& relative, T first_mass, T second_mass, const Vec3<T>& normal,
                              T stop, T friction) {
  const Vec3<T> sliding = relative - dot(relative, normal) * normal;
  const T speed = root(dot(sliding, sliding)), most = friction * stop;
  const T reduced_mass = first_mass * (second_mass / (first_mass + second_mass));
  return reduced_mass * (stop * normal + (speed > most ? most / speed : T(1)) * sliding);
}

// Extends the reach of a bundle's body at the nodes where it meets another (19). `at(node)` is the meeting at
// a node of the first field or null; `width(p)` of a point in m.
template <class Shape, class T, class At, class Width>
void add_reach(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, At&& at,
               Width&& width) {
  const std::size_t field = grid.field_of(bundle.node);
  const int side = field == 0 ? 0 : 1;
  const T along = side == 0 ? grid.cell : -grid.cell;
  Patch<Shape, T>::for_each([&](int i, int j, int k) {
    Meeting<T>* meeting = at(bundle.node - field + grid.index(i, j, k));
    if (!meeting) return;
    for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
      const Vec3<T> beyond = points.vector(Field::place, p) - Vec3<T>{T(i), T(j), T(k)};
      const T reach = along * dot(beyond, meeting->normal) + T(0.5) * width(p);
      meeting->reach[side] = max(meeting->reach[side], reach);
    }
  });
}

}  // namespace pockmark
