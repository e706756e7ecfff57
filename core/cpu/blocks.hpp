// Points in blocks, and blocks in runs: which the CPU makes anew where points change their cells.
#pragma once
#include <algorithm>
#include <vector>

#include "../transfer.hpp"

namespace pockmark::cpu {

// Blocks, and their runs in the same order.
struct Groups {
  std::vector<Block> blocks;
  std::vector<Run> runs;
  void clear() {
    blocks.clear();
    runs.clear();
  }
  void add(const Block& block) {
    runs.insert(runs.end(), block.runs, block.runs + block.run_count);
    blocks.push_back(block);
  }
  // The runs may have moved in memory.
  void link(std::size_t first_block, std::size_t first_run) {
    const Run* first = runs.data() + first_run;
    for (std::size_t b = first_block; b < blocks.size(); ++b) {
      blocks[b].runs = first;
      first += blocks[b].run_count;
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
    Run run;
    run.begin = block.end;
    run.node = points.cell[run.begin];
    grid.split(run.node, run.base);
    while (++block.end < end && points.cell[block.end] == run.node) {
    }
    run.end = block.end;
    groups.runs.push_back(run);
    ++block.run_count;
  }
  unsigned differs = 0;
  for (std::size_t q = p; q < block.end; ++q) differs |= points.body[q] ^ points.body[p];
  block.one_body = differs == 0;
  groups.blocks.push_back(block);
  return block.end;
}

// Splits points into blocks.
template <class T>
void add_blocks(const Points<T>& points, const GridGeometry<T>& grid, Groups& groups, std::size_t begin,
                std::size_t end) {
  for (std::size_t p = begin; p < end;) p = add_block(points, grid, groups, p, end);
}

}  // namespace pockmark::cpu
