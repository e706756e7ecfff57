// The velocity of a node is the mean of its points', by mass: that of their mass centre, which beside a
// surface does not lie at the node. These kernels carry it from there to the node with the velocity gradient
// around, so that a velocity that is linear in space has its own values at the nodes; and take forces back,
// the transpose (docs/theory.md, Velocities at the nodes). With trilinear functions only: a bundle is a cell,
// which is called by its first node.
//
// A node takes the gradient from the cells of its cells' nodes, four an axis with the weights 1, 3, 3, 1:
// from cells to nodes, to cells, to nodes, a sum over eight each time. The cells at a surface alone would not
// do: what little mass lies in them may lie so close together that no gradient can be told.
#pragma once
#include <cmath>
#include <functional>

#include "interpolant.hpp"
#include "lever_marks.hpp"
#include "slopes.hpp"

namespace pockmark {

// What it takes. The fourth number of a lever is the mass of the node at first. Levers are set and read in
// ring 3, what cells have in ring 2: no other cell has anything.
template <class T>
struct Levers {
  NodeField<T, Nodal::lever> at;  // from the mass centre to the node, in cells; then what gradients multiply
  T* filling;                     // of a node: its mass per space in the grid
  T* mass;                        // of a cell
  Slopes<T>* own;                 // of a cell
  Slopes<T>* wide;                // sums over the cells around it
  LeverMarks marks;

  // How many cells without anything lie in memory before the first one.
  static std::size_t margin(const GridGeometry<T>& grid) { return grid.index(1, 1, 1); }
};

// Mass centres that span less than this share of the space of their cells lie near a plane, a row or one
// place and tell no gradient: the velocity stays where it is. At corners of blocks the share lies between .1
// and .3; with a hundredth as the least, fragments of an impact are strained ever faster.
template <class T>
inline constexpr T least_span = T(0.1);

// A lever over the span is at most as long, in cells. At faces of blocks it is up to 1, at edges and corners
// up to 2.5. Where mass centres lie close together along one direction it would grow with the noise of their
// velocities: in rings that collide at 4.5 km/s the energy of points fell below zero, and the step to
// nothing.
template <class T>
inline constexpr T longest_lever = T(2);

// Adds the moments of a bundle's mass about its nodes, sum N m (x - X), in cells, and the mass, to the nodes.
// mass(p) is the mass of a point that counts. Returns the mass of the bundle.
template <class T, class Mass>
T add_moments(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, Mass&& mass,
              NodeField<T, Nodal::lever> moments) {
  Patch<Linear<T>, T> patch;
  T sum = 0;
  for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
    const auto f = points.vector(Field::place, p);
    const Stencil<Linear<T>, T> n(f, T(1));
    const T m = mass(p);
    sum += m;
    patch.for_each([&](int i, int j, int k) {
      add_scaled(patch.at[i][j][k], m * n.weight(i, j, k),
                 Quad<T>{{f.x - T(i), f.y - T(j), f.z - T(k), T(1)}});
    });
  }
  patch.add_to(grid, bundle, moments);
  return sum;
}

// What is done to the nodes and cells of a row. Where eight are added up, the four at either end along z are
// one sum for two that follow one another.
template <class T>
class LeverRow {
 public:
  LeverRow(const GridGeometry<T>& grid, const RowBits<T>& rows, const Levers<T>& levers, const Row& row)
      : levers_(levers),
        marks_(levers.marks),
        rows_(rows),
        row_(row),
        x_(grid.index(1, 0, 0)),
        y_(grid.index(0, 1, 0)) {}

  // Forgets the moments of the last step.
  void clear() const {
    rows_.for_each(marks_.nodes[3], row_, [&](std::size_t node) { levers_.at[node] = {}; });
    rows_.for_each(marks_.cells[2], row_, [&](std::size_t cell) { levers_.mass[cell] = T(0); });
  }
  // Turns moments into levers.
  void find_levers() const {
    rows_.for_each(marks_.nodes[3], row_, [&](std::size_t node) {
      auto& at = levers_.at[node];
      at.set_vector(at.v[3] > least_mass<T> ? (T(-1) / at.v[3]) * at.vector() : Vec3<T>{});
    });
  }
  // Finds the slopes of the place of the mass centres in the cells, times the mass of the cell: the unit
  // matrix where they lie at the nodes. The fourth number along x is the mass.
  void find_spans() const {
    take_out_the_empty();
    find_slopes(levers_.at.data, [&](std::size_t cell, const Slopes<T>& slopes) {
      const T mass = levers_.mass[cell];
      auto& own = levers_.own[cell] = shares_of(-mass) * slopes;
      for (int a = 0; a < 3; ++a) own.along[a].v[a] += mass;
      own.along[0].v[3] = mass;
    });
  }
  // Ends with what a lever is to be multiplied with: the inverse of the mean of these slopes. Of how far the
  // mass centres of rings lie off the nodes within a body, too, nothing is carried.
  void divide_by_spans(const GridGeometry<T>& grid) const {
    const Vec3<T> within{ring_shift(grid, row_), T(0), T(0)};
    add_around([&](std::size_t node, const Slopes<T>& sum) {
      auto& at = levers_.at[node];
      at.set_vector(per_span(sum, at.vector() + within));
    });
    for_each_beyond(marks_.nodes, 1, [&](std::size_t node) { levers_.at[node] = {}; });
  }

