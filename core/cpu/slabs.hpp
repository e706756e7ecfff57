// How the CPU walks the points: slabs of grid planes, blocks of points, threads.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "../transfer.hpp"

namespace pockmark::cpu {

// Planes a slab. A slab writes to its own planes and, because points may have strayed by one since they were
// sorted and stencils are wide, to three more; so slabs of one colour (even, odd) never write to the same
// node: no atomics, and sums do not depend on the number of threads.
inline constexpr int slab_width = 8;

class Slabs {
 public:
  // Points must be sorted by cell.
  template <class T>
  void locate(const Particles<T>& points, const GridGeometry<T>& grid) {
    plane_ = grid.index(1, 0, 0);
    const int count = (grid.nodes(0) + slab_width - 1) / slab_width;
    begin_.resize(count + 1);
    for (int s = 0; s <= count; ++s) {
      const std::uint64_t first_node = std::uint64_t(s) * slab_width * plane_;
      begin_[s] = std::lower_bound(points.cell.begin(), points.cell.end(), first_node) - points.cell.begin();
    }
  }
  int count() const { return int(begin_.size()) - 1; }

  // Whether every point is still within one plane of its slab.
  template <class T>
  bool hold(const Particles<T>& points, int threads) const {
    bool all = true;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(&& : all)
    for (int s = 0; s < count(); ++s) {
      const std::uint64_t low = s == 0 ? 0 : (std::uint64_t(s) * slab_width - 1) * plane_;
      const std::uint64_t high = (std::uint64_t(s + 1) * slab_width + 1) * plane_;
      for (std::size_t p = begin_[s]; p < begin_[s + 1]; ++p)
        all = all && points.cell[p] >= low && points.cell[p] < high;
    }
    return all;
  }

  // f(slab, block) for each block; slabs in parallel. `F` may write to the points of the block only.
  template <class T, class F>
  void gather(const Particles<T>& points, const GridGeometry<T>& grid, int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int s = 0; s < count(); ++s) blocks(points, grid, s, f);
  }
  // As gather, but `F` may add to the nodes under the block.
  template <class T, class F>
  void scatter(const Particles<T>& points, const GridGeometry<T>& grid, int threads, F&& f) const {
    for (int colour = 0; colour < 2; ++colour) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
      for (int s = colour; s < count(); s += 2) blocks(points, grid, s, f);
    }
  }
  // f(slab, begin, end) over the points of each slab.
  template <class F>
  void points(int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int s = 0; s < count(); ++s) f(s, begin_[s], begin_[s + 1]);
  }

 private:
  template <class T, class F>
  void blocks(const Particles<T>& points, const GridGeometry<T>& grid, int slab, F&& f) const {
    for (std::size_t begin = begin_[slab]; begin < begin_[slab + 1]; begin += Block::most)
      f(slab, Block(points, grid, begin, std::min(begin + Block::most, begin_[slab + 1])));
  }

  std::size_t plane_ = 1;
  std::vector<std::size_t> begin_;
};

}  // namespace pockmark::cpu
