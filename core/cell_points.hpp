// Volumetric strain by cells: a point takes its divergence from those at the centres of the cells around it,
// linearly between them, and gives them its pressure with the same weights (docs/theory.md, Volumetric
// strain).
//
//      cell 0     cell 1     cell 2        of an axis; a point p in cell 1 lies between the centres of
//   |----o-----|----o--p--|----o-----|     cells 1 and 2 and takes from both
//
#pragma once
#include "cells.hpp"

namespace pockmark {

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

// The weights of the cells along x, y and z for the points of a block, a column each.
template <class Shape, class T>
using CellWeights = Columns<T, 3 * CellStencil<Shape>::support>;

template <class Shape, class V, class T = number_t<V>>
void find_cell_weights(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                       CellWeights<Shape, T>& out) {
  using Cell = CellStencil<Shape>;
  constexpr int S = Cell::support;
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const auto f = points.template vector<V>(Field::place, p, n);
    for (int a = 0; a < 3; ++a) {
      V w[S];
      Cell::weights(f[a], w);
      for (int i = 0; i < S; ++i) out.store(S * a + i, p - block.begin, w[i]);
    }
  });
  if (!grid.is_axisymmetric) return;
  for_each_bundle(block, [&](const Bundle& bundle) {
    for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
      T w[S];
      for (int i = 0; i < S; ++i) w[i] = out.load(i, p - block.begin);
      Cell::turn(points.at(Field::place)[p], T(bundle.base[0] - grid.pad), w);
      for (int i = 0; i < S; ++i) out.store(i, p - block.begin, w[i]);
    }
  });
}

// The cells around a bundle: S along each axis, rows along z.
template <class Shape, class T>
struct CellsAround {
  static constexpr int S = CellStencil<Shape>::support;
  // With trilinear functions only whole cells count: of one with a node without mass, beside a surface,
  // nothing is known, and the points' own cell stands in for it.
  static constexpr bool whole_only = S == 3;
  std::size_t row[S][S], own;  // the first cell of each row, the cell of the points

  PM_HD CellsAround(const GridGeometry<T>& grid, const Bundle& bundle) : own(bundle.node) {
    const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0);
    const std::size_t first = own - (CellStencil<Shape>::first < 0 ? x + y + 1 : 0);
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j) row[i][j] = first + i * x + j * y;
  }
  PM_HD bool all_count(const Cells<T>& cells) const {
    if (!whole_only) return true;
    constexpr std::uint8_t three[4]{1, 1, 1, 0};
    std::uint32_t all, four;
    std::memcpy(&all, three, sizeof(all));
    const std::uint32_t whole = all;
    for (int n = 0; n < S * S; ++n) {
      std::memcpy(&four, cells.is_whole + row[n / S][n % S], sizeof(four));
      all &= four;
    }
    return all == whole;
  }
  // Calls f(cell that counts, i, j, k) for each of them; that may be the points' own.
  template <class F>
  PM_HD void for_each_counting(const Cells<T>& cells, F&& f) const {
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        for (int k = 0; k < S; ++k) f(cells.is_whole[row[i][j] + k] ? row[i][j] + k : own, i, j, k);
  }
};

// Finds the divergence of the cells that count around a bundle.
template <class Shape, class T, int S>
PM_NOINLINE void find_counting(const CellsAround<Shape, T>& around, const Cells<T>& cells,
                               T (&out)[S][S][S]) {
  around.for_each_counting(
      cells, [&](std::size_t cell, int i, int j, int k) { out[i][j][k] = cells.divergence[cell]; });
}
// Pushes the cells that count around a bundle.
template <class Shape, class T, int S>
PM_NOINLINE void push_counting(const CellsAround<Shape, T>& around, const Cells<T>& cells,
                               const Quad<T> (&push)[S][S]) {
  around.for_each_counting(
      cells, [&](std::size_t cell, int i, int j, int k) { cells.push[cell] += push[i][j].v[k]; });
}

// Adds to four numbers in memory, which need not lie where a register would.
template <class T>
PM_HD void add_four(T* at, const Quad<T>& more) {
  Four<T> sum;
  std::memcpy(&sum, at, sizeof(sum));
  sum += more.v;
  std::memcpy(at, &sum, sizeof(sum));
}

