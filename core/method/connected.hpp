// Which points are connected to others: those that are solid, and those that are not, for they have failed or
// opened to a vapour, where their cells are at least half full. The rest are free to fly.
#pragma once
#include <vector>

#include "../hoop.hpp"
#include "lines.hpp"
#include "machine.hpp"

namespace pockmark {

// No solid opens to this V/V0: spall parts it at some hundredths.
template <class T>
inline constexpr T vapour_ratio = T(1.5);

template <class Driver, class Shape>
class Connected {
  using T = typename Driver::Number;
  using V = typename Driver::Values;

 public:
  explicit Connected(Machine<Driver>& m) : model_(m.model), driver_(m.driver), grid_(m.model.grid) {}

  // Looks for them; `nodes` is an array that is free.
  void find(Momentum<T> nodes) {
    is_.assign(driver_.points().count, T(1));
    if (!has_loose_points()) return;
    find_filling(nodes);
    driver_.for_each_awake_block([&](int, const Block& block) {
      Columns<T, 3> filling;
      gather_values<Shape, V>(driver_.points(), block, filling,
                              [&](auto& patch, const Bundle& bundle) { patch.load(grid_, bundle, nodes); });
      for (std::size_t p = block.begin; p < block.end; ++p)
        is_[p] = T(!is_loose(p) || T(0.5) <= filling.at[0][p - block.begin]);
    });
  }
  bool has(std::size_t p) const { return is_[p] > T(0); }
  // Returns which of the n points from p on are.
  mask_t<V> among(std::size_t p, int n) const {
    return V(0) < Pack<V>::load(is_.data() + p, n) && first_lanes<V>(n);
  }

 private:
  bool is_loose(std::size_t p) const {
    const auto& points = driver_.points();
    return T(1) <= points.at(Field::damage)[p] || vapour_ratio<T> - T(1) < points.at(Field::dilation)[p];
  }
  bool has_loose_points() const {
    std::vector<std::uint8_t> found(driver_.slots());
    driver_.for_each_awake_block([&](int slot, const Block& block) {
      for (std::size_t p = block.begin; p < block.end; ++p)
        if (is_loose(p)) found[slot] = 1;
    });
    return std::ranges::any_of(found, [](std::uint8_t one) { return one != 0; });
  }
  // Finds which share of the space around a node the points would fill at their first density.
  void find_filling(Momentum<T> nodes) const {
    clear_nodes(driver_, nodes);
    driver_.scatter([&](int, const Block& block) {
      Columns<T, 1> share, one;
      for (std::size_t p = block.begin; p < block.end; ++p) {
        share.store(0, p - block.begin, T(model_.reference_volume(driver_.points(), p) / space(p)));
        one.store(0, p - block.begin, T(1));
      }
      const Carried<T> carried{share.at[0], {one.at[0], one.at[0], one.at[0]}, block.begin};
      driver_.template add_carried<Shape>(block, carried, nodes);
    });
    driver_.exchange(nodes);
    fold(driver_, grid_, model_.faces, nodes, Mirrored::magnitudes);
    // On a mirror half of the space is behind it.
    for (int face = 0; face < 6; ++face)
      if (is_mirror(model_.faces[face]))
        for_each_face_node(driver_, grid_, face, [&](const FaceNode& at) {
          nodes[at.on].set_vector(T(2) * nodes[at.on].vector());
        });
    constrain(driver_, grid_, model_.faces, nodes, Mirrored::magnitudes);
  }
  // Returns the space of a cell, m^3, of a ring's around the axis.
  double space(std::size_t p) const {
    const double cell = grid_.cell;
    return cell * cell * (grid_.is_axisymmetric ? circumference(grid_, driver_.points(), p) : cell);
  }

  const Model<T>& model_;
  Driver& driver_;
  const GridGeometry<T>& grid_;
  std::vector<T> is_;
};

}  // namespace pockmark
