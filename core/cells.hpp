// Volumetric strain by cells: a point takes its divergence from those at the centres of the cells around it,
// linearly between them, and gives them its pressure with the same weights (docs/theory.md, Volumetric
// strain). A cell is called by its first node.
//
//      cell 0     cell 1     cell 2        of an axis; a point p in cell 1 lies between the centres of
//   |----o-----|----o--p--|----o-----|     cells 1 and 2 and takes from both
//
#pragma once
#include "hoop.hpp"

namespace pockmark {

// The numbers of a cell: the divergence of the velocity at its centre (1/s), what points push it with (J /
// Model::mass_unit), and whether all of its nodes have mass (1 or 0).
inline constexpr int cell_divergence = 0, cell_push = 1, cell_is_whole = 2;

// Calls f(node, side along x, along y, along z) for the corners of a cell; a side is -1 or 1.
template <class T, class F>
PM_HD void for_each_corner(const GridGeometry<T>& grid, std::size_t cell, F&& f) {
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) f(cell + grid.index(i, j, k), T(2 * i - 1), T(2 * j - 1), T(2 * k - 1));
}

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

// Finds the divergence at the centres of a line of cells, and takes what they were pushed with.
template <class Shape, class T>
void find_cells(const GridGeometry<T>& grid, Velocity<T> velocity, Cells<T> cells, std::size_t begin,
                std::size_t end) {
  const std::size_t last = grid.field_count * grid.node_count() - grid.index(1, 1, 1);
  const T scale = T(0.25) * grid.per_metre;
  for (std::size_t cell = begin; cell < end && cell < last; ++cell) {
    T sum = 0, is_whole = 1;
    for_each_corner(grid, cell, [&](std::size_t node, T x, T y, T z) {
      const auto& v = velocity[node].v;
      sum += x * v[0] + y * v[1] + z * v[2];
      is_whole = has_mass(velocity, node) ? is_whole : T(0);
    });
    if (grid.is_axisymmetric) {
      const CellTurn<T> turn = cell_turn<Shape>(grid, cell);
      for_each_corner(grid, cell, [&](std::size_t node, T x, T, T z) {
        sum += turn.hoop * velocity[node].v[0] + x * z * turn.lean * velocity[node].v[2];
      });
    }
    cells[cell].v[cell_divergence] = scale * sum;
    cells[cell].v[cell_push] = T(0);
    cells[cell].v[cell_is_whole] = is_whole;
  }
}

// Adds the forces of what pushes the cells to a line of nodes: the transpose of the divergence.
template <class Shape, class T>
void add_cell_forces(const GridGeometry<T>& grid, Cells<T> cells, Force<T> force, std::size_t begin,
                     std::size_t end) {
  const std::size_t back = grid.index(1, 1, 1);
  const T scale = T(0.25) * grid.per_metre;
  for (std::size_t node = begin; node < end; ++node) {
    T sum[3]{};
    // The cell before the node along an axis has it on its far side.
    for_each_corner(grid, node, [&](std::size_t cell_and_back, T x, T y, T z) {
      if (cell_and_back < back) return;  // before the first cell
      const T push = cells[cell_and_back - back].v[cell_push];
      sum[0] -= x * push;
      sum[1] -= y * push;
      sum[2] -= z * push;
    });
    if (grid.is_axisymmetric)
      for_each_corner(grid, node, [&](std::size_t cell_and_back, T x, T, T z) {
        if (cell_and_back < back) return;
        const CellTurn<T> turn = cell_turn<Shape>(grid, cell_and_back - back);
        const T push = cells[cell_and_back - back].v[cell_push];
        sum[0] += turn.hoop * push;
        sum[2] += x * z * turn.lean * push;
      });
    for (int a = 0; a < 3; ++a) force[node].v[a] += scale * sum[a];
  }
}

// The divergence that cells give to the points of a bundle. Of a cell with a node without mass, beside a
// surface, nothing is known: trilinear functions take that of the points' own cell in its place.
template <class Shape, class T>
class CellPatch {
  using Weights = CellStencil<Shape>;
  static constexpr int S = Weights::support;
  static constexpr bool has_own = S == 3;

 public:
  PM_HD CellPatch(const GridGeometry<T>& grid, const Bundle& bundle, Cells<T> cells)
      : is_turned_(grid.is_axisymmetric), inner_(T(bundle.base[0] - grid.pad)) {
    if (has_own) own_ = cells[bundle.node].v[cell_divergence];
    for_each(grid, bundle, [&](std::size_t cell, int i, int j, int k) {
      const bool counts = !has_own || cells[cell].v[cell_is_whole] != T(0);
      beyond_own_[i][j][k] = counts ? cells[cell].v[cell_divergence] - own_ : T(0);
    });
  }

  template <class V>
  PM_HD V at(const Vec3<V>& f) const {
    V x[S], y[S], z[S];
    Weights::weights(f.x, x);
    if (is_turned_) Weights::turn(f.x, inner_, x);
    Weights::weights(f.y, y);
    Weights::weights(f.z, z);
    V sum = V(own_);
    for (int i = 0; i < S; ++i) {
      V plane = V(T(0));
      for (int j = 0; j < S; ++j) {
        V line = V(T(0));
        for (int k = 0; k < S; ++k) line += z[k] * V(beyond_own_[i][j][k]);
        plane += y[j] * line;
      }
      sum += x[i] * plane;
    }
    return sum;
  }

  // f(cell, i, j, k) for the cells around a bundle.
  template <class F>
  PM_HD static void for_each(const GridGeometry<T>& grid, const Bundle& bundle, F&& f) {
    const std::size_t start = bundle.node - (has_own ? grid.index(1, 1, 1) : 0);
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        for (int k = 0; k < S; ++k) f(start + grid.index(i, j, k), i, j, k);
  }

 private:
  bool is_turned_;  // on an axisymmetric grid
  T inner_, own_ = 0;
  T beyond_own_[S][S][S];
};

// Pushes the cells around a bundle with the mean stress of its points: mean[i] is a third of the trace of
// what point i pushes with.
template <class Shape, class T>
void add_cell_push(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, const T* mean,
                   Cells<T> cells) {
  using Weights = CellStencil<Shape>;
  constexpr int S = Weights::support;
  Quad<T> sum[S][S];  // along z
  T total = 0;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
    const auto f = points.vector(Field::place, p);
    T x[S], y[S], z[S];
    Weights::weights(f.x, x);
    if (grid.is_axisymmetric) Weights::turn(f.x, T(bundle.base[0] - grid.pad), x);
    Weights::weights(f.y, y);
    Weights::weights(f.z, z);
    const T push = mean[p - bundle.begin];
    Quad<T> line;
    for (int k = 0; k < S; ++k) line.v[k] = push * z[k];
    total += push;
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j) add_scaled(sum[i][j], x[i] * y[j], line);
  }
  T shared = 0;  // with other cells
  CellPatch<Shape, T>::for_each(grid, bundle, [&](std::size_t cell, int i, int j, int k) {
    if (S == 3 && (cell == bundle.node || cells[cell].v[cell_is_whole] == T(0))) return;
    cells[cell].v[cell_push] += sum[i][j].v[k];
    shared += sum[i][j].v[k];
  });
  if (S == 3) cells[bundle.node].v[cell_push] += total - shared;
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