// Finds the divergence that cells give to the points of a block.
template <class Shape, class V, class T = number_t<V>>
void gather_divergence(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                       const Cells<T>& cells, Columns<T, 1>& out) {
  using Cell = CellStencil<Shape>;
  using R = bundle_pack_t<V>;
  constexpr int S = Cell::support;
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
    const CellsAround<Shape, T> around(grid, bundle);
    const T* row[S][S];
    T counting[S][S][S];
    const bool all_count = around.all_count(cells);
    if (!all_count) find_counting(around, cells, counting);
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        row[i][j] = all_count ? cells.divergence + around.row[i][j] : counting[i][j];
    for_each_pack<R>(bundle, [&](std::size_t p, int n) PM_INLINE {
      const auto f = points.template vector<R>(Field::place, p, n);
      R x[S], y[S], z[S], sum = R(T(0));
      Cell::weights(f.x, x);
      Cell::weights(f.y, y);
      Cell::weights(f.z, z);
      if (grid.is_axisymmetric) Cell::turn(f.x, T(bundle.base[0] - grid.pad), x);
      for (int i = 0; i < S; ++i) {
        R plane = R(T(0));
        for (int j = 0; j < S; ++j) {
          R line = R(T(0));
          for (int k = 0; k < S; ++k) line += z[k] * R(row[i][j][k]);
          plane += y[j] * line;
        }
        sum += x[i] * plane;
      }
      out.store(0, p - block.begin, sum);
    });
  });
}

// Takes the mean stress of what the points of a block push with out of it, and pushes the cells with it. A
// lane is a cell, of four along z, as it is a node in cpu/scatter.hpp.
template <class Shape, class V, class T = number_t<V>>
void move_mean_to_cells(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                        Columns<T, 6>& push, const Cells<T>& cells) {
  constexpr int S = CellStencil<Shape>::support;
  CellWeights<Shape, T> weights;
  find_cell_weights<Shape, V>(points, grid, block, weights);
  for_each_pack<V>(block, [&](std::size_t p, int) PM_INLINE {
    const std::size_t at = p - block.begin;
    const auto s = [&](int c) PM_INLINE { return push.template load<V>(c, at); };
    const V mean = V(T(1.0 / 3.0)) * (s(0) + s(1) + s(2));
    for (int c = 0; c < 3; ++c) push.store(c, at, s(c) - mean);
    for (int c = 2 * S; c < 3 * S; ++c) weights.store(c, at, mean * weights.template load<V>(c, at));
  });
  for_each_bundle(block, [&](const Bundle& bundle) PM_INLINE {
    Quad<T> sum[S][S];
    for (std::size_t p = bundle.begin - block.begin; p < bundle.end - block.begin; ++p) {
      Quad<T> pushed;
      for (int k = 0; k < S; ++k) pushed.v[k] = weights.at[2 * S + k][p];
      for (int j = 0; j < S; ++j) {
        const auto row = weights.at[S + j][p] * pushed.v;
        for (int i = 0; i < S; ++i) sum[i][j].v += weights.at[i][p] * row;
      }
    }
    const CellsAround<Shape, T> around(grid, bundle);
    if (!around.all_count(cells)) return push_counting(around, cells, sum);
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j) add_four(cells.push + around.row[i][j], sum[i][j]);
  });
}

// Where gather_strain takes the trace of a strain from: the points' own gradient, or the divergence that
// cells give.
struct OwnVolume {
  template <class V>
  PM_HD void replace_trace(Sym3<V>&, std::size_t) const {}
};
template <class T>
struct CellVolume {
  const Columns<T, 1>& divergence;
  T dt;
  template <class V>
  PM_HD void replace_trace(Sym3<V>& strain, std::size_t i) const {
    const V more = V(T(1.0 / 3.0)) * (V(dt) * divergence.template load<V>(0, i) - trace(strain));
    strain.xx += more;
    strain.yy += more;
    strain.zz += more;
  }
};

}  // namespace pockmark
