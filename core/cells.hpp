// Volumetric strain by cells: a point takes its divergence from those at the centres of the cells around it,
// linearly between them, and gives them its pressure with the same weights (docs/theory.md, Volumetric
// strain). A cell is called by its first node.
//
//      cell 0     cell 1     cell 2        of an axis; a point p in cell 1 lies between the centres of
//   |----o-----|----o--p--|----o-----|     cells 1 and 2 and takes from both
//
#pragma once
#include <algorithm>
#include <cstring>

#include "hoop.hpp"

namespace pockmark {

// What the cells of the grid have, a number for each node: a column each in the memory of one nodal array.
// Cells along z lie side by side, and four of them are read and written as one; behind the last there is
// room.
template <class T>
struct Cells {
  T* push;        // what points push the cell with, J / Model::mass_unit
  T* divergence;  // of the velocity at the centre, 1/s
  T* is_whole;    // 1 if all nodes of the cell have mass, or 0

  static Cells in(NodeField<T, Nodal::cell> array, std::size_t nodes) {
    T* const first = reinterpret_cast<T*>(array.data) + nodes;
    return {first, first + nodes, first + 2 * nodes};
  }
  // Gives a cell behind a mirror what its image has.
  void mirror(std::size_t behind, std::size_t image) const {
    divergence[behind] = divergence[image];
    is_whole[behind] = is_whole[image];
  }
};

// Which cells a point takes its divergence from, and their weights along an axis at a place f in its stencil.
// With trilinear functions a point may lie on either side of its cell's centre, with quadratic ones it lies
// between those of the stencil's cells.
//
// turn() fits weights along x to rings; `inner` is the radius of the stencil's first node, in cells. The cell
// beyond a face gets (radius of the face)/(radius of the point) times its weight, the point's own cell the
// rest. So rings that fill cells evenly, of volumes 2 pi r, give as much across a face as they get back, each
// cell is pushed with its own volume, and an even pressure moves nothing.
template <class Shape>
struct CellStencil;
template <class T>
struct CellStencil<Linear<T>> {
  static constexpr int support = 3, first = -1;
  template <class V>
  PM_HD static void weights(V f, V (&w)[support]) {
    w[0] = positive_part(V(T(0.5)) - f);
    w[2] = positive_part(f - V(T(0.5)));
    w[1] = V(T(1)) - (w[0] + w[2]);
  }
  template <class V>
  PM_HD static void turn(V f, T inner, V (&w)[support]) {
    const V half = V(T(0.5)), radius = half + positive_part(V(inner) + f - half);
    w[0] = w[0] * V(inner) / radius;
    w[2] = w[2] * V(inner + T(1)) / radius;
    w[1] = V(T(1)) - (w[0] + w[2]);
  }
};
template <class T>
struct CellStencil<Quadratic<T>> {
  static constexpr int support = 2, first = 0;
  template <class V>
  PM_HD static void weights(V f, V (&w)[support]) {
    w[1] = f - V(T(0.5));
    w[0] = V(T(1)) - w[1];
  }
  template <class V>
  PM_HD static void turn(V f, T inner, V (&w)[support]) {
    if (inner < T(0)) {  // by the axis the first cell is the image of the second
      w[0] = V(T(0));
      w[1] = V(T(1));
      return;
    }
    const V one = V(T(1)), off = positive_part(f - one) + positive_part(one - f);  // from the face
    w[1] = w[1] + off * (V(T(0.5)) - off) / (V(inner) + f);
    w[0] = one - w[1];
  }
};

// Finds the divergence at the centres of a line of cells, and takes what they were pushed with. A cell adds
// up what the four nodes at its lower end along z and those at its upper end give.
template <class Shape, class T>
void find_cells(const GridGeometry<T>& grid, Velocity<T> velocity, const Cells<T>& cells, std::size_t begin,
                std::size_t end) {
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0);
  end = std::min(end, grid.field_count * grid.node_count() - grid.index(1, 1, 1));
  if (begin >= end) return;
  const auto [hoop, lean] = cell_turn<Shape>(grid, begin);
  const T inner = T(1) - hoop, outer = T(1) + hoop, inner_z = T(1) - T(2) * lean,
          outer_z = T(1) + T(2) * lean, scale = T(0.25) * grid.per_metre;
  struct Level {
    T across, along, mass;
  };
  const auto level = [&](std::size_t node) PM_INLINE {
    const auto &a = velocity[node].v, &b = velocity[node + y].v;
    const auto &c = velocity[node + x].v, &d = velocity[node + x + y].v;
    return Level{outer * (c[0] + d[0]) - inner * (a[0] + b[0]) + ((b[1] + d[1]) - (a[1] + c[1])),
                 outer_z * (c[2] + d[2]) + inner_z * (a[2] + b[2]), min(min(a[3], b[3]), min(c[3], d[3]))};
  };
  Level lower = level(begin);
  for (std::size_t cell = begin; cell < end; ++cell) {
    const Level upper = level(cell + 1);
    cells.divergence[cell] =
        scale * ((lower.across + upper.across) + (upper.along - lower.along));
    cells.is_whole[cell] = min(lower.mass, upper.mass) > least_mass<T> ? T(1) : T(0);
    cells.push[cell] = T(0);
    lower = upper;
  }
}

