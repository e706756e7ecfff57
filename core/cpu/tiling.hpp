// How the nodes of the grid are cut into tiles, seen along z: a tile has four planes (nodes along x) and
// eight rows (along y), and every node along z.
//
//   y (rows)
//   24 +-----+-----+-----+
//      |  0  |  2  |  0  |     The number in a tile is its colour. Tiles of one colour are worked on at the
//   16 +-----+-----+-----+     same time, one colour after another.
//      |  1  |  3  |  1  |
//    8 +-----+-----+-----+
//      |  0  |  2  |  0  |
//    0 +-----+-----+-----+
//      0     4     8    12     x (planes)
//
// The tile whose first plane and row are 0 writes to the planes -1 .. 6 and the rows -1 .. 10: its points may
// have strayed by one since they were sorted, and a stencil adds two nodes after its first. So neighbours
// share nodes. Two tiles of one colour do not: the next one begins at plane 8 or row 16, and writes from 7 or
// 15 on. No write needs an atomic operation, and no sum depends on the number of threads.
#pragma once
#include <algorithm>
#include <array>

namespace pockmark::cpu {

struct Tiling {
  static constexpr int planes = 4, rows = 8;

  std::array<int, 3> nodes{};
  int along = 1, across = 1;  // tiles along x, along y

  Tiling() = default;
  explicit Tiling(const std::array<int, 3>& nodes_)
      : nodes(nodes_), along((nodes_[0] + planes - 1) / planes), across((nodes_[1] + rows - 1) / rows) {}

  int count() const { return along * across; }
  int colour(int t) const { return t / across % 2 * 2 + t % across % 2; }
  int first_plane(int t) const { return t / across * planes; }
  int end_plane(int t) const { return std::min(first_plane(t) + planes, nodes[0]); }
  int first_row(int t) const { return t % across * rows; }
  int end_row(int t) const { return std::min(first_row(t) + rows, nodes[1]); }

  // Returns whether a stencil that begins at a plane and a row is within one of both of tile t.
  bool reaches(int t, int plane, int row) const {
    return plane >= first_plane(t) - 1 && plane <= first_plane(t) + planes && row >= first_row(t) - 1 &&
           row <= first_row(t) + rows;
  }
  // Calls f(plane, row) for each of tile t.
  template <class F>
  void for_each_row(int t, F&& f) const {
    for (int i = first_plane(t); i < end_plane(t); ++i)
      for (int j = first_row(t); j < end_row(t); ++j) f(i, j);
  }
  // Calls f(tile) for tile t and those around it, up to some along x and along y.
  template <class F>
  void for_each_neighbour(int t, F&& f, int x = 1, int y = 1) const {
    const int a = t / across, b = t % across;
    for (int i = std::max(a - x, 0); i <= std::min(a + x, along - 1); ++i)
      for (int j = std::max(b - y, 0); j <= std::min(b + y, across - 1); ++j) f(i * across + j);
  }
};

}  // namespace pockmark::cpu
