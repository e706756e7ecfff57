// What a driver must do for the method: hold the points and the nodes, and walk over them. The method
// (core/method/) knows no threads, tiles or lanes; the kernels (transfer.hpp, stress.hpp, motion.hpp) are
// functions of views.
#pragma once
#include <concepts>
#include <cstdint>

#include "transfer.hpp"

namespace pockmark {

// Stands for any function that the method hands to a driver.
struct AnyCall {
  static constexpr bool restores = false;
  template <class... Given>
  bool operator()(Given&&...) const {
    return true;
  }
};

// What the method leaves in a slot shares nothing with another slot. A driver may hand a function the same
// slot again and again, from one thread at a time.
template <class D, class T = typename D::Number, class Shape = Linear<T>>
concept IsDriver = requires(D d, const GridGeometry<T>& grid, std::size_t count, const Block& block,
                            const Columns<T, 6>& push, const Carried<T>& carried, Momentum<T> momentum,
                            Force<T> force, int n, bool is_so, AnyCall f) {
  // Memory: n arrays of nodes, all zero at first; `count` points.
  d.allocate(grid, n);
  d.reserve(count);
  d.resize(count);
  { d.points() } -> std::convertible_to<const Points<T>&>;
  { d.template nodes<Nodal::force>(n) } -> std::same_as<Force<T>>;
  // Reductions: a loop leaves a partial result in each of `slots()`.
  { d.slots() } -> std::same_as<int>;
  { d.is_awake(n) } -> std::same_as<bool>;
  // Calls f(slot, block) over blocks of points, where f writes to the points of its block only: of all
  // points, or without those that a driver knows to be at rest.
  d.for_each_block(f);
  d.for_each_awake_block(f);
  // The same, where f may add to the nodes under its block.
  d.scatter(f);
  d.scatter_all(f);
  // moved(slot, block) may move the points of its block and says whether one changed its cell; then(slot,
  // block) may add to the nodes under the blocks that result.
  d.regroup(n, f, f);
  // Calls f(slot, first node, end) over the nodes that points touch, or touched before the last clear
  // (`stale`).
  d.for_each_line(is_so, f);
  d.forget_stale();
  // Calls f(slot) for the slots of these nodes.
  d.for_each_slot(f);
  // Calls f(i, j) for i < rows, j < columns.
  d.for_each_pair(n, n, f);
  // Adds up what other memories have put on nodes that they share.
  d.exchange(force);
  // What a block adds to its nodes.
  d.template add_carried<Shape>(block, carried, momentum);
  d.template add_force<Shape>(block, push, force);
  // What a bundle adds to them for levers: see pockmark::add_moments.
  { d.add_moments(*block.bundles, f, NodeField<T, Nodal::lever>{}) } -> std::same_as<T>;
  // Order: sort() for shape functions with that support; arrange() after each step, `is_so` after the
  // first one. It says whether sums over points may now have another order, or other points be awake.
  d.sort(n);
  { d.arrange(n, is_so) } -> std::same_as<bool>;
  // To be called where points may move or be strained between two steps.
  d.rouse();
  d.wake();
};

}  // namespace pockmark
