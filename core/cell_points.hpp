// Volumetric strain by cells: a point takes its divergence from those at the centres of the cells around it,
// linearly between them, and gives them its pressure with the same weights (docs/theory.md, Volumetric
// strain).
//
//      cell 0     cell 1     cell 2        of an axis; a point p in cell 1 lies between the centres of
//   |----o-----|----o--p--|----o-----|     cells 1 and 2 and takes from both
//
#pragma once
#include <cstring>

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
    const V off = f - V(T(0.5));
    w[2] = positive_part(off);
    w[0] = w[2] - off;
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

// Four numbers side by side in memory, which need not lie where a register would. None is returned: without
// AVX that would be another convention of calls.
template <class T>
PM_HD void load_four(const T* at, Four<T>& out) {
  std::memcpy(&out, at, sizeof(out));
}
template <class T>
PM_HD void add_four(T* at, const Four<T>& more) {
  Four<T> sum;
  load_four(at, sum);
  sum += more;
  std::memcpy(at, &sum, sizeof(sum));
}

// The cells around a bundle: S along each axis, rows along z. With trilinear functions only whole cells
// count: of one with a node without mass, beside a surface, nothing is known, and the points' own cell stands
// in for it.
template <class Shape, class T>
class CellsAround {
 public:
  static constexpr int S = CellStencil<Shape>::support;
  static constexpr bool whole_only = S == 3;
  // How far it is in memory to the next cell along x and y, and back to the first of those around a cell.
  struct Steps {
    std::size_t x, y, back;
    PM_HD explicit Steps(const GridGeometry<T>& grid)
        : x(grid.index(1, 0, 0)), y(grid.index(0, 1, 0)), back(whole_only ? x + y + 1 : 0) {}
  };

  PM_HD CellsAround(const Cells<T>& cells, const Steps& steps, std::size_t own)
      : cells_(cells), steps_(steps), own_(own) {}

  PM_HD bool all_count() const { return !whole_only || cells_.is_surrounded[own_]; }
  // Returns where the divergence of the first of them is.
  PM_HD const T* divergence() const { return cells_.divergence + own_ - steps_.back; }
  // Finds the divergence of the cells, where not all count.
  PM_HD void find_divergence(T (&out)[S][S][4]) const {
    const T one = cells_.divergence[own_];
    const Four<T> own{one, one, one, one};
    for_each_row([&](int i, int j, std::size_t row) PM_INLINE {
      Four<T> counts, found;
      find_counting(row, counts);
      load_four(cells_.divergence + row, found);
      found = counts * found + (own - counts * own);
      std::memcpy(out[i][j], &found, sizeof(found));
    });
  }
  // Pushes the cells that count.
  PM_HD void push(const Quad<T> (&push)[S][S]) const {
    if (all_count())
      return for_each_row([&](int i, int j, std::size_t row)
                              PM_INLINE { add_four(cells_.push + row, push[i][j].v); });
    Four<T> rest{};
    for_each_row([&](int i, int j, std::size_t row) PM_INLINE {
      Four<T> counted;
      find_counting(row, counted);
      counted = counted * push[i][j].v;
      add_four(cells_.push + row, counted);
      rest += push[i][j].v - counted;
    });
    cells_.push[own_] += rest[0] + rest[1] + rest[2];
  }

 private:
  // Calls f(i, j, first cell of the row) for each row.
  template <class F>
  PM_HD void for_each_row(F&& f) const {
    const std::size_t first = own_ - steps_.back;
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j) f(i, j, first + i * steps_.x + j * steps_.y);
  }
  // Finds 1 for each cell of a row that counts, or 0.
  PM_HD void find_counting(std::size_t row, Four<T>& counts) const {
    const std::uint8_t* const whole = cells_.is_whole + row;
    counts = Four<T>{T(whole[0]), T(whole[1]), T(whole[2]), T(0)};
  }

  const Cells<T>& cells_;
  const Steps& steps_;
  std::size_t own_;
};

// The weights of the cells along x, y and z for the points of a block, a column each.
template <class Shape, class T>
using CellWeights = Columns<T, 3 * CellStencil<Shape>::support>;

// Fits the weights along x to rings.
template <class Shape, class T>
PM_NOINLINE void turn_weights(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                              CellWeights<Shape, T>& weights) {
  constexpr int S = CellStencil<Shape>::support;
  for_each_bundle(block, [&](const Bundle& bundle) {
    for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
      T w[S];
      for (int i = 0; i < S; ++i) w[i] = weights.load(i, p - block.begin);
      CellStencil<Shape>::turn(points.at(Field::place)[p], T(bundle.base[0] - grid.pad), w);
      for (int i = 0; i < S; ++i) weights.store(i, p - block.begin, w[i]);
    }
  });
}

