// Between material points and nodes: kernels over a block of points, written for numbers (V = T) or packs.
#pragma once
#include <cstddef>

#include "cell_points.hpp"

namespace pockmark {

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

// Finds how a nodal velocity strains the points of a block in a time dt; `volume` says where the trace comes
// from. Calls also(i, f, displacement) for the points of a pack: the number of the first one in the block,
// their places, and the nodes' displacement in dt/2, in cells.
template <class Shape, class V, class Hints, class T, class Volume, class Also>
void gather_strain(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                   Velocity<T> velocity, T dt, const Volume& volume, StrainColumns<T>& out, Also&& also) {
  const T scale = T(0.5) * dt * grid.per_metre;
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
    Patch<Shape, T> patch;
    patch.load(grid, bundle, velocity);
    Interpolant<Shape, T> displacement(patch);
    displacement.scale(scale);
    const auto around = volume.around(bundle);
    using R = bundle_pack_t<V>;
    for_each_pack<R>(bundle, [&](std::size_t p, int n) PM_INLINE {
      Hints::template before<Pass::gradient>(points, p);
      const auto f = points.template vector<R>(Field::place, p, n);
      const auto trace_of = anew<R>(around).trace_at(f);  // first: it takes many registers, and leaves one
      R d[3][3];                                          // dt/2 d v_c / d x_a
      displacement.slopes(f, d);
      if (grid.is_axisymmetric) d[1][1] = hoop_rate<Shape>(grid, bundle, velocity, scale, f);
      Sym3<R> small{d[0][0] + d[0][0], d[1][1] + d[1][1], d[2][2] + d[2][2],
                    d[0][1] + d[1][0], d[1][2] + d[2][1], d[2][0] + d[0][2]};
      trace_of.put_into(small);
      const Vec3<R> turn{d[2][1] - d[1][2], d[0][2] - d[2][0], d[1][0] - d[0][1]};
      also(p - block.begin, f, displacement);
      store_strain(out, p - block.begin, Strain<R>(small, R(T(0.5)) * turn));
    });
  });
}

// Finds a nodal vector quantity at the points of a block; load(patch, bundle) fetches the nodes of a bundle.
template <class Shape, class V, class T, class Load>
void gather_values(const Points<T>& points, const Block& block, Columns<T, 3>& out, Load&& load) {
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
    Patch<Shape, T> patch;
    load(patch, bundle);
    const Interpolant<Shape, T> field(patch);
    using R = bundle_pack_t<V>;
    for_each_pack<R>(bundle, [&](std::size_t p, int n) PM_INLINE {
      const auto v = field.value(points.template vector<R>(Field::place, p, n));
      for (int c = 0; c < 3; ++c) out.store(c, p - block.begin, v[c]);
    });
  });
}

// Adds what the points of a bundle carry, and their mass, to the nodes.
template <class Shape, class T>
void add_carried(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle,
                 const Carried<T>& of, Momentum<T> momentum) {
  Patch<Shape, T> patch;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
    const Stencil<Shape, T> n(points.vector(Field::place, p), grid.per_metre);
    const std::size_t i = p - of.first;
    const T m = of.mass[i];
    const Quad<T> carried{{m * of.per_mass[0][i], m * of.per_mass[1][i], m * of.per_mass[2][i], m}};
    for (int ix = 0; ix < Shape::support; ++ix)
      for (int j = 0; j < Shape::support; ++j) {
        Quad<T> line;
        add_scaled(line, n.w[0][ix] * n.w[1][j], carried);
        for (int k = 0; k < Shape::support; ++k) add_scaled(patch.at[ix][j][k], n.w[2][k], line);
      }
  }
  patch.add_to(grid, bundle, momentum);
}

// Stores what points push their nodes with: -V sigma (J / Model::mass_unit), a component a column.
template <class V, class T>
PM_HD void store_push(Columns<T, 6>& push, std::size_t i, const PointState<V>& point, V reference_volume,
                      int n) {
  const V volume = -(point.ratio() * reference_volume), mean = point.pressure + point.viscosity;
  const auto& s = point.deviator;
  const V stress[6] = {s.xx - mean, s.yy - mean, s.zz - mean, s.xy, s.yz, s.zx};
  for (int c = 0; c < 6; ++c) push.store(c, i, volume * stress[c], n);
}

// Adds the internal forces f_I = -sum_p sigma_p grad N_I V_p of a bundle (Liu et al. 2015, Eq. 11).
template <class Shape, class T>
void add_internal_force(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                        const Columns<T, 6>& push, const Bundle& bundle, Force<T> force) {
  Patch<Shape, T> sum;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
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
  sum.add_to(grid, bundle, force);
}

}  // namespace pockmark
