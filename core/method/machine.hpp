// A machine is all that a run consists of: what never changes, what holds points and nodes, what a step reads
// of those before.
#pragma once
#include <optional>
#include <vector>

#include "../levers.hpp"
#include "../timers.hpp"
#include "contact.hpp"
#include "state.hpp"
#include "transmitting_faces.hpp"

namespace pockmark {

template <class Driver>
struct Machine {
  using T = typename Driver::Number;
  Model<T> model;
  Driver driver;
  State state;
  TransmittingFaces<T> transmitting;
  std::optional<Contact<T>> contact;
  Timers timers;
  // Where velocities are carried to the nodes (levers.hpp):
  std::vector<Bits> bits;
  std::array<Array<Slopes<T>>, 2> slopes;

  // Makes room for what nodes and cells have: all zero.
  void allocate() {
    driver.allocate(model.grid, array_count());
    if (!model.is_linear()) return;
    const RowBits<T> rows(model.grid);
    bits.assign(LeverMarks::columns * (rows.margin() + rows.words()), 0);
    const std::size_t nodes = model.grid.field_count * model.grid.node_count();
    for (auto& array : slopes) array.assign(Levers<T>::margin(model.grid) + nodes, {});
  }

  // Calls f(name, part) for everything that a step reads of the steps before it, a number or an array: to
  // save it, or, where F::restores, to replace it. Throws std::invalid_argument if what f puts there does not
  // fit.
  template <class F>
  void for_each_part(F&& f) {
    state.for_each_part(f);
    transmitting.for_each_part(f, model.grid, damping());
    const bool linear = model.options.shape == ShapeFunction::trilinear;
    driver.for_each_part(f, linear ? Linear<T>::support : Quadratic<T>::support);
    if (state.live < 0 || std::size_t(state.live) > driver.points().count)
      throw std::invalid_argument("live: more points than there are");
  }

  // Arrays of the driver: two that take turns for momentum, one for forces, one for damping, and one for
  // cells where volumetric strain is theirs; three where velocities are carried to the nodes. The one for
  // momentum that is free, all zero until velocities are mapped back, also serves contact.
  Momentum<T> momentum() { return driver.template nodes<Nodal::momentum>(state.momentum); }
  Momentum<T> other_momentum() { return driver.template nodes<Nodal::momentum>(2 - state.momentum); }
  Surface<T> surface() { return driver.template nodes<Nodal::surface>(2 - state.momentum); }
  Cells<T> cells() {
    if (!model.by_cells()) return {};
    return Cells<T>::in(driver.template nodes<Nodal::cell>(4),
                        model.grid.field_count * model.grid.node_count());
  }
  Levers<T> levers() {
    if (!model.is_linear()) return {};
    T* const numbers = reinterpret_cast<T*>(driver.template nodes<Nodal::cell>(first_lever() + 1).data);
    const std::size_t nodes = model.grid.field_count * model.grid.node_count();
    const std::size_t margin = Levers<T>::margin(model.grid);
    return {driver.template nodes<Nodal::lever>(first_lever()),
            numbers,
            numbers + nodes,
            slopes[0].data() + margin,
            slopes[1].data() + margin,
            LeverMarks::in(bits.data(), RowBits<T>(model.grid))};
  }
  Velocity<T> carried() {
    if (!model.is_linear()) return {};
    return driver.template nodes<Nodal::velocity>(first_lever() + 2);
  }
  // Returns the bytes of what is no array of the driver.
  std::size_t bytes() const {
    return bits.size() * sizeof(Bits) + (slopes[0].size() + slopes[1].size()) * sizeof(Slopes<T>);
  }
  Force<T> force() { return driver.template nodes<Nodal::force>(1); }
  Damping<T> damping() { return driver.template nodes<Nodal::damping>(3); }

 private:
  int array_count() const { return first_lever() + (model.is_linear() ? 3 : 0); }
  int first_lever() const { return model.by_cells() ? 5 : 4; }
};

}  // namespace pockmark
