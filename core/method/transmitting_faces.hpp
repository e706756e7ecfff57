// The transmitting faces during a run: the damping of their nodes, and the energy that they take.
#pragma once
#include <algorithm>
#include <stdexcept>

#include "../grid_update.hpp"
#include "model.hpp"

namespace pockmark {

template <class T>
class TransmittingFaces {
 public:
  Anchorage& anchorage() { return anchorage_; }

  // Returns whether the areas are to be found anew: the points behind the faces may have moved by so much. It
  // must not depend on how the points lie in memory: runs that mirror each other would differ.
  bool renews(const GridGeometry<T>& grid, std::int64_t cycle) const {
    return cycle == 0 || way_ > way_per_area * double(grid.cell);
  }
  template <class Shape, class Driver>
  void renew(const Model<T>& model, const Driver& driver, Damping<T> damping) {
    const auto& grid = model.grid;
    way_ = 0;
    std::fill_n(damping.data, grid.field_count * grid.node_count(), Quad<T>{});
    const auto view = anchorage_.view();
    driver.scatter_all([&](int, const Block& block) {
      for_each_bundle(block, [&](const Bundle& bundle) {
        add_damping<Shape>(driver.points(), grid, model.faces, bundle, model.dampers.data(), view, damping);
      });
    });
    driver.exchange(damping);
    anchorage_.renew();
    fold(driver, grid, model.faces, damping, Mirrored::magnitudes);
    list(grid, damping);
  }
  // Makes the list of the nodes that are damped.
  void list(const GridGeometry<T>& grid, Damping<T> damping) {
    nodes_.clear();
    row_.clear();
    const std::size_t row = grid.nodes(2), count = grid.field_count * grid.node_count();
    for (std::size_t node = 0; node < count; ++node) {
      if (node % row == 0) row_.push_back(nodes_.size());
      if (dot(damping[node].vector(), damping[node].vector()) > T(0)) nodes_.push_back(node);
    }
  }
  // See Machine::for_each_part: the cells that are held, and the damping of the nodes that have some.
  template <class F>
  void for_each_part(F&& f, const GridGeometry<T>& grid, Damping<T> damping) {
    f("faces.held", anchorage_.held());
    f("faces.way", way_);
    std::vector<std::uint64_t> nodes(nodes_.begin(), nodes_.end());
    std::vector<T> values;
    for (const std::size_t node : nodes_)
      for (int c = 0; c < 4; ++c) values.push_back(damping[node].v[c]);
    f("faces.nodes", nodes);
    f("faces.damping", values);
    if constexpr (!std::remove_cvref_t<F>::restores) return;
    if (values.size() != 4 * nodes.size() || anchorage_.held().size() != grid.node_count())
      throw std::invalid_argument("faces: not those of this grid");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i] >= grid.field_count * grid.node_count())
        throw std::invalid_argument("faces: a node that there is not");
      for (int c = 0; c < 4; ++c) damping[nodes[i]].v[c] = values[4 * i + c];
    }
    list(grid, damping);
  }

  // Returns the first damped node from a node on, as its place in nodes_.
  std::size_t first_from(const GridGeometry<T>& grid, std::size_t node) const {
    std::size_t i = row_[node / grid.nodes(2)];
    while (i < nodes_.size() && nodes_[i] < node) ++i;
    return i;
  }
  void begin_step() { after_.assign(nodes_.size(), {}); }
  bool is_damped(std::size_t i, std::size_t node) const { return i < nodes_.size() && nodes_[i] == node; }
  // Keeps the velocity of damped node i after the forces, before contact.
  void keep(std::size_t i, const Quad<T>& velocity) { after_[i] = velocity; }

  // Adds the energy that the faces took in a step, and the way of their fastest node; `final`: the velocity
  // that the points really got.
  template <class Driver>
  void add_absorbed(const Model<T>& model, const Driver& driver, Velocity<T> before, Velocity<T> final,
                    Damping<T> damping, T dt, double& total) {
    struct OfSlot {
      double absorbed = 0, speed2 = 0;
    };
    std::vector<OfSlot> of_slots(driver.slots());
    driver.for_each_line(false, [&](int slot, std::size_t begin, std::size_t end) {
      OfSlot sum;
      for (std::size_t i = first_from(model.grid, begin); i < nodes_.size() && nodes_[i] < end; ++i) {
        const std::size_t node = nodes_[i];
        if (!has_mass(before, node)) continue;
        const auto v = final[node].vector();
        sum.absorbed +=
            double(absorbed_energy(before[node].vector(), after_[i].vector(), v, damping[node].vector(), dt));
        sum.speed2 = std::max(sum.speed2, double(dot(v, v)));
      }
      if (sum.speed2 == 0 && sum.absorbed == 0) return;
      of_slots[slot].absorbed += sum.absorbed;
      of_slots[slot].speed2 = std::max(of_slots[slot].speed2, sum.speed2);
    });
    double speed2 = 0;
    for (const OfSlot& one : of_slots) {
      total += one.absorbed;
      speed2 = std::max(speed2, one.speed2);
    }
    way_ += double(dt) * std::sqrt(speed2);
  }

 private:
  static constexpr double way_per_area = 0.125;  // cells

  Anchorage anchorage_;
  double way_ = 0;                  // of the fastest damped nodes since the areas were found, m
  std::vector<std::size_t> nodes_;  // that are damped
  std::vector<std::size_t> row_;    // where nodes_ has the first of each row of nodes along z
  Array<Quad<T>> after_;            // their velocities
};

}  // namespace pockmark