  // Finds the velocity gradients of the cells, times their mass.
  void find_gradients(Velocity<T> velocity) const {
    find_slopes(velocity.data, [&](std::size_t cell, const Slopes<T>& slopes) {
      levers_.own[cell] = shares_of(levers_.mass[cell]) * slopes;
    });
  }
  // Adds up what the cells around each cell have: one, two and one along each axis, which is the sum over its
  // nodes of the sums over their cells.
  void widen() const {
    widen(1, [&](std::size_t cell, const Slopes<T>& sum) { levers_.wide[cell] = sum; });
  }
  // Carries a velocity to the nodes, with the gradients around. What they had is kept.
  void carry(Velocity<T> velocity, Velocity<T> kept) const {
    add_around([&](std::size_t node, const Slopes<T>& sum) {
      kept[node] = velocity[node];
      const auto lever = levers_.at[node].v;
      for (int a = 0; a < 3; ++a) velocity[node].v += lever[a] * sum.along[a].v;
    });
  }
  void put_back(Velocity<T> kept, Velocity<T> velocity) const {
    rows_.for_each(marks_.nodes[1], row_, [&](std::size_t node) { velocity[node] = kept[node]; });
  }

  // Finds what forces do to the gradients of the cells.
  void find_moments(Force<T> force) const {
    const auto across = [&](std::size_t first) PM_INLINE {
      Slopes<T> sum;
      for (const std::size_t node : {first, first + y_, first + x_, first + x_ + y_}) {
        const auto lever = levers_.at[node].v;
        for (int a = 0; a < 3; ++a) add_scaled(sum.along[a], lever[a], force[node]);
      }
      return sum;
    };
    rows_.for_each_run(marks_.cells[1], row_, [&](std::size_t begin, std::size_t end) {
      Slopes<T> lower = across(begin);
      for (std::size_t cell = begin; cell < end; ++cell) {
        const Slopes<T> upper = across(cell + 1);
        levers_.own[cell] = lower + upper;
        lower = upper;
      }
    });
    for_each_beyond(marks_.cells, 1, [&](std::size_t cell) { levers_.own[cell] = {}; });
  }
  // Adds them up as widen() does, for more cells, and finds the slopes that their forces have.
  void widen_moments() const {
    widen(2, [&](std::size_t cell, const Slopes<T>& sum) {
      levers_.wide[cell] = shares_of(levers_.mass[cell]) * sum;
    });
  }
  // Adds these forces.
  void carry_back(Force<T> force) const {
    struct Level {
      Quad<T> across, along;
    };
    const auto level = [&](Place upper) PM_INLINE {
      const auto* const wide = levers_.wide + upper;
      const auto &a = (wide - x_ - y_)->along, &b = (wide - x_)->along, &c = (wide - y_)->along,
                 &d = wide->along;
      return Level{{(a[0].v + b[0].v) - (c[0].v + d[0].v) + ((a[1].v + c[1].v) - (b[1].v + d[1].v))},
                   {(a[2].v + b[2].v) + (c[2].v + d[2].v)}};
    };
    rows_.for_each_run(marks_.nodes[3], row_, [&](std::size_t begin, std::size_t end) {
      Level lower = level(Place(begin) - 1);
      for (std::size_t node = begin; node < end; ++node) {
        const Level upper = level(Place(node));
        force[node].v += (lower.across.v + upper.across.v) + (lower.along.v - upper.along.v);
        lower = upper;
      }
    });
  }

 private:
  using Place = std::ptrdiff_t;  // of a cell: those before the first have room, too, and are zero

