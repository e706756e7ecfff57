// Volumetric strain by cells: what cells take from nodes, and give them (docs/theory.md, Volumetric strain).
// A cell is called by its first node.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "hoop.hpp"

namespace pockmark {

// What the cells of the grid have, a number for each node: a column each in the memory of one nodal array.
// Cells along z lie side by side. Where four are read or written as one, the last may be of no cell.
template <class T>
struct Cells {
  T* push;                 // what points push the cell with, J / Model::mass_unit
  T* divergence;           // of the velocity at the centre, 1/s
  std::uint8_t* is_whole;  // 1 if all nodes of the cell have mass, or 0

  // The first of the four columns stays zero: a node at the edge finds nothing in front of the first cell.
  static Cells in(NodeField<T, Nodal::cell> array, std::size_t nodes) {
    T* const first = reinterpret_cast<T*>(array.data);
    return {first + nodes, first + 2 * nodes, reinterpret_cast<std::uint8_t*>(first + 3 * nodes)};
  }
  // Gives a cell behind a mirror what its image has.
  void mirror(std::size_t behind, std::size_t image) const {
    divergence[behind] = divergence[image];
    is_whole[behind] = is_whole[image];
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
    cells.divergence[cell] = scale * ((lower.across + upper.across) + (upper.along - lower.along));
    cells.is_whole[cell] = min(lower.mass, upper.mass) > least_mass<T>;
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

}  // namespace pockmark
