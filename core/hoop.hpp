// What an axisymmetric grid adds to a slice of three dimensions (docs/theory.md, Axisymmetry). x is the
// radius r, z the axis, y the hoop direction. The grid is one cell thick along y, between two mirrors, and
// begins at r = 0 with a third. A point is a ring: its mass and volume are those of the full circle. Nothing
// depends on y, so the slice itself has no strain along it; the hoop strain v_r/r comes from here, and so
// does its transpose, the radial force of the hoop stress.
//
// In the stencil that begins at the axis v_r is linear in r, for it is odd: there v_r/r is its slope, and
// nothing is divided by a radius that may be 0.
#pragma once
#include "interpolant.hpp"

namespace pockmark {

inline constexpr double full_turn = 6.283185307179586;  // rad

// Returns the radius of a point `f` along x from the first node of its stencil, in cells.
template <class T, class V>
PM_HD V radius_in_cells(const GridGeometry<T>& grid, const Bundle& bundle, V f) {
  return V(T(bundle.base[0] - grid.pad)) + f;
}

template <class Shape, class T>
PM_HD bool begins_at_axis(const GridGeometry<T>& grid, const Bundle& bundle) {
  return bundle.base[0] <= grid.pad - (Shape::support - 2);
}

// Finds the weights along r with which the nodes' v_r make v_r/r at a point, in the unit of the stencil's
// slopes; `per_length` is 1/cell in that unit. A sum over rings stands for an integral of (r N)'; with the
// second difference of N over 32 it is exact where rings fill cells evenly, two along r, and an even pressure
// moves nothing. Linear functions have none.
template <class Shape, class T, class V>
PM_HD void hoop_weights(const GridGeometry<T>& grid, const Bundle& bundle, const Stencil<Shape, V>& n, V f,
                        T per_length, V (&out)[Shape::support]) {
  constexpr int S = Shape::support;
  if (begins_at_axis<Shape>(grid, bundle)) {
    for (int i = 0; i < S; ++i) out[i] = n.g[0][i];
    return;
  }
  const V share = V(per_length) / radius_in_cells(grid, bundle, f);
  for (int i = 0; i < S; ++i) {
    const T bend = S == 2 ? T(0) : (i == 1 ? T(-2) : T(1)) / T(32);
    out[i] = share * (n.w[0][i] + V(bend));
  }
}

// Returns v_r/r at a place in a bundle's stencil, of v per cell times `scale`. It loads its own patch: one
// that a pass has at hand would have to be in memory for it, in grids without rings too.
template <class Shape, class T, class V>
PM_NOINLINE V hoop_rate(const GridGeometry<T>& grid, const Bundle& bundle, Velocity<T> velocity, T scale,
                        const Vec3<V>& f) {
  Patch<Shape, T> v;
  v.load(grid, bundle, velocity);
  v.scale(scale);
  const Stencil<Shape, V> n(f, T(1));
  V along_r[Shape::support], sum = V(T(0));
  hoop_weights<Shape>(grid, bundle, n, f.x, T(1), along_r);
  v.for_each([&](int i, int j, int k) { sum += along_r[i] * n.w[1][j] * n.w[2][k] * V(v.at[i][j][k].v[0]); });
  return sum;
}

// Adds the radial forces of the hoop stress of a block, f_I = -sum_p N_I V_p sigma_p / r_p; push[1] is
// -V sigma along y.
template <class Shape, class T>
void add_hoop_force(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                    const Columns<T, 6>& push, Force<T> force) {
  for_each_bundle(block, [&](const Bundle& bundle) {
    Patch<Shape, T> sum;
    for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
      const auto f = points.vector(Field::place, p);
      const Stencil<Shape, T> n(f, grid.per_metre);
      T along_r[Shape::support];
      hoop_weights<Shape>(grid, bundle, n, f.x, grid.per_metre, along_r);
      const T stress = push.load(1, p - block.begin);
      sum.for_each(
          [&](int i, int j, int k) { sum.at[i][j][k].v[0] += stress * along_r[i] * n.w[1][j] * n.w[2][k]; });
    }
    sum.add_to(grid, bundle, force);
  });
}

// Returns 1/2r of a cell of radius r, in cells, and how far its divergence (cells.hpp) leans outwards: what
// its nodes at either side across r have of v_z, 1/2 -+ lean. With it an even pressure gradient gives the
// nodes on the axis and beside it what is in proportion to the mass that they have of two rings a cell.
template <class T>
struct CellTurn {
  T hoop = 0, lean = 0;
};
template <class Shape, class T>
PM_HD CellTurn<T> cell_turn(const GridGeometry<T>& grid, std::size_t cell) {
  if (!grid.is_axisymmetric) return {};
  int ijk[3];
  grid.split(cell, ijk);
  const T per_radius = T(1) / (T(ijk[0] - grid.pad) + T(0.5));
  return {T(0.5) * per_radius, (Shape::support == 2 ? T(1) / T(16) : T(5) / T(128)) * per_radius};
}

// Returns the length of the ring that a point is, m.
template <class T>
double circumference(const GridGeometry<T>& grid, const Points<T>& points, std::size_t p) {
  int base[3];
  grid.split(points.cell[p], base);
  return full_turn * double(grid.cell) * (base[0] - grid.pad + double(points.at(Field::place)[p]));
}

}  // namespace pockmark