  // Calls f for those of the next ring that are not in a ring.
  template <class F>
  void for_each_beyond(Bits* const (&of)[LeverMarks::rings], int ring, F&& f) const {
    rows_.for_each_set(row_, [&](std::size_t w) { return of[ring + 1][w] & ~of[ring][w]; }, f);
  }
  // Takes the cells without mass out of the rings. Cells that were in them have nothing any more.
  void take_out_the_empty() const {
    rows_.keep(marks_.cells[2], row_, [&](std::size_t cell) { return levers_.mass[cell] > T(0); });
    rows_.for_each_word(row_, [&](std::size_t w) { marks_.cells[1][w] &= marks_.cells[2][w]; });
    const auto left = [&](std::size_t w) { return marks_.is_set[w] & ~marks_.cells[2][w]; };
    rows_.for_each_set(row_, left, [&](std::size_t cell) { levers_.own[cell] = levers_.wide[cell] = {}; });
    rows_.for_each_word(row_, [&](std::size_t w) { marks_.is_set[w] = marks_.cells[2][w]; });
  }
  // Returns what slopes, four times too large, are multiplied with. The fourth number is no part of them.
  static Quad<T> shares_of(T mass) {
    const T share = T(0.25) * mass;
    return Quad<T>{{share, share, share, T(0)}};
  }
  // Calls f(cell, slopes) for the cells of ring 2, with four times the mean slopes, per cell, of a vector
  // that the nodes have.
  template <class F>
  void find_slopes(const Quad<T>* nodes, F&& f) const {
    const auto level = [&](std::size_t node) PM_INLINE {
      const auto &a = nodes[node].v, &b = nodes[node + y_].v, &c = nodes[node + x_].v,
                 &d = nodes[node + x_ + y_].v;
      return Slopes<T>{{{(c + d) - (a + b)}, {(b + d) - (a + c)}, {(a + b) + (c + d)}}};
    };
    rows_.for_each_run(marks_.cells[2], row_, [&](std::size_t begin, std::size_t end) {
      Slopes<T> lower = level(begin);
      for (std::size_t cell = begin; cell < end; ++cell) {
        const Slopes<T> upper = level(cell + 1);
        Slopes<T> slopes = lower + upper;
        slopes.along[2].v = upper.along[2].v - lower.along[2].v;
        f(cell, slopes);
        lower = upper;
      }
    });
  }
  // Calls f(cell, sum) for the cells of a ring.
  template <class F>
  void widen(int ring, F&& f) const {
    const auto line = [&](const Slopes<T>* own) PM_INLINE { return twice(*own) + (*(own - y_) + own[y_]); };
    const auto across = [&](Place cell) PM_INLINE {
      const auto* const own = levers_.own + cell;
      return twice(line(own)) + (line(own - x_) + line(own + x_));
    };
    rows_.for_each_run(marks_.cells[ring], row_, [&](std::size_t begin, std::size_t end) {
      Slopes<T> lower = across(Place(begin) - 1), own = across(Place(begin));
      for (std::size_t cell = begin; cell < end; ++cell) {
        const Slopes<T> upper = across(Place(cell) + 1);
        f(cell, twice(own) + (lower + upper));
        lower = own;
        own = upper;
      }
    });
  }
  static Slopes<T> twice(const Slopes<T>& a) { return a + a; }
  // Calls f(node, sum) for the nodes of ring 1, with what the cells around have.
  template <class F>
  void add_around(F&& f) const {
    const auto across = [&](Place cell) PM_INLINE {
      const auto* const wide = levers_.wide + cell;
      return (*wide + *(wide - y_)) + (*(wide - x_) + *(wide - x_ - y_));
    };
    rows_.for_each_run(marks_.nodes[1], row_, [&](std::size_t begin, std::size_t end) {
      Slopes<T> lower = across(Place(begin) - 1);
      for (std::size_t node = begin; node < end; ++node) {
        const Slopes<T> upper = across(Place(node));
        f(node, lower + upper);
        lower = upper;
      }
    });
  }
  static Vec3<T> per_span(const Slopes<T>& sum, const Vec3<T>& lever) {
    Three<T> span;
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) span.at[r][a] = sum.along[a].v[r];
    const T weight = sum.along[0].v[3];
    if (!(span.determinant() > least_span<T> * weight * weight * weight)) return Vec3<T>{};
    const auto at = span.solve(lever);
    const T length = weight * std::sqrt(dot(at, at));
    return longest_lever<T> < length ? (longest_lever<T> / length) * at : at;
  }

  const Levers<T>& levers_;
  const LeverMarks& marks_;
  const RowBits<T>& rows_;
  const Row& row_;
  std::ptrdiff_t x_, y_;  // to the next node along an axis
};

}  // namespace pockmark
