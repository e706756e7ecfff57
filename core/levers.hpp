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
#include <functional>

#include "interpolant.hpp"
#include "lever_marks.hpp"

namespace pockmark {

// What slopes along x, y and z a vector has at each node or of each cell: its change along one axis is one
// quad, so that no number changes its lane.
template <class T>
struct Slopes {
  NodeField<T, Nodal::slopes> at[3];

  PM_HD void clear(std::size_t i) const {
    for (const auto& along : at) along[i] = {};
  }
};

// What it takes. The fourth number of a lever is the mass of the node at first. Levers and sums of nodes are
// set and read in ring 3, what cells have in ring 2: the cells beside these have nothing.
template <class T>
struct Levers {
  NodeField<T, Nodal::lever> at;  // from the mass centre to the node, in cells; then what gradients multiply
  Slopes<T> cells, nodes;
  T* filling;  // of a node: its mass per space in the grid
  T* mass;     // of a cell
  LeverMarks marks;
};

// Mass centres that span less than this share of the space of their cells lie near a plane, a row or one
// place and tell no gradient: the velocity stays where it is. At corners of blocks the share lies between .1
// and .3; with a hundredth as the least, fragments of an impact are strained ever faster.
template <class T>
inline constexpr T least_span = T(0.1);

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

// A matrix.
template <class T>
struct Three {
  T at[3][3];

  PM_HD T cofactor(int r, int a) const {
    const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, a1 = (a + 1) % 3, a2 = (a + 2) % 3;
    return at[r1][a1] * at[r2][a2] - at[r1][a2] * at[r2][a1];
  }
  PM_HD T determinant() const {
    return at[0][0] * cofactor(0, 0) + at[0][1] * cofactor(0, 1) + at[0][2] * cofactor(0, 2);
  }
  // Returns the solution x of A x = b.
  PM_HD Vec3<T> solve(const Vec3<T>& b) const {
    Vec3<T> x{};
    const T per_determinant = T(1) / determinant();
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) x[a] += per_determinant * cofactor(r, a) * b[r];
    return x;
  }
};

// What is done to the nodes and cells of a row.
template <class T>
class LeverRow {
 public:
  LeverRow(const GridGeometry<T>& grid, const RowBits<T>& rows, const Levers<T>& levers, const Row& row)
      : levers_(levers), marks_(levers.marks), rows_(rows), row_(row) {
    for (int i = 0; i < 8; ++i) corner_[i] = grid.index(i >> 2, i >> 1 & 1, i & 1);
  }

  // Forgets the moments of the last step.
  void clear() const {
    for_each_node(3, [&](std::size_t node) { levers_.at[node] = {}; });
    for_each_cell(2, [&](std::size_t cell) { levers_.mass[cell] = T(0); });
  }
  // Turns moments into levers.
  void find_levers() const {
    for_each_node(3, [&](std::size_t node) {
      auto& at = levers_.at[node];
      at.set_vector(at.v[3] > least_mass<T> ? (T(-1) / at.v[3]) * at.vector() : Vec3<T>{});
    });
  }
  // Finds the slopes of the place of the mass centres in the cells, times the mass of the cell: the unit
  // matrix where they lie at the nodes. The fourth number along x is the mass.
  void find_spans() const {
    take_out_the_empty();
    for_each_cell(2, [&](std::size_t cell) {
      const T mass = levers_.mass[cell];
      set_slopes(cell, -mass, levers_.at.data);
      for (int a = 0; a < 3; ++a) levers_.cells.at[a][cell].v[a] += mass;
      levers_.cells.at[0][cell].v[3] = mass;
    });
  }
  // Ends with what a lever is to be multiplied with: the inverse of the mean of these slopes.
  void divide_by_spans() const {
    for_each_node(1, [&](std::size_t node) {
      auto& at = levers_.at[node];
      at.set_vector(per_span(node, at.vector()));
    });
  }

  // Finds the velocity gradients of the cells, times their mass.
  void find_gradients(Velocity<T> velocity) const {
    for_each_cell(2, [&](std::size_t cell) { set_slopes(cell, levers_.mass[cell], velocity.data); });
  }
  // Adds up what the cells around each node have; then what the nodes of each cell have.
  void spread() const {
    for_each_node(2, [&](std::size_t node) {
      for (int a = 0; a < 3; ++a) levers_.nodes.at[a][node] = around(node, a);
    });
  }
  void gather() const {
    for_each_cell(1, [&](std::size_t cell) {
      for (int a = 0; a < 3; ++a) levers_.cells.at[a][cell] = of_nodes(cell, a);
    });
  }
  // Carries a velocity to the nodes, with the gradients around.
  void carry(Velocity<T> velocity) const {
    for_each_node(1, [&](std::size_t node) {
      const auto lever = levers_.at[node].v;
      auto more = lever[0] * around(node, 0).v;
      more += lever[1] * around(node, 1).v;
      more += lever[2] * around(node, 2).v;
      velocity[node].v += more;
    });
  }
  // Copies what nodes have to which velocities are carried.
  void copy(Velocity<T> from, Velocity<T> to) const {
    for_each_node(1, [&](std::size_t node) { to[node] = from[node]; });
  }

