// The CPU's driver: points in the order of the cells, blocks of them in tiles, threads, SIMD lanes.
#pragma once
#include <cstdint>
#include <vector>

#include "../motion.hpp"
#include "prefetch.hpp"
#include "scatter.hpp"
#include "sort.hpp"
#include "tiles.hpp"

namespace pockmark::cpu {

// Does what core/driver.hpp asks of a driver. `V` is what the kernels compute with: a pack of numbers, or a
// number.
template <class T, class V>
class Driver {
 public:
  using Number = T;
  using Values = V;
  using Hints = Prefetch<Pack<V>::width>;
  static constexpr const char* name = "cpu";

  // `far`: whether a step moves points farther off than a tile (Tiles::send_to_sleep).
  Driver(int threads, bool sleeps, bool far) : threads_(threads), may_sleep_(sleeps), far_(far) {}

  void allocate(const GridGeometry<T>& grid, int arrays) {
    grid_ = grid;
    buffers_.resize(arrays);
    for (auto& buffer : buffers_) buffer.assign(grid.field_count * grid.node_count(), {});
  }
  void reserve(std::size_t count) { store_.reserve(count); }
  void resize(std::size_t count) {
    store_.resize(count);
    points_ = store_.view();
  }
  const Points<T>& points() const { return points_; }
  template <Nodal quantity>
  NodeField<T, quantity> nodes(int buffer) {
    return {buffers_[buffer].data()};
  }

  // A slot is a tile. Its results are added up in the order of the tiles, so that no sum depends on the
  // number of threads.
  int slots() const { return tiles_.count(); }
  bool is_awake(int slot) const { return !tiles_.sleeps(slot); }
  template <class F>
  void for_each_block(F&& f) const {
    tiles_.visit(threads_, f);
  }
  template <class F>
  void for_each_awake_block(F&& f) const {
    tiles_.gather(threads_, f);
  }
  template <class F>
  void scatter(F&& f) const {
    tiles_.scatter(threads_, f);
  }
  template <class F>
  void scatter_all(F&& f) const {
    tiles_.scatter_all(threads_, f);
  }
  template <class F, class G>
  void regroup(int support, F&& moved, G&& then) {
    tiles_.regroup(points_, grid_, support, threads_, moved, then);
  }
  template <class F>
  void for_each_line(bool stale, F&& f) const {
    tiles_.for_each_line(grid_, threads_, stale, f);
  }
  template <class F>
  void for_each_slot(F&& f) const {
    tiles_.for_each_tile(threads_, f);
  }
  template <class F>
  void for_each_pair(int rows, int columns, F&& f) const {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) f(i, j);
  }
  template <Nodal quantity>
  void exchange(NodeField<T, quantity>) const {}  // one memory: every sum is whole

  template <class Shape>
  void add_carried(const Block& block, const Carried<T>& carried, Momentum<T> momentum) const {
    scatter_carried<Shape, V>(points_, grid_, block, carried, momentum);
  }
  template <class Shape>
  void add_force(const Block& block, const Columns<T, 6>& push, Force<T> force) const {
    scatter_force<Shape, V>(points_, grid_, block, push, force);
  }
  template <class Mass>
  T add_moments(const Bundle& bundle, Mass&& mass, NodeField<T, Nodal::lever> moments) const {
    return scatter_moments<V>(points_, grid_, bundle, mass, moments);
  }

  void forget_stale() { tiles_.forget_stale(); }
  void sort(int support) {
    sorter_(store_, grid_.field_count * grid_.node_count(), threads_);
    points_ = store_.view();
    tiles_.locate(points_, grid_);
    tiles_.split(points_, grid_, support, threads_);
    tiles_.renew_spans();
    sorted_bundles_ = std::int64_t(tiles_.bundle_count());
    disorder_ = 0;
    ++sorts_;
  }
  // Sorts the points by cell again when that pays: once the bundles that disorder has added since the last
  // sort have cost as much, summed over the steps. Sorts also when a point has strayed too far from its tile.
  bool arrange(int support, bool is_start) {
    tiles_.renew_spans();
    disorder_ += std::max(std::int64_t(tiles_.bundle_count()) - sorted_bundles_, std::int64_t(0));
    const bool sorts = points_per_bundle_cost * disorder_ > std::int64_t(points_.count) || !tiles_.hold();
    if (sorts) sort(support);
    return send_to_sleep(is_start) || sorts;
  }
  void rouse() { send_to_sleep(false); }
  void wake() { tiles_.wake(); }

  // See Machine::for_each_part.
  template <class F>
  void for_each_part(F&& f, int support) {
    store_.for_each_part(f);
    f("order.sorted_runs", sorted_bundles_);
    f("order.disorder", disorder_);
    f("order.sorts", sorts_);
    auto order = tiles_.order();
    f("order.blocks", order.blocks);
    f("order.begin", order.begin);
    f("order.end", order.end);
    f("order.rest", order.rest);
    if constexpr (!std::remove_cvref_t<F>::restores) return;
    if (!store_.is_whole()) throw std::invalid_argument("points: arrays of different lengths");
    points_ = store_.view();
    tiles_.restore(order, points_, grid_, support);
  }

  std::int64_t sorts() const { return sorts_; }
  std::size_t sleeping_points() const {
    std::size_t sum = 0;
    for (int tile = 0; tile < tiles_.count(); ++tile)
      if (tiles_.sleeps(tile))
        tiles_.for_each_block(tile, [&](int, const Block& block) { sum += block.end - block.begin; });
    return sum;
  }
  // Return the bytes of the points (fields, body, id, cell; the sort's scratch; bundles) and of the nodes.
  std::size_t point_bytes() const {
    const std::size_t one = component_count * sizeof(T) + 9;
    return points_.count * (one + sizeof(T) + 9) + tiles_.bundle_count() * sizeof(Bundle);
  }
  std::size_t node_bytes() const { return buffers_[0].size() * (buffers_.size() * sizeof(Quad<T>) + 4); }

 private:
  static constexpr std::int64_t points_per_bundle_cost =
      3;  // what a bundle costs in a step, in points sorted

  bool send_to_sleep(bool is_start) {
    return may_sleep_ && tiles_.send_to_sleep(is_start, far_, [&](int tile) { return rests(tile); });
  }
  bool rests(int tile) const {
    bool all = true;
    tiles_.for_each_block(tile,
                          [&](int, const Block& block) { all = all && pockmark::rests(points_, block); });
    return all;
  }

  int threads_;
  bool may_sleep_, far_;
  GridGeometry<T> grid_;
  PointStore<T> store_;
  Points<T> points_{};
  std::vector<Array<Quad<T>>> buffers_;
  Tiles tiles_;
  Sorter<T> sorter_;
  std::int64_t sorted_bundles_ = 0, disorder_ = 0, sorts_ = 0;
};

}  // namespace pockmark::cpu
