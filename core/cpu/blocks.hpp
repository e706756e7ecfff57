// Blocks of points and the bundles in them: the CPU makes them anew where points change their cells.
#pragma once
#include <algorithm>
#include <vector>

#include "../transfer.hpp"

namespace pockmark::cpu {

// Blocks, and their bundles in the same order.
struct Groups {
  std::vector<Block> blocks;
  std::vector<Bundle> bundles;
  void clear() {
    blocks.clear();
    bundles.clear();
  }
  void add(const Block& block) {
    bundles.insert(bundles.end(), block.bundles, block.bundles + block.bundle_count);
    blocks.push_back(block);
  }
  // Points blocks at their bundles anew: these may have moved in memory.
  void link(std::size_t first_block, std::size_t first_bundle) {
    const Bundle* first = bundles.data() + first_bundle;
    for (std::size_t b = first_block; b < blocks.size(); ++b) {
      blocks[b].bundles = first;
      first += blocks[b].bundle_count;
    }
  }
};

// Adds the block that begins with point p; returns where the next one begins.
template <class T>
std::size_t add_block(const Points<T>& points, const GridGeometry<T>& grid, Groups& groups, std::size_t p,
                      std::size_t end) {
  if (points.cell[p] == gone) return p + 1;
  Block block{p, p, true, 0, nullptr};
  end = std::min(end, p + Block::most);
  while (block.end < end && points.cell[block.end] != gone) {
    Bundle bundle;
    bundle.begin = block.end;
    bundle.node = points.cell[bundle.begin];
    grid.split(bundle.node, bundle.base);
    while (++block.end < end && points.cell[block.end] == bundle.node) {
    }
    bundle.end = block.end;
    groups.bundles.push_back(bundle);
    ++block.bundle_count;
  }
  unsigned differs = 0;
  for (std::size_t q = p; q < block.end; ++q) differs |= points.body[q] ^ points.body[p];
  block.one_body = differs == 0;
  groups.blocks.push_back(block);
  return block.end;
}

// Adds the blocks of the points from `begin` to before `end`.
template <class T>
void add_blocks(const Points<T>& points, const GridGeometry<T>& grid, Groups& groups, std::size_t begin,
                std::size_t end) {
  for (std::size_t p = begin; p < end;) p = add_block(points, grid, groups, p, end);
}

}  // namespace pockmark::cpu