// Takes the mean stress of what the points of a block push with out of it, and pushes the cells with it. A
// lane is a cell, of four along z, as it is a node in cpu/scatter.hpp.
template <class Shape, class V, class T = number_t<V>>
void move_mean_to_cells(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                        Columns<T, 6>& push, const Cells<T>& cells) {
  using Cell = CellStencil<Shape>;
  constexpr int S = Cell::support;
  CellWeights<Shape, T> weights;  // those along z times the mean stress
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const std::size_t at = p - block.begin;
    const auto s = [&](int c) PM_INLINE { return push.template load<V>(c, at); };
    const V mean = V(T(1.0 / 3.0)) * (s(0) + s(1) + s(2));
    for (int c = 0; c < 3; ++c) push.store(c, at, s(c) - mean);
    const auto f = points.template vector<V>(Field::place, p, n);
    for (int a = 0; a < 3; ++a) {
      V w[S];
      Cell::weights(f[a], w);
      for (int i = 0; i < S; ++i) weights.store(S * a + i, at, a < 2 ? w[i] : mean * w[i]);
    }
  });
  if (grid.is_axisymmetric) turn_weights<Shape>(points, grid, block, weights);
  const typename CellsAround<Shape, T>::Steps steps(grid);
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
    CellsAround<Shape, T>(cells, steps, bundle.node).push(sum);
  });
}

// Where gather_strain takes the trace of a strain from: the points' own gradient, or the divergence that
// cells give. around(bundle).trace_at(place).put_into(strain) puts it there.
struct OwnVolume {
  PM_HD OwnVolume around(const Bundle&) const { return {}; }
  template <class V>
  PM_HD OwnVolume trace_at(const Vec3<V>&) const {
    return {};
  }
  template <class V>
  PM_HD void put_into(Sym3<V>&) const {}
};
// A trace that is known.
template <class V>
struct Trace {
  V of;
  PM_HD void put_into(Sym3<V>& strain) const {
    const V more = V(number_t<V>(1.0 / 3.0)) * (of - trace(strain));
    strain.xx += more;
    strain.yy += more;
    strain.zz += more;
  }
};
template <class Shape, class T>
class CellVolume {
  using Cell = CellStencil<Shape>;
  static constexpr int S = Cell::support;

 public:
  PM_HD CellVolume(const GridGeometry<T>& grid, const Cells<T>& cells, T dt)
      : grid_(grid), cells_(cells), steps_(grid), dt_(dt) {}

  class Around {
   public:
    PM_HD Around(const CellVolume& of, const Bundle& bundle)
        : dt_(of.dt_), inner_(T(bundle.base[0] - of.grid_.pad)), is_axisymmetric_(of.grid_.is_axisymmetric) {
      const CellsAround<Shape, T> around(of.cells_, of.steps_, bundle.node);
      if (around.all_count()) {
        first_ = around.divergence();
        x_ = of.steps_.x;
        y_ = of.steps_.y;
      } else {
        around.find_divergence(counted_);
        first_ = counted_[0][0];
        x_ = S * 4;
        y_ = 4;
      }
    }
    template <class V>
    PM_HD Trace<V> trace_at(const Vec3<V>& f) const {
      return {V(dt_) * divergence(f)};
    }

   private:
    template <class V>
    PM_HD V divergence(const Vec3<V>& f) const {
      V x[S], y[S], z[S], sum;
      Cell::weights(f.x, x);
      Cell::weights(f.y, y);
      Cell::weights(f.z, z);
      if (is_axisymmetric_) Cell::turn(f.x, inner_, x);
      for (int i = 0; i < S; ++i) {
        V plane;
        for (int j = 0; j < S; ++j) {
          const T* const row = first_ + i * x_ + j * y_;
          V line = z[0] * V(row[0]);
          for (int k = 1; k < S; ++k) line += z[k] * V(row[k]);
          plane = j == 0 ? y[0] * line : plane + y[j] * line;
        }
        sum = i == 0 ? x[0] * plane : sum + x[i] * plane;
      }
      return sum;
    }

    // The first of the cells, and how far the next one lies along x and y: in the grid, or, where not all
    // count, in a copy.
    const T* first_;
    std::size_t x_, y_;
    T counted_[S][S][4];
    T dt_, inner_;
    bool is_axisymmetric_;
  };
  PM_HD Around around(const Bundle& bundle) const { return {*this, bundle}; }

 private:
  const GridGeometry<T>& grid_;
  const Cells<T>& cells_;
  typename CellsAround<Shape, T>::Steps steps_;
  T dt_;
};

}  // namespace pockmark
