// Volumetric strain by cells: what cells take from nodes, and give them (docs/theory.md, Volumetric strain).
// A cell is called by its first node.
#pragma once
#include <algorithm>
#include <cstdint>

#include "hoop.hpp"

namespace pockmark {

// What the cells of the grid have, a number for each node: a column each in the memory of one nodal array.
// Cells along z lie side by side. Where four are read or written as one, the last may be of no cell.
template <class T>
struct Cells {
  T* push;                      // what points push the cell with, J / Model::mass_unit
  T* divergence;                // of the velocity at the centre, 1/s
  std::uint8_t* is_whole;       // 1 if all nodes of the cell have mass, or 0
  std::uint8_t* is_surrounded;  // 1 if the cell and the 26 around it are whole, or 0

  // The first of the four columns stays zero: a node at the edge finds nothing in front of the first cell.
  static Cells in(NodeField<T, Nodal::cell> array, std::size_t nodes) {
    T* const first = reinterpret_cast<T*>(array.data);
    auto* const bytes = reinterpret_cast<std::uint8_t*>(first + 3 * nodes);
    return {first + nodes, first + 2 * nodes, bytes, bytes + nodes};
  }
  // Gives a cell behind a mirror what its image has.
  void mirror(std::size_t behind, std::size_t image) const {
    divergence[behind] = divergence[image];
    is_whole[behind] = is_whole[image];
  }
};

// Returns where a line of nodes that are the first of a cell ends.
template <class T>
std::size_t end_of_cells(const GridGeometry<T>& grid, std::size_t end) {
  return std::min(end, grid.field_count * grid.node_count() - grid.index(1, 1, 1));
}

// Finds which cells of a line are whole.
template <class T>
void find_whole(const GridGeometry<T>& grid, Velocity<T> velocity, const Cells<T>& cells, std::size_t begin,
                std::size_t end) {
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0);
  const auto level = [&](std::size_t node) PM_INLINE {
    const auto mass = [&](std::size_t i) PM_INLINE { return velocity[i].v[3]; };
    return min(min(mass(node), mass(node + y)), min(mass(node + x), mass(node + x + y)));
  };
  end = end_of_cells(grid, end);
  if (begin >= end) return;
  T lower = level(begin);
  for (std::size_t cell = begin; cell < end; ++cell) {
    const T upper = level(cell + 1);
    cells.is_whole[cell] = min(lower, upper) > least_mass<T>;
    lower = upper;
  }
}

// Finds which cells of a line are surrounded by whole ones, when all are found. A turn of the loop does 64 of
// them, whatever lies behind the last: two columns of numbers have room for more bytes than there are.
template <class T>
void find_surrounded(const GridGeometry<T>& grid, const Cells<T>& cells, std::size_t begin, std::size_t end) {
  constexpr std::size_t most = 64, more = 16;
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0), around = x + y + 1;
  begin = std::max(begin, around);
  end = std::min(end, grid.field_count * grid.node_count() - around);
  for (; begin < end; begin += most) {
    std::uint8_t across[most + more], all[most];  // across: of the nine cells across z, from one before
    std::fill(across, across + most + more, std::uint8_t(1));
    for (int n = 0; n < 9; ++n) {
      const std::uint8_t* const whole = cells.is_whole + (begin - around) + n / 3 * x + n % 3 * y;
      for (std::size_t k = 0; k < most + more; ++k) across[k] &= whole[k];
    }
    for (std::size_t k = 0; k < most; ++k) all[k] = across[k] & across[k + 1] & across[k + 2];
    std::copy(all, all + std::min(end - begin, most), cells.is_surrounded + begin);
  }
}

// Finds the divergence at the centres of a line of cells, and takes what they were pushed with. A cell adds
// up what the four nodes at its lower end along z and those at its upper end give.
template <class Shape, class T>
void find_divergence(const GridGeometry<T>& grid, Velocity<T> velocity, const Cells<T>& cells,
                     std::size_t begin, std::size_t end) {
  const std::size_t x = grid.index(1, 0, 0), y = grid.index(0, 1, 0);
  end = end_of_cells(grid, end);
  if (begin >= end) return;
  const auto [hoop, lean] = cell_turn<Shape>(grid, begin);
  const T inner = T(1) - hoop, outer = T(1) + hoop, inner_z = T(1) - T(2) * lean,
          outer_z = T(1) + T(2) * lean, scale = T(0.25) * grid.per_metre;
  struct Level {
    T across, along;
  };
  const auto level = [&](std::size_t node) PM_INLINE {
    const auto &a = velocity[node].v, &b = velocity[node + y].v;
    const auto &c = velocity[node + x].v, &d = velocity[node + x + y].v;
    return Level{outer * (c[0] + d[0]) - inner * (a[0] + b[0]) + ((b[1] + d[1]) - (a[1] + c[1])),
                 outer_z * (c[2] + d[2]) + inner_z * (a[2] + b[2])};
  };
  Level lower = level(begin);
  for (std::size_t cell = begin; cell < end; ++cell) {
    const Level upper = level(cell + 1);
    cells.divergence[cell] = scale * ((lower.across + upper.across) + (upper.along - lower.along));
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
    force[node].v += scale * Four<T>{lower.x + upper.x, lower.y + upper.y, lower.z - upper.z, T(0)};
    lower = upper;
  }
}

}  // namespace pockmark
