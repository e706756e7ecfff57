// The plain driver: one loop after another, a point at a time, in the order in which the points came. It is
// what the CPU's driver is held against, and the shortest way to see what a driver must do.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "../levers.hpp"

namespace pockmark::plain {

template <class T>
class Driver {
 public:
  using Number = T;
  using Values = T;
  using Hints = NoHints;
  static constexpr const char* name = "plain";

  Driver(int, bool, bool) {}  // neither threads nor sleep

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

  int slots() const { return 1; }
  bool is_awake(int) const { return true; }
  template <class F>
  void for_each_block(F&& f) const {
    for (std::size_t p = 0; p < points_.count; ++p) with_block(p, f);
  }
  template <class F>
  void for_each_awake_block(F&& f) const {
    for_each_block(f);
  }
  template <class F>
  void scatter(F&& f) const {
    for_each_block(f);
  }
  template <class F>
  void scatter_all(F&& f) const {
    for_each_block(f);
  }
  template <class F, class G>
  void regroup(int, F&& moved, G&& then) {
    for (std::size_t p = 0; p < points_.count; ++p) {
      with_block(p, moved);
      with_block(p, then);
    }
  }
  template <class F>
  void for_each_line(bool, F&& f) const {
    const std::size_t row = grid_.index(0, 1, 0), all = grid_.field_count * grid_.node_count();
    for (std::size_t first = 0; first < all; first += row) f(0, first, first + row);
  }
  template <class F>
  void for_each_slot(F&& f) const {
    f(0);
  }
  template <class F>
  void for_each_pair(int rows, int columns, F&& f) const {
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) f(i, j);
  }
  template <Nodal quantity>
  void exchange(NodeField<T, quantity>) const {}

  template <class Shape>
  void add_carried(const Block& block, const Carried<T>& carried, Momentum<T> momentum) const {
    pockmark::add_carried<Shape>(points_, grid_, block.bundles[0], carried, momentum);
  }
  template <class Shape>
  void add_force(const Block& block, const Columns<T, 6>& push, Force<T> force) const {
    add_internal_force<Shape>(points_, grid_, block, push, block.bundles[0], force);
  }
  template <class Mass>
  T add_moments(const Bundle& bundle, Mass&& mass, NodeField<T, Nodal::lever> moments) const {
    return pockmark::add_moments(points_, grid_, bundle, mass, moments);
  }

  void forget_stale() {}
  void sort(int) {}
  bool arrange(int, bool) { return false; }
  void rouse() {}
  void wake() {}
  template <class F>
  void for_each_part(F&& f, int) {
    store_.for_each_part(f);
    if constexpr (!std::remove_cvref_t<F>::restores) return;
    if (!store_.is_whole()) throw std::invalid_argument("points: arrays of different lengths");
    points_ = store_.view();
  }

  std::int64_t sorts() const { return 0; }
  std::size_t sleeping_points() const { return 0; }
  std::size_t point_bytes() const { return points_.count * (component_count * sizeof(T) + 9); }
  std::size_t node_bytes() const { return buffers_[0].size() * buffers_.size() * sizeof(Quad<T>); }

 private:
  // Calls f(slot, block) for a block of one point, unless it is gone.
  template <class F>
  void with_block(std::size_t p, F&& f) const {
    if (points_.cell[p] == gone) return;
    Bundle bundle{std::uint32_t(p), std::uint32_t(p + 1), points_.cell[p], {}};
    grid_.split(bundle.node, bundle.base);
    f(0, Block{p, p + 1, true, 1, &bundle});
  }

  GridGeometry<T> grid_;
  PointStore<T> store_;
  Points<T> points_{};
  std::vector<Array<Quad<T>>> buffers_;
};

}  // namespace pockmark::plain
