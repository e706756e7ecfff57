// Where velocities are carried to the nodes (levers.hpp): at those that lie beside a surface. Within a body
// mass centres lie at the nodes, but for the pattern of the points.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "grid.hpp"

namespace pockmark {

// A node has less than this share of the mass of one beside it where a surface, or a lighter body, is near:
// its mass centre lies off it by up to a cell. Numbers per mass know no frame and no unit.
template <class T>
inline constexpr T full_share = T(0.75);

// A number for each node or cell of the grid in the memory of one nodal array; a cell is called by its first
// node. Each ring has the cells around its nodes, and the nodes of the cells of the ring before.
template <class T>
struct LeverMarks {
  static constexpr int rings = 4;
  T* filling;                  // of a node: its mass per space in the grid
  std::uint8_t* nodes[rings];  // 0: beside a surface, 1: to which velocities are carried
  std::uint8_t* cells[rings];
  std::uint8_t* is_whole;  // of a cell: its nodes have mass
  std::uint8_t*
      around;  // of a node: whether it has mass; then the cells with mass in ring 2 around it, a bit each

  static LeverMarks in(NodeField<T, Nodal::cell> array, std::size_t count) {
    static_assert(sizeof(T) + 2 * rings + 2 <= sizeof(Quad<T>));
    LeverMarks marks{};
    marks.filling = reinterpret_cast<T*>(array.data);
    auto* const first = reinterpret_cast<std::uint8_t*>(marks.filling + count);
    for (int r = 0; r < rings; ++r) {
      marks.nodes[r] = first + 2 * r * count;
      marks.cells[r] = first + (2 * r + 1) * count;
    }
    marks.is_whole = first + 2 * rings * count;
    marks.around = marks.is_whole + count;
    return marks;
  }
  void clear(std::size_t begin, std::size_t end) const {
    const auto forget = [&](std::uint8_t* marks) { std::fill(marks + begin, marks + end, std::uint8_t(0)); };
    for (int r = 0; r < rings; ++r) {
      forget(nodes[r]);
      forget(cells[r]);
    }
    forget(is_whole);
    forget(around);
    std::fill(filling + begin, filling + end, T(0));
  }
};

// Calls f(i) for each that is marked.
template <class F>
void for_each_marked(const std::uint8_t* marks, std::size_t begin, std::size_t end, F&& f) {
  for (std::size_t i = begin; i < end;) {
    std::uint64_t eight;
    if (i + sizeof eight <= end) {
      std::memcpy(&eight, marks + i, sizeof eight);
      if (eight == 0) {
        i += sizeof eight;
        continue;
      }
    }
    const std::size_t stop = std::min(end, i + sizeof eight);
    for (; i < stop; ++i)
      if (marks[i]) f(i);
  }
}

// The nodes of a line, from one to before another of the same row, and the cells that begin at them.
template <class T>
struct Line {
  std::size_t begin, end, end_of_cells;
  std::size_t x, y;  // to the next node along an axis
  int first[3];

