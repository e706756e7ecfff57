// Where velocities are carried to the nodes (levers.hpp): at those that lie beside a surface. Within a body
// mass centres lie at the nodes, but for the pattern of the points.
#pragma once
#include <functional>
#include <utility>

#include "row_bits.hpp"

namespace pockmark {

// A node has less than this share of the mass of one beside it where a surface, or a lighter body, is near:
// its mass centre lies off it by up to a cell. Numbers per mass know no frame and no unit.
template <class T>
inline constexpr T full_share = T(0.75);

// Columns of bits, a bit for each node or cell; a cell is called by its first node. Each ring has the cells
// around its nodes, and the nodes of the cells of the ring before.
struct LeverMarks {
  static constexpr int rings = 4, columns = 2 * rings + 3;
  Bits* nodes[rings];  // 0: beside a surface, 1: to which velocities are carried
  Bits* cells[rings];  // of ring 2 in the end those with mass
  Bits* has_mass;      // of a node
  Bits* is_whole;      // of a cell: its nodes have mass
  Bits* is_set;        // of a cell: it has something, of this step or one before

  // `memory` is all zero at first.
  template <class T>
  static LeverMarks in(Bits* memory, const RowBits<T>& rows) {
    LeverMarks marks{};
    Bits* next = memory + rows.margin();
    const auto column = [&] { return std::exchange(next, next + rows.margin() + rows.words()); };
    for (int r = 0; r < rings; ++r) {
      marks.nodes[r] = column();
      marks.cells[r] = column();
    }
    marks.has_mass = column();
    marks.is_whole = column();
    marks.is_set = column();
    return marks;
  }
  // Forgets what was marked; cells stay set.
  void clear(std::size_t word) const {
    for (int r = 0; r < rings; ++r) nodes[r][word] = cells[r][word] = 0;
    has_mass[word] = is_whole[word] = 0;
  }
};

// Returns the space around a node of a plane across x, per cell: half of it lies outside a face of the grid.
// That of rings is the integral of r N. At the axis it depends on where they lie: mark_surface() compares
// none there.
template <class T>
T space_across_x(const GridGeometry<T>& grid, int i) {
  const int from_first = i - grid.pad;
  const bool is_last = from_first == grid.cells[0], is_on_face = from_first == 0 || is_last;
  const T share = is_on_face ? T(0.5) : T(1);
  if (!grid.is_axisymmetric || from_first <= 0) return share;
  return share * T(from_first) - (is_last ? T(1) / T(6) : T(0));
}

// Returns how far the mass centre of full rings lies outside of the nodes of a row, in cells: rings that are
// farther out weigh more (hoop.hpp). On the axis a mirror holds it.
template <class T>
T ring_shift(const GridGeometry<T>& grid, const Row& row) {
  const int from_axis = row.i - grid.pad;
  return grid.is_axisymmetric && from_axis > 0 ? T(1) / T(6 * from_axis) : T(0);
}

// Finds how full the nodes of a row are. A node on a face of the grid has half of its space outside.
template <class T>
void find_filling(const GridGeometry<T>& grid, Velocity<T> velocity, T* filling, const Row& row) {
  const auto on_face = [&](int axis, int i) { return i == grid.pad || i == grid.pad + grid.cells[axis]; };
  const T across = T(on_face(1, row.j) ? 2 : 1) / space_across_x(grid, row.i);
  for (int k = row.begin; k < row.end; ++k) filling[row.first + k] = across * velocity[row.first + k].v[3];
  for (const int k : {grid.pad, grid.pad + grid.cells[2]})
    if (k >= row.begin && k < row.end) filling[row.first + k] *= T(2);
}

// Finds which nodes of a row have mass.
template <class T>
void mark_mass(Velocity<T> velocity, Bits* has_mass, const Row& row) {
  Bits* const words = has_mass + row.word;
  for (int k = row.begin; k < row.end; ++k)
    words[k / 64] |= Bits(pockmark::has_mass(velocity, row.first + k)) << (k % 64);
}
// Finds the cells of a row that have mass at every node.
template <class T>
void mark_whole(const RowBits<T>& rows, const Bits* has_mass, Bits* is_whole, const Row& row) {
  rows.for_each_word(row,
                     [&](std::size_t w) { is_whole[w] = rows.of_nodes(has_mass, row, w, std::bit_and()); });
}

// Marks the nodes of a row that lie beside a surface: those lighter than one of the six beside them.
template <class V, class T = number_t<V>>
void mark_surface(const GridGeometry<T>& grid, const T* filling, const LeverMarks& marks, const Row& row) {
  if (!row.is_inside) return;
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0);
  const int from_axis = grid.is_axisymmetric ? row.i - grid.pad : 2;
  const std::size_t in = from_axis > 1 ? x : 0, out = from_axis > 0 ? x : 0;
  constexpr int width = Pack<V>::width;
  Bits* const beside = marks.nodes[0] + row.word;
  for (int k = row.begin / width * width; k < row.end; k += width) {
    const T* const own = filling + row.first + k;
    const auto m = [](const T* at) PM_INLINE { return Pack<V>::load(at); };
    const V most =
        max(max(max(m(own - in), m(own + out)), max(m(own - y), m(own + y))), max(m(own - 1), m(own + 1)));
    beside[k / 64] |= Bits(bits_of(m(own) < V(full_share<T>) * most)) << (k % 64);
  }
  const Bits* const has_mass = marks.has_mass + row.word;
  for (int w = 0; w <= (row.end - 1) / 64; ++w) beside[w] &= has_mass[w];
}

// Marks the whole cells around marked nodes, and the nodes of marked cells.
template <class T>
void mark_cells(const RowBits<T>& rows, const LeverMarks& marks, int ring, const Row& row) {
  rows.for_each_word(row, [&](std::size_t w) {
    marks.cells[ring][w] = marks.is_whole[w] & rows.of_nodes(marks.nodes[ring], row, w, std::bit_or());
  });
}
template <class T>
void mark_nodes(const RowBits<T>& rows, const LeverMarks& marks, int ring, const Row& row) {
  rows.for_each_word(
      row, [&](std::size_t w) { marks.nodes[ring][w] = rows.of_cells(marks.cells[ring - 1], row, w); });
}

// Takes out the nodes that two velocity fields share: contact decides of the velocity there, and what is
// carried from it would lie beyond.
template <class T>
void take_out_shared(const GridGeometry<T>& grid, const RowBits<T>& rows, const LeverMarks& marks, int ring,
                     const Row& row) {
  if (grid.field_count < 2) return;
  rows.for_each_word(
      row, [&](std::size_t w) { marks.nodes[ring][w] &= ~marks.has_mass[rows.in_other_field(row, w)]; });
}

}  // namespace pockmark