// Adds the forces of what pushes the cells to a line of nodes: the transpose of the divergence.
template <class Shape, class T>
void add_cell_forces(const GridGeometry<T>& grid, const Cells<T>& cells, Force<T> force, std::size_t begin,
                     std::size_t end) {
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0), back = grid.index(1, 1, 1);
  const auto in = begin < x ? CellTurn<T>{} : cell_turn<Shape>(grid, begin - x),
             out = cell_turn<Shape>(grid, begin);
  const T inner = T(1) + in.hoop, outer = T(1) - out.hoop, inner_z = T(1) + T(2) * in.lean,
          outer_z = T(1) - T(2) * out.lean, scale = T(0.25) * grid.per_metre;
  struct Level {
    T x, y, z;
  };
  // What the four cells whose upper end along z is at a node give it.
  const auto level = [&](std::size_t node) PM_INLINE {
    const T* const push = cells.push + node - back;
    const T a = push[0], b = push[y], c = push[x], d = push[x + y];
    return Level{inner * (a + b) - outer * (c + d), (a + c) - (b + d), inner_z * (a + b) + outer_z * (c + d)};
  };
  Level lower = level(begin);
  for (std::size_t node = begin; node < end; ++node) {
    const Level upper = level(node + 1);
    const T sum[3] = {lower.x + upper.x, lower.y + upper.y, lower.z - upper.z};
    for (int a = 0; a < 3; ++a) force[node].v[a] += scale * sum[a];
    lower = upper;
  }
}

// Finds the weights of the cells along x, of points at f in a bundle's stencil.
template <class Shape, class T, class V>
PM_HD void cell_weights_along_x(const GridGeometry<T>& grid, const Bundle& bundle, V f,
                                V (&w)[CellStencil<Shape>::support]) {
  CellStencil<Shape>::weights(f, w);
  if (grid.is_axisymmetric) CellStencil<Shape>::turn(f, T(bundle.base[0] - grid.pad), w);
}

// Returns the cells around a bundle from their first one on.
template <class Shape, class T>
PM_HD std::size_t first_cell(const GridGeometry<T>& grid, const Bundle& bundle) {
  return bundle.node - (CellStencil<Shape>::first < 0 ? grid.index(1, 1, 1) : 0);
}
// Four cells side by side along z.
template <class T>
PM_HD Four<T> four_from(const T* at) {
  Four<T> out;
  std::memcpy(&out, at, sizeof(out));
  return out;
}

// The divergence that cells give to the points of a bundle. Of a cell with a node without mass, beside a
// surface, nothing is known: trilinear functions take that of the points' own cell in its place.
template <class Shape, class T>
class CellPatch {
  using Weights = CellStencil<Shape>;
  static constexpr int S = Weights::support;
  static constexpr bool has_own = S == 3;

