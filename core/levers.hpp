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
#include <algorithm>
#include <bit>
#include <cmath>

#include "boundary.hpp"
#include "interpolant.hpp"
#include "lever_marks.hpp"

namespace pockmark {

// Three rows of three numbers at each node, or of each cell.
template <class T>
struct Rows {
  NodeField<T, Nodal::rows> at[3];

  PM_HD void set(std::size_t i, int r, const Vec3<T>& row) const { at[r][i].set_vector(row); }
  PM_HD Vec3<T> row(std::size_t i, int r) const { return at[r][i].vector(); }
};

// What it takes. The fourth number of a lever is the mass of the node, of a cell's second row that of the
// cell. A cell without mass has no say. Only what is marked is ever set or read: levers and sums of nodes in
// ring 3, masses and rows of cells in ring 2.
template <class T>
struct Levers {
  NodeField<T, Nodal::lever> at;  // from the mass centre to the node, in cells; then what gradients multiply
  Rows<T> cells, nodes;
  LeverMarks<T> marks;

  PM_HD T mass(std::size_t cell) const { return cells.at[1][cell].v[3]; }
  PM_HD void set_mass(std::size_t cell, T mass) const { cells.at[1][cell].v[3] = mass; }
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

// Adds the moments of a bundle's mass about its nodes, sum N m (x - X), in cells, and the mass, to nodes and
// cell. mass(p) is the mass of a point that counts.
template <class T, class Mass>
void add_moments(const Points<T>& points, const GridGeometry<T>& grid, const Bundle& bundle, Mass&& mass,
                 const Levers<T>& levers) {
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
  patch.add_to(grid, bundle, levers.at);
  levers.set_mass(bundle.node, levers.mass(bundle.node) + sum);
}

// A matrix, and its inverse.
template <class T>
struct Three {
  T at[3][3];

  PM_HD Vec3<T> row(int r) const { return {at[r][0], at[r][1], at[r][2]}; }
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

// What is done to a line of nodes and cells.
template <class T>
class LeverLine {
 public:
  LeverLine(const Levers<T>& levers, const Line<T>& line)
      : levers_(levers), marks_(levers.marks), line_(line) {}

  // Forgets the moments of the last step.
  void clear() const {
    for_each_node(3, [&](std::size_t node) { levers_.at[node] = {}; });
    for_each_cell(2, [&](std::size_t cell) { levers_.set_mass(cell, T(0)); });
  }
  // Turns moments into levers.
  void find_levers() const {
    for_each_node(3, [&](std::size_t node) {
      auto& at = levers_.at[node];
      at.set_vector(at.v[3] > least_mass<T> ? (T(-1) / at.v[3]) * at.vector() : Vec3<T>{});
    });
  }
  // Finds the slopes of the place of the mass centres in the cells, times the mass of the cell: the unit
  // matrix where they lie at the nodes. The fourth number of the first row is the mass.
  void find_spans() const {
    for_each_cell(2, [&](std::size_t cell) {
      const T mass = levers_.mass(cell);
      if (!(mass > T(0))) marks_.cells[2][cell] = 0;
      set_slopes(cell, -mass, levers_.at.data);
      for (int r = 0; r < 3; ++r) levers_.cells.at[r][cell].v[r] += mass;
      levers_.cells.at[0][cell].v[3] = mass;
    });
  }
  // Finds which cells around each node have mass.
  void look_around() const {
    for_each_node(3, [&](std::size_t node) {
      unsigned bits = 0;
      for (int i = 0; i < 8; ++i)
        if (line_.corner(i) <= node) bits |= unsigned(marks_.cells[2][node - line_.corner(i)]) << i;
      marks_.around[node] = std::uint8_t(bits);
    });
  }
  // Ends with what a lever is to be multiplied with: the inverse of the mean of these slopes. `shift` is how
  // far mass centres lie off the nodes along x within a body, too: of that nothing is carried.
  void divide_by_spans(T shift) const {
    for_each_node(3, [&](std::size_t node) {
      auto& at = levers_.at[node];
      const Vec3<T> lever = at.vector() + Vec3<T>{shift, T(0), T(0)};
      at.set_vector(marks_.nodes[1][node] ? per_span(node, lever) : Vec3<T>{});
    });
  }