  // Finds what forces do to the gradients at the nodes; then in the cells.
  void find_moments(Force<T> force) const {
    for_each_node(1, [&](std::size_t node) {
      const auto lever = levers_.at[node].v;
      for (int a = 0; a < 3; ++a) levers_.nodes.at[a][node].v = lever[a] * force[node].v;
    });
    for_each_beyond(marks_.nodes, 1, [&](std::size_t node) { levers_.nodes.clear(node); });
  }
  void gather_moments() const {
    gather();
    for_each_beyond(marks_.cells, 1, [&](std::size_t cell) { levers_.cells.clear(cell); });
  }
  // Adds up as spread() does, for the nodes of all cells.
  void spread_moments() const {
    spread();
    for_each_beyond(marks_.nodes, 2, [&](std::size_t node) { levers_.nodes.clear(node); });
  }
  // Finds what slopes in the cells the forces of their moments have.
  void find_slopes() const {
    for_each_cell(2, [&](std::size_t cell) {
      const T share = T(0.25) * levers_.mass[cell];
      const Four<T> shares{share, share, share, T(0)};
      for (int a = 0; a < 3; ++a) levers_.cells.at[a][cell].v = shares * of_nodes(cell, a).v;
    });
  }
  // Adds these forces.
  void carry_back(Force<T> force) const {
    for_each_node(3, [&](std::size_t node) {
      Quad<T> sum;
      for_each_around(node, [&](std::size_t cell, int i) {
        for (int a = 0; a < 3; ++a) {
          const auto& slope = levers_.cells.at[a][cell].v;
          if (i & 4 >> a)
            sum.v += slope;
          else
            sum.v -= slope;
        }
      });
      force[node] += sum;
    });
  }

 private:
  template <class F>
  void for_each_node(int ring, F&& f) const {
    rows_.for_each(marks_.nodes[ring], row_, f);
  }
  template <class F>
  void for_each_cell(int ring, F&& f) const {
    rows_.for_each(marks_.cells[ring], row_, f);
  }
  // Calls f for those of the next ring that are not in a ring.
  template <class F>
  void for_each_beyond(Bits* const (&of)[LeverMarks::rings], int ring, F&& f) const {
    rows_.for_each_set(row_, [&](std::size_t w) { return of[ring + 1][w] & ~of[ring][w]; }, f);
  }
  // Takes the cells without mass out of the rings. Cells around nodes that are in none have nothing.
  void take_out_the_empty() const {
    rows_.keep(marks_.cells[2], row_, [&](std::size_t cell) { return levers_.mass[cell] > T(0); });
    rows_.for_each_word(row_, [&](std::size_t w) { marks_.cells[1][w] &= marks_.cells[2][w]; });
    const auto beside = [&](std::size_t w) {
      return rows_.of_nodes(marks_.nodes[3], row_, w, std::bit_or()) & ~marks_.cells[2][w];
    };
    rows_.for_each_set(row_, beside, [&](std::size_t cell) { levers_.cells.clear(cell); });
  }
  // Calls f(cell, i) for the cells of which a node is corner i. None begins before the first node.
  template <class F>
  void for_each_around(std::size_t node, F&& f) const {
    if (row_.first >= corner_[7]) {
      for (int i = 0; i < 8; ++i) f(node - corner_[i], i);
      return;
    }
    for (int i = 0; i < 8; ++i)
      if (corner_[i] <= node) f(node - corner_[i], i);
  }
  // Returns the sum of what the cells around a node have, and the nodes of a cell, along an axis.
  Quad<T> around(std::size_t node, int axis) const {
    Quad<T> sum;
    for_each_around(node, [&](std::size_t cell, int) { sum += levers_.cells.at[axis][cell]; });
    return sum;
  }
  Quad<T> of_nodes(std::size_t cell, int axis) const {
    Quad<T> sum;
    for (const std::size_t corner : corner_) sum += levers_.nodes.at[axis][cell + corner];
    return sum;
  }
  Vec3<T> per_span(std::size_t node, const Vec3<T>& lever) const {
    Three<T> span;
    T weight{};
    for (int a = 0; a < 3; ++a) {
      const auto sum = around(node, a).v;
      for (int r = 0; r < 3; ++r) span.at[r][a] = sum[r];
      if (a == 0) weight = sum[3];
    }
    return span.determinant() > least_span<T> * weight * weight * weight ? span.solve(lever) : Vec3<T>{};
  }

  // Sets what a cell has to the mean slopes, per cell, of a nodal vector, times a factor.
  void set_slopes(std::size_t cell, T factor, const Quad<T>* nodes) const {
    const auto at = [&](int i) -> const Four<T>& { return nodes[cell + corner_[i]].v; };
    const auto a = at(0), b = at(1), c = at(2), d = at(3), e = at(4), f = at(5), g = at(6), h = at(7);
    const T share = T(0.25) * factor;
    const Four<T> shares{share, share, share, T(0)};
    levers_.cells.at[0][cell].v = shares * ((e + f + g + h) - (a + b + c + d));
    levers_.cells.at[1][cell].v = shares * ((c + d + g + h) - (a + b + e + f));
    levers_.cells.at[2][cell].v = shares * ((b + d + f + h) - (a + c + e + g));
  }

  const Levers<T>& levers_;
  const LeverMarks& marks_;
  const RowBits<T>& rows_;
  const Row& row_;
  std::size_t corner_[8];  // at the upper end of the axes whose bits it has: 4 x, 2 y, 1 z
};

// Returns what a mirror does to the slopes along an axis; the fourth number stays. `face` is the mirror, an
// upper or a lower face across `face_axis`.
template <class T>
Quad<T> mirrored_slope(Face face, int face_axis, int axis, const Quad<T>& slope) {
  const auto sign = [&](int component) {
    return T(mirror_sign(face, face_axis, component) * (axis == face_axis ? -1 : 1));
  };
  return {Four<T>{sign(0), sign(1), sign(2), T(1)} * slope.v};
}

}  // namespace pockmark
