// Moves the points, and adds their momentum for the next step while they are in the cache.
#pragma once
#include <vector>

#include "../motion.hpp"
#include "machine.hpp"

namespace pockmark {

template <class Driver, class Shape>
class Mover {
  using T = typename Driver::Number;
  using V = typename Driver::Values;

 public:
  explicit Mover(Machine<Driver>& m) : driver_(m.driver), grid_(m.model.grid) {}

  // The points that have left in the last step, of each slot.
  const std::vector<std::vector<Exit>>& exits() const { return exits_; }
  void begin_step() { exits_.assign(driver_.slots(), {}); }

  // Adds momentum and mass of the points of a block to the nodes.
  void add(const Block& block, Momentum<T> momentum) const {
    driver_.template add_carried<Shape>(block, momentum_of(driver_.points()), momentum);
  }
  // Calls move(slot, block), which returns what of_block() does, and adds the momentum of the points.
  template <class Move>
  void regroup(Move&& move, Momentum<T> momentum) {
    driver_.regroup(Shape::support, move, [&](int, const Block& block) { add(block, momentum); });
  }
  // Moves the points of a block: by a nodal velocity for a time, or by a vector that each has times a factor,
  // in cells. Returns whether one changed its cell.
  template <class By>
  bool of_block(int slot, const Block& block, const By& by, T factor) {
    return move_points<Shape, V>(driver_.points(), grid_, block, by, factor,
                                 [&](std::size_t p, int face) { exits_[slot].push_back({p, face}); });
  }

 private:
  Driver& driver_;
  const GridGeometry<T>& grid_;
  std::vector<std::vector<Exit>> exits_;
};

}  // namespace pockmark