 public:
  PM_HD CellPatch(const GridGeometry<T>& grid, const Bundle& bundle, const Cells<T>& cells)
      : grid_(grid), bundle_(bundle) {
    if (has_own) own_ = cells.divergence[bundle.node];
    const std::size_t first = first_cell<Shape>(grid, bundle);
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j) {
        const std::size_t row = first + grid.index(i, j, 0);
        beyond_own_[i][j].v = four_from(cells.divergence + row);
        if (has_own) beyond_own_[i][j].v = four_from(cells.is_whole + row) * (beyond_own_[i][j].v - own_);
      }
  }

  template <class V>
  PM_HD V at(const Vec3<V>& f) const {
    V x[S], y[S], z[S];
    cell_weights_along_x<Shape>(grid_, bundle_, f.x, x);
    Weights::weights(f.y, y);
    Weights::weights(f.z, z);
    V sum = V(own_);
    for (int i = 0; i < S; ++i) {
      V plane = V(T(0));
      for (int j = 0; j < S; ++j) {
        V line = V(T(0));
        for (int k = 0; k < S; ++k) line += z[k] * V(beyond_own_[i][j].v[k]);
        plane += y[j] * line;
      }
      sum += x[i] * plane;
    }
    return sum;
  }

 private:
  const GridGeometry<T>& grid_;
  const Bundle& bundle_;
  T own_ = 0;
  Quad<T> beyond_own_[S][S];  // along z
};

// Pushes the cells around a bundle with the mean stress of its points: mean[i] is a third of the trace of
// what point i pushes with.
template <class Shape, class T>
void add_cell_push(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, const T* mean,
                   const Cells<T>& cells) {
  using Weights = CellStencil<Shape>;
  constexpr int S = Weights::support;
  Quad<T> sum[S][S];  // along z
  T total = 0;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
    const auto f = points.vector(Field::place, p);
    T x[S], y[S], z[S];
    cell_weights_along_x<Shape>(grid, bundle, f.x, x);
    Weights::weights(f.y, y);
    Weights::weights(f.z, z);
    const T push = mean[p - bundle.begin];
    Quad<T> line;
    for (int k = 0; k < S; ++k) line.v[k] = push * z[k];
    total += push;
    for (int j = 0; j < S; ++j) {
      Quad<T> row;
      add_scaled(row, y[j], line);
      for (int i = 0; i < S; ++i) add_scaled(sum[i][j], x[i], row);
    }
  }
  Quad<T> given;
  const std::size_t first = first_cell<Shape>(grid, bundle);
  for (int i = 0; i < S; ++i)
    for (int j = 0; j < S; ++j) {
      const std::size_t row = first + grid.index(i, j, 0);
      if (S == 3) sum[i][j].v = four_from(cells.is_whole + row) * sum[i][j].v;
      given += sum[i][j];
      sum[i][j].v += four_from(cells.push + row);
      std::memcpy(cells.push + row, &sum[i][j].v, sizeof(sum[i][j].v));
    }
  if (S == 3) cells.push[bundle.node] += total - (given.v[0] + given.v[1] + given.v[2]);
}

// Takes the mean stress of what the points of a block push with out of it.
template <class T>
void take_mean(Columns<T, 6>& push, std::size_t count, T (&mean)[Block::most]) {
  for (std::size_t i = 0; i < count; ++i) {
    mean[i] = T(1.0 / 3.0) * (push.at[0][i] + push.at[1][i] + push.at[2][i]);
    for (int a = 0; a < 3; ++a) push.at[a][i] -= mean[i];
  }
}

// Where gather_strain takes the trace of a strain from: the points' own gradient, or the cells.
struct OwnVolume {
  struct Part {
    template <class V>
    PM_HD void replace_trace(Sym3<V>&, const Vec3<V>&) const {}
  };
  PM_HD Part of(const Bundle&) const { return {}; }
};
template <class Shape, class T>
struct CellVolume {
  struct Part {
    CellPatch<Shape, T> divergence;
    T dt;
    template <class V>
    PM_HD void replace_trace(Sym3<V>& strain, const Vec3<V>& f) const {
      const V more = V(T(1.0 / 3.0)) * (V(dt) * divergence.at(f) - trace(strain));
      strain.xx += more;
      strain.yy += more;
      strain.zz += more;
    }
  };
  const GridGeometry<T>& grid;
  Cells<T> cells;
  T dt;
  PM_HD Part of(const Bundle& bundle) const { return {CellPatch<Shape, T>(grid, bundle, cells), dt}; }
};

}  // namespace pockmark
