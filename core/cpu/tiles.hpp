// How the CPU walks points and nodes: the blocks and bundles of points in each tile of the grid (tiling.hpp),
// and the threads that work on them.
#pragma once
#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "blocks.hpp"
#include "tiling.hpp"

namespace pockmark::cpu {

class Tiles {
 public:
  // Points must be sorted by cell.
  template <class T>
  void locate(const Points<T>& points, const GridGeometry<T>& grid) {
    tiling_ = Tiling({grid.nodes(0), grid.nodes(1), grid.nodes(2)});
    tiles_.resize(tiling_.count());
    begin_.assign(grid.field_count * tiling_.nodes[0] * tiling_.across + 1, points.count);
    for (std::size_t field = 0; field < grid.field_count; ++field)
      for (int i = 0; i < tiling_.nodes[0]; ++i)
        for (int t = 0; t < tiling_.across; ++t) {
          const std::uint64_t first_node = field * grid.node_count() + grid.index(i, t * Tiling::rows, 0);
          begin_[stretch(field, i, t)] =
              std::lower_bound(points.cell, points.cell + points.count, first_node) - points.cell;
        }
  }
  int count() const { return int(tiles_.size()); }

  // The order of the points as a checkpoint keeps it: the blocks, tile by tile, and which tiles rest. A sum
  // over points depends on it. The bundles follow from the cells of the points.
  struct Order {
    std::vector<std::uint32_t> blocks;  // of each tile, how many
    std::vector<std::uint32_t> begin, end;
    std::vector<std::uint8_t> rest;  // of each tile: 1 if it rests, 2 if it sleeps, 4 if it idles
  };
  Order order() const {
    Order order;
    for (const Tile& tile : tiles_) {
      order.blocks.push_back(std::uint32_t(tile.blocks.size()));
      order.rest.push_back(std::uint8_t(tile.rests + 2 * tile.sleeps + 4 * tile.idles));
      for (const Block& block : tile.blocks) {
        order.begin.push_back(std::uint32_t(block.begin));
        order.end.push_back(std::uint32_t(block.end));
      }
    }
    return order;
  }
  // Puts the order back. Throws std::invalid_argument if it is none of these points and this grid.
  template <class T>
  void restore(const Order& order, const Points<T>& points, const GridGeometry<T>& grid, int support) {
    locate(points, grid);
    std::size_t b = 0;
    if (order.blocks.size() != tiles_.size() || order.rest.size() != tiles_.size() ||
        order.begin.size() != order.end.size())
      throw std::invalid_argument("the blocks are not those of this grid");
    for (int t = 0; t < count(); ++t) {
      Tile& tile = tiles_[t] = {};
      for (std::uint32_t i = 0; i < order.blocks[t]; ++i, ++b) {
        if (b >= order.begin.size() || order.begin[b] >= order.end[b] || order.end[b] > points.count)
          throw std::invalid_argument("a block holds points that there are not");
        add_blocks(points, grid, tile, order.begin[b], order.end[b]);
      }
      tile.rests = order.rest[t] & 1;
      tile.sleeps = order.rest[t] & 2;
      tile.idles = order.rest[t] & 4;
      tile.link(0, 0);
      find_touched(tile, support);
    }
    renew_spans();
  }