  // Finds the velocity gradients of the cells, times their mass.
  void find_gradients(Velocity<T> velocity) const {
    for_each_cell(2, [&](std::size_t cell) { set_slopes(cell, levers_.mass(cell), velocity.data); });
  }
  // Finds what forces do to the gradients.
  void find_moments(Force<T> force) const {
    for_each_cell(2, [&](std::size_t cell) {
      Quad<T> sum[3];
      for (int i = 0; i < 8; ++i) {
        const std::size_t node = cell + line_.corner(i);
        for (int r = 0; r < 3; ++r) add_scaled(sum[r], force[node].v[r], levers_.at[node]);
      }
      for (int r = 0; r < 3; ++r) levers_.cells.set(cell, r, sum[r].vector());
    });
  }
  // Adds up what the cells around each node have; then what the nodes of each cell have. The nodes of the
  // last ring have nothing of their own to give.
  void spread() const {
    for_each_node(3, [&](std::size_t node) {
      Quad<T> sum[3];
      if (marks_.nodes[2][node]) add_around(node, sum);
      for (int r = 0; r < 3; ++r) levers_.nodes.at[r][node] = sum[r];
    });
  }
  void gather(int ring) const {
    for_each_cell(ring, [&](std::size_t cell) {
      Quad<T> sum[3];
      for (int i = 0; i < 8; ++i)
        for (int r = 0; r < 3; ++r) sum[r] += levers_.nodes.at[r][cell + line_.corner(i)];
      for (int r = 0; r < 3; ++r) levers_.cells.set(cell, r, sum[r].vector());
      levers_.cells.at[0][cell].v[3] = sum[0].v[3];
    });
  }
  // Carries a velocity to the nodes, with the gradients around.
  void carry(Velocity<T> from, Velocity<T> to) const {
    std::copy(from.data + line_.begin, from.data + line_.end, to.data + line_.begin);
    for_each_node(1, [&](std::size_t node) {
      Quad<T> rows[3];
      add_around(node, rows);
      const auto lever = levers_.at[node].vector();
      for (int r = 0; r < 3; ++r) to[node].v[r] += dot(rows[r].vector(), lever);
    });
  }
  // Adds what moments of the cells, times their mass, are as forces.
  void carry_back(Force<T> force) const {
    for_each_node(3, [&](std::size_t node) {
      Vec3<T> sum{};
      for_each_cell_around(node, [&](std::size_t cell, int i) {
        const T share = T(0.25) * levers_.mass(cell);
        const Vec3<T> slope{side(i, 4) * share, side(i, 2) * share, side(i, 1) * share};
        for (int r = 0; r < 3; ++r) sum[r] += dot(levers_.cells.row(cell, r), slope);
      });
      force[node].set_vector(force[node].vector() + sum);
    });
  }

 private:
  static T side(int i, int bit) { return i & bit ? T(1) : T(-1); }

  template <class F>
  void for_each_node(int ring, F&& f) const {
    for_each_marked(marks_.nodes[ring], line_.begin, line_.end, f);
  }
  template <class F>
  void for_each_cell(int ring, F&& f) const {
    for_each_marked(marks_.cells[ring], line_.begin, line_.end_of_cells, f);
  }
  // Calls f(cell, i) for the cells with mass of which a node is corner i.
  template <class F>
  void for_each_cell_around(std::size_t node, F&& f) const {
    for (unsigned bits = marks_.around[node]; bits != 0; bits &= bits - 1) {
      const int i = std::countr_zero(bits);
      f(node - line_.corner(i), i);
    }
  }
  void add_around(std::size_t node, Quad<T> (&sum)[3]) const {
    for_each_cell_around(node, [&](std::size_t cell, int) {
      for (int r = 0; r < 3; ++r) sum[r] += levers_.cells.at[r][cell];
    });
  }
  Vec3<T> per_span(std::size_t node, const Vec3<T>& lever) const {
    Quad<T> sum[3];
    add_around(node, sum);
    Three<T> span;
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) span.at[r][a] = sum[r].v[a];
    const T weight = sum[0].v[3];
    if (!(span.determinant() > least_span<T> * weight * weight * weight)) return Vec3<T>{};
    const auto at = span.solve(lever);
    const T length = weight * std::sqrt(dot(at, at));
    return longest_lever<T> < length ? (longest_lever<T> / length) * at : at;
  }

  // Sets the rows of a cell to the mean slopes, per cell, of a nodal vector, times a factor.
  void set_slopes(std::size_t cell, T factor, const Quad<T>* nodes) const {
    const auto at = [&](int i) -> const Four<T>& { return nodes[cell + line_.corner(i)].v; };
    const auto a = at(0), b = at(1), c = at(2), d = at(3), e = at(4), f = at(5), g = at(6), h = at(7);
    const auto x = (e + f + g + h) - (a + b + c + d), y = (c + d + g + h) - (a + b + e + f),
               z = (b + d + f + h) - (a + c + e + g);
    const T share = T(0.25) * factor;
    for (int r = 0; r < 3; ++r) levers_.cells.set(cell, r, {share * x[r], share * y[r], share * z[r]});
  }

  const Levers<T>& levers_;
  const LeverMarks<T>& marks_;
  const Line<T>& line_;
};

// What a mirror does to the rows of a cell: r is a component of what is mirrored, as `face` does it, a an
// axis.
template <class T>
Vec3<T> mirrored_row(Face face, int face_axis, int r, Vec3<T> row) {
  row[face_axis] = -row[face_axis];
  return T(mirror_sign(face, face_axis, r)) * row;
}

}  // namespace pockmark
