// How the CPU walks the points: tiles of the grid, seen along z, of four planes by eight rows; threads.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "../transfer.hpp"

namespace pockmark::cpu {

class Tiles {
 public:
  // A tile writes to its own planes and rows and, because points may have strayed by one since they were
  // sorted and stencils are wide, to one before and two after the strayed ones. With four or more of each,
  // tiles of one colour (even or odd in x and in y) never write to the same node: no atomics, and sums do not
  // depend on the number of threads.
  static constexpr int planes = 4, rows = 8;

  // Points must be sorted by cell.
  template <class T>
  void locate(const Particles<T>& points, const GridGeometry<T>& grid) {
    across_ = (grid.nodes(1) + rows - 1) / rows;
    count_ = (grid.nodes(0) + planes - 1) / planes * across_;
    begin_.assign(grid.nodes(0) * across_ + 1, points.size());
    for (int i = 0; i < grid.nodes(0); ++i)
      for (int t = 0; t < across_; ++t) {
        const std::uint64_t first_node = grid.index(i, t * rows, 0);
        begin_[i * across_ + t] =
            std::lower_bound(points.cell.begin(), points.cell.end(), first_node) - points.cell.begin();
      }
  }
  int count() const { return count_; }

  // Whether every point is still within a plane and a row of its tile.
  template <class T>
  bool hold(const Particles<T>& points, const GridGeometry<T>& grid, int threads) const {
    std::int64_t strayed = 0;
#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(+ : strayed)
    for (int t = 0; t < count(); ++t) {
      const int plane = t / across_ * planes, row = t % across_ * rows;
      for_each_stretch(t, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          int at[3];
          grid.split(points.cell[p], at);
          strayed += at[0] < plane - 1 || at[0] > plane + planes || at[1] < row - 1 || at[1] > row + rows;
        }
      });
    }
    return strayed == 0;
  }

  // f(tile, block) for each block; tiles in parallel. `F` may write to the points of the block only.
  template <class T, class F>
  void gather(const Particles<T>& points, const GridGeometry<T>& grid, int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t) blocks(points, grid, t, f);
  }
  // As gather, but `F` may add to the nodes under the block.
  template <class T, class F>
  void scatter(const Particles<T>& points, const GridGeometry<T>& grid, int threads, F&& f) const {
    for (int colour = 0; colour < 4; ++colour) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
      for (int t = 0; t < count(); ++t)
        if (t / across_ % 2 * 2 + t % across_ % 2 == colour) blocks(points, grid, t, f);
    }
  }
  // f(tile, begin, end) over the points of each tile, a stretch at a time.
  template <class F>
  void points(int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t)
      for_each_stretch(t, [&](std::size_t begin, std::size_t end) { f(t, begin, end); });
  }

 private:
  // The points of a tile are consecutive plane by plane.
  template <class F>
  void for_each_stretch(int tile, F&& f) const {
    const std::size_t last = begin_.size() - 1;
    for (int i = 0; i < planes; ++i) {
      const std::size_t at = std::size_t(tile / across_ * planes + i) * across_ + tile % across_;
      if (at < last && begin_[at] < begin_[at + 1]) f(begin_[at], begin_[at + 1]);
    }
  }
  template <class T, class F>
  void blocks(const Particles<T>& points, const GridGeometry<T>& grid, int tile, F&& f) const {
    for_each_stretch(tile, [&](std::size_t stretch, std::size_t end) {
      for (std::size_t begin = stretch; begin < end; begin += Block::most)
        f(tile, Block(points, grid, begin, std::min(begin + Block::most, end)));
    });
  }

  int across_ = 1, count_ = 0;
  std::vector<std::size_t> begin_;  // of each plane and tile along y
};

}  // namespace pockmark::cpu