  // Splits the points of every tile into blocks and bundles. Points that are gone are in none.
  template <class T>
  void split(const Points<T>& points, const GridGeometry<T>& grid, int support, int threads) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t) split_tile(points, grid, support, t);
  }
  // Finds which nodes the tiles touch from now on. To be called once a step, after points have moved.
  void renew_spans() {
    for (int t = 0; t < count(); ++t) {
      Span all;
      tiling_.for_each_neighbour(t, [&](int u) { all.cover(tiles_[u].touched); });
      tiles_[t].stale.cover(tiles_[t].active);
      tiles_[t].active = all;
    }
  }
  void forget_stale() {
    for (auto& tile : tiles_)
      if (!tile.idles) tile.stale = {};
  }
  std::size_t bundle_count() const {
    std::size_t sum = 0;
    for (const auto& tile : tiles_) sum += tile.bundles.size();
    return sum;
  }

  // Returns whether every point is still within a plane and a row of its tile.
  bool hold() const {
    return std::none_of(tiles_.begin(), tiles_.end(), [](const Tile& tile) { return tile.astray; });
  }

  // A tile sleeps while its points and those of its neighbours rest: no node that it touches can move. Where
  // velocities are carried to the nodes (levers.hpp) what moves before a step does so up to nine planes or
  // rows farther after it, by levers that take the points of three more: `far` asks it of the neighbours up
  // to three planes of tiles and two rows. Asks rests(tile) of the tiles that have rested until now, of all
  // at the start. Returns whether one fell asleep or woke.
  template <class F>
  bool send_to_sleep(bool start, bool far, F&& rests) {
    bool changed = false;
    for (int t = 0; t < count(); ++t)
      if (start || (tiles_[t].rests && !tiles_[t].sleeps)) tiles_[t].rests = rests(t);
    for (int t = 0; t < count(); ++t) {
      bool all = true;
      const auto ask = [&](int u) { all = all && tiles_[u].rests; };
      tiling_.for_each_neighbour(t, ask, far ? 3 : 1, far ? 2 : 1);
      changed = changed || tiles_[t].sleeps != all;
      tiles_[t].sleeps = all;
    }
    for (int t = 0; t < count(); ++t) {
      bool all = true;
      tiling_.for_each_neighbour(t, [&](int u) { all = all && tiles_[u].sleeps; });
      tiles_[t].idles = all;
    }
    return changed;
  }
  void wake() {
    for (auto& tile : tiles_) tile.rests = tile.sleeps = tile.idles = false;
  }
  bool sleeps(int t) const { return tiles_[t].sleeps; }

  template <class F>
  void for_each_block(int t, F&& f) const {
    for (const Block& block : tiles_[t].blocks) f(t, block);
  }
  // Calls f(tile, block) for each block, of sleeping tiles too; tiles in parallel.
  template <class F>
  void visit(int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t) for_each_block(t, f);
  }
  // Calls f(tile, block) for each block that is awake; tiles in parallel. `F` may write to the points of the
  // block only.
  template <class F>
  void gather(int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t)
      if (!sleeps(t)) for_each_block(t, f);
  }
  // Does as gather does, but `F` may add to the nodes under the block.
  template <class F>
  void scatter(int threads, F&& f) const {
    by_colour(threads, [&](int t) { for_each_block(t, f); });
  }
  // Does as scatter does, for the blocks of sleeping tiles too.
  template <class F>
  void scatter_all(int threads, F&& f) const {
    by_colour(threads, [&](int t) { for_each_block(t, f); }, true);
  }
  // Does as scatter does, where moved(tile, block) may move the points of a block and says whether one
  // changed its cell: then its points are split again. then(tile, block) may add to the nodes under the
  // blocks that result.
  template <class T, class F, class G>
  void regroup(const Points<T>& points, const GridGeometry<T>& grid, int support, int threads, F&& moved,
               G&& then) {
    by_colour(threads, [&](int t) { regroup_tile(points, grid, support, t, moved, then); });
  }

  // Calls f(tile, first node, end) over the nodes of each tile that points touch, line by line; `stale`: or
  // touched before. Without the nodes that only sleeping points touch.
  template <class T, class F>
  void for_each_line(const GridGeometry<T>& grid, int threads, bool stale, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t) {
      if (tiles_[t].idles) continue;
      Span span = tiles_[t].active;
      if (stale) span.cover(tiles_[t].stale);
      if (span.begin >= span.end) continue;  // empty
      for (std::size_t field = 0; field < grid.field_count; ++field) {
        const std::size_t first = field * grid.node_count();
        tiling_.for_each_row(t, [&](int i, int j) {
          f(t, first + grid.index(i, j, span.begin), first + grid.index(i, j, span.end));
        });
      }
    }
  }
  // Calls f(tile) for those over whose nodes for_each_line walks.
  template <class F>
  void for_each_tile(int threads, F&& f) const {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int t = 0; t < count(); ++t)
      if (!tiles_[t].idles) f(t);
  }

 private:
  // Nodes along z.
  struct Span {
    int begin = INT32_MAX, end = INT32_MIN;
    void cover(const Span& other) {
      begin = std::min(begin, other.begin);
      end = std::max(end, other.end);
    }
  };
  struct Tile : Groups {
    Span touched;        // by its own points
    Span active, stale;  // by its points and those of its neighbours, in this step and before
    bool rests = false, sleeps = false, idles = false;  // idles: it and its neighbours sleep
    bool astray = false;                                // a point is farther than a plane or a row away
  };

  // Calls f(tile) for each that is awake, or for all; a colour's in parallel.
  template <class F>
  void by_colour(int threads, F&& f, bool all = false) const {
    for (int colour = 0; colour < 4; ++colour) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
      for (int t = 0; t < count(); ++t)
        if ((all || !sleeps(t)) && tiling_.colour(t) == colour) f(t);
    }
  }

  template <class T>
  void split_tile(const Points<T>& points, const GridGeometry<T>& grid, int support, int t) {
    Tile& tile = tiles_[t];
    tile.clear();
    tile.astray = false;
    // The points of a tile are consecutive in each plane of each velocity field.
    for (std::size_t field = 0; field < grid.field_count; ++field)
      for (int i = tiling_.first_plane(t); i < tiling_.end_plane(t); ++i) {
        const std::size_t at = stretch(field, i, t % tiling_.across);
        add_blocks(points, grid, tile, begin_[at], begin_[at + 1]);
      }
    tile.link(0, 0);
    find_touched(tile, support);
  }
  template <class T, class F, class G>
  void regroup_tile(const Points<T>& points, const GridGeometry<T>& grid, int support, int t, F&& moved,
                    G&& then) {
    thread_local Groups fresh;
    fresh.clear();
    Tile& tile = tiles_[t];
    bool changed = false;
    for (const Block& old : tile.blocks) {
      const std::size_t first_block = fresh.blocks.size(), first_bundle = fresh.bundles.size();
      if (!moved(t, old)) {
        fresh.add(old);
        then(t, old);
        continue;
      }
      changed = true;
      add_blocks(points, grid, fresh, old.begin, old.end);
      fresh.link(first_block, first_bundle);
      for (std::size_t b = first_block; b < fresh.blocks.size(); ++b) {
        if (within_reach(t, fresh.blocks[b]))
          then(t, fresh.blocks[b]);
        else
          tile.astray = true;
      }
    }
    if (!changed) return;
    std::swap(static_cast<Groups&>(tile), fresh);
    tile.link(0, 0);
    find_touched(tile, support);
  }
  // Returns whether the points of a block are within a plane and a row of tile t.
  bool within_reach(int t, const Block& block) const {
    return std::all_of(block.bundles, block.bundles + block.bundle_count, [&](const Bundle& bundle) {
      return tiling_.reaches(t, bundle.base[0], bundle.base[1]);
    });
  }
  void find_touched(Tile& tile, int support) const {
    tile.touched = {};
    if (tile.bundles.empty()) return;
    for (const Bundle& bundle : tile.bundles) tile.touched.cover({bundle.base[2], bundle.base[2] + support});
    // The image behind a mirror lies two nodes from the farthest node that it shows.
    tile.touched.begin = std::max(tile.touched.begin - 2, 0);
    tile.touched.end = std::min(tile.touched.end + 2, tiling_.nodes[2]);
  }
  // Returns where begin_ has the points of a velocity field, a plane and a tile along y.
  std::size_t stretch(std::size_t field, int plane, int t) const {
    return (field * tiling_.nodes[0] + plane) * tiling_.across + t;
  }

  Tiling tiling_;
  std::vector<Tile> tiles_;
  std::vector<std::size_t> begin_;  // see stretch
};

}  // namespace pockmark::cpu