  Line(const GridGeometry<T>& grid, std::size_t begin_, std::size_t end_)
      : begin(begin_), end(end_), end_of_cells(begin_), x(grid.index(1, 0, 0)), y(grid.index(0, 1, 0)) {
    grid.split(begin, first);
    if (first[0] + 1 == grid.nodes(0) || first[1] + 1 == grid.nodes(1)) return;  // no cell begins here
    end_of_cells = std::min(end, begin + std::size_t(grid.nodes(2) - 1 - first[2]));
  }
  // Corner i of a cell lies at the upper end of the axes whose bits it has: 4 x, 2 y, 1 z.
  std::size_t corner(int i) const { return (i & 4 ? x : 0) + (i & 2 ? y : 0) + (i & 1); }
  // Returns whether every node of the line has eight cells.
  bool is_inside(const GridGeometry<T>& grid) const {
    return first[0] > 0 && first[1] > 0 && first[0] + 1 < grid.nodes(0) && first[1] + 1 < grid.nodes(1);
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

// Returns how far the mass centre of full rings lies outside of the nodes of a plane across r, in cells:
// rings that are farther out weigh more (hoop.hpp). On the axis a mirror holds it.
template <class T>
T ring_shift(const GridGeometry<T>& grid, int i) {
  const int from_axis = i - grid.pad;
  return grid.is_axisymmetric && from_axis > 0 ? T(1) / T(6 * from_axis) : T(0);
}

// Finds how full a line of nodes is, of all bodies: where two are in contact there is no surface. A node on a
// face of the grid has half of its space outside.
template <class T>
void find_filling(const GridGeometry<T>& grid, Velocity<T> velocity, const LeverMarks<T>& marks,
                  const Line<T>& line) {
  const auto on_face = [&](int axis, int i) { return i == grid.pad || i == grid.pad + grid.cells[axis]; };
  const T across = T(on_face(1, line.first[1]) ? 2 : 1) / space_across_x(grid, line.first[0]);
  for (std::size_t n = line.begin; n < line.end; ++n) {
    const T mass = velocity[n].v[3];
    marks.filling[n] = across * mass;
    marks.around[n] = mass > least_mass<T>;
  }
  if (grid.field_count > 1) {
    const std::size_t other = grid.node_count() - 2 * grid.field_of(line.begin);  // modulo 2^64: back, too
    for (std::size_t n = line.begin; n < line.end; ++n) marks.filling[n] += across * velocity[n + other].v[3];
  }
  for (const int k : {grid.pad, grid.pad + grid.cells[2]}) {
    const std::size_t n = line.begin + std::size_t(k - line.first[2]);
    if (k >= line.first[2] && n < line.end) marks.filling[n] *= T(2);
  }
}

// Marks the nodes beside a surface, and the cells that have mass at every node.
template <class T>
void mark_surface(const GridGeometry<T>& grid, const LeverMarks<T>& marks, const Line<T>& line) {
  const std::size_t x = line.x, y = line.y;
  const std::uint8_t* __restrict has = marks.around;
  std::uint8_t* __restrict whole = marks.is_whole;
  for (std::size_t c = line.begin; c < line.end_of_cells; ++c)
    whole[c] = has[c] & has[c + 1] & has[c + y] & has[c + y + 1] & has[c + x] & has[c + x + 1] &
               has[c + x + y] & has[c + x + y + 1];
  if (!line.is_inside(grid)) return;
  const int from_first = line.first[0] - grid.pad;
  const bool is_axis = grid.is_axisymmetric && from_first == 0;
  const std::size_t in = grid.is_axisymmetric && from_first <= 1 ? 0 : x, out = is_axis ? 0 : x;
  const T* __restrict m = marks.filling;
  std::uint8_t* __restrict is_beside = marks.nodes[0];
  for (std::size_t n = line.begin; n < line.end; ++n) {
    const T most = max(max(max(m[n - in], m[n + out]), max(m[n - y], m[n + y])), max(m[n - 1], m[n + 1]));
    is_beside[n] = has[n] & std::uint8_t(m[n] < full_share<T> * most);
  }
}

// Marks the whole cells around marked nodes, and the nodes of marked cells.
template <class T>
void mark_cells(const LeverMarks<T>& marks, int ring, const Line<T>& line) {
  const std::uint8_t* __restrict from = marks.nodes[ring];
  const std::uint8_t* __restrict whole = marks.is_whole;
  std::uint8_t* __restrict to = marks.cells[ring];
  const std::size_t x = line.x, y = line.y;
  for (std::size_t c = line.begin; c < line.end_of_cells; ++c)
    to[c] = whole[c] & (from[c] | from[c + 1] | from[c + y] | from[c + y + 1] | from[c + x] |
                        from[c + x + 1] | from[c + x + y] | from[c + x + y + 1]);
}
template <class T>
void mark_nodes(const GridGeometry<T>& grid, const LeverMarks<T>& marks, int ring, const Line<T>& line) {
  const std::uint8_t* __restrict from = marks.cells[ring - 1];
  std::uint8_t* __restrict to = marks.nodes[ring];
  // Before the first node of the second row of the second plane there is no corner of a cell.
  if (!line.is_inside(grid) || line.begin < line.corner(7)) {
    for (std::size_t n = line.begin; n < line.end; ++n)
      for (int i = 0; i < 8; ++i)
        if (line.corner(i) <= n) to[n] |= from[n - line.corner(i)];
    return;
  }
  const std::size_t x = line.x, y = line.y;
  for (std::size_t n = line.begin; n < line.end; ++n)
    to[n] = from[n] | from[n - 1] | from[n - y] | from[n - y - 1] | from[n - x] | from[n - x - 1] |
            from[n - x - y] | from[n - x - y - 1];
}

}  // namespace pockmark
