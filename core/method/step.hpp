// The verbs of a step (Liu et al. 2015, Section 2): what the schemes (schemes/) are made of. They read and
// leave nodal quantities by name and know no threads, tiles or lanes.
#pragma once
#include <numeric>

#include "../stress.hpp"
#include "lines.hpp"
#include "machine.hpp"
#include "mover.hpp"
#include "node_velocity.hpp"
#include "step_size.hpp"
#include "volume.hpp"

namespace pockmark {

template <class Driver, class Shape>
class Step {
  using T = typename Driver::Number;
  using V = typename Driver::Values;
  using Hints = typename Driver::Hints;

 public:
  explicit Step(Machine<Driver>& m) : m_(m), volume_(m), at_nodes_(m), mover_(m) {}

  double dt() const { return state_.dt; }
  const auto& exits() const { return mover_.exits(); }

  // Sets the nodes that points touch to zero.
  void clear() {
    m_.timers.time("clear", [&] {
      const auto momentum = m_.momentum(), other = m_.other_momentum();
      const auto force = m_.force();
      driver_.for_each_line(true, [&](int, std::size_t begin, std::size_t end) {
        if (!state_.is_mapped) clear_line(momentum, begin, end);
        clear_line(force, begin, end);
        clear_line(other, begin, end);
      });
      at_nodes_.clear();
      driver_.forget_stale();
    });
  }

  // (1), (2): maps momentum and mass of the points, unless the last step has done so, and returns the
  // velocity: that carried to the nodes, until the forces are there.
  Velocity<T> map_points() {
    const auto momentum = m_.momentum();
    Velocity<T> before{};
    m_.timers.time("p2g", [&] {
      if (m_.transmitting.renews(grid_, state_.cycle))
        m_.transmitting.template renew<Shape>(model_, driver_, m_.damping());
      if (!state_.is_mapped) driver_.scatter([&](int, const Block& block) { mover_.add(block, momentum); });
      before = to_velocity(momentum);
      at_nodes_.find(before);
    });
    m_.timers.time("boundary", [&] { constrain(driver_, grid_, model_.faces, before); });
    if (m_.contact)
      m_.timers.time("contact", [&] {
        m_.contact->template find<Shape>(model_, driver_, before, m_.surface(), T(dt()));
        fit(before);
      });
    m_.timers.time("stress", [&] {
      at_nodes_.carry(before);
      volume_.begin(before);
    });
    return before;
  }

  // (3), (4): strains the points by the velocity that was mapped, and returns the forces of the new stress.
  Force<T> stress_and_force(Velocity<T> before, const Pay& pay) {
    const auto force = m_.force();
    stress(before, pay, [&](auto&& update) {
      driver_.scatter([&](int slot, const Block& block) {
        Columns<T, 6> push;
        update(slot, block, push);
        add_forces(block, push, force);
      });
      finish_forces(force);
    });
    return force;
  }
  // (3) alone: strains the points by a nodal velocity.
  void stress_only(Velocity<T> velocity, const Pay& pay) {
    carry(velocity);
    stress(velocity, pay, [&](auto&& update) {
      driver_.for_each_awake_block([&](int slot, const Block& block) {
        Columns<T, 6> push;
        update(slot, block, push);
      });
    });
  }
  // (4) alone: the forces of the stress that there is.
  Force<T> force_only() {
    const auto force = m_.force();
    m_.timers.time("stress", [&] {
      driver_.scatter([&](int, const Block& block) {
        Columns<T, 6> push;
        push_of_stress<V>(driver_.points(), model_.materials.data(), block, push);
        add_forces(block, push, force);
      });
      finish_forces(force);
    });
    return force;
  }

  // (5): integrates the momentum of the nodes, with the transmitting tractions; ends the approach of bodies
  // in contact. The velocity takes the place of the force.
  Velocity<T> integrate(Velocity<T> before, Force<T> force) {
    const Velocity<T> after{force.data};
    const LineIntegration<T> integrate_line{grid_,        m_.transmitting, before,       after,
                                            m_.damping(), T(dt()),         model_.cutoff};
    m_.timers.time("momentum", [&] {
      m_.transmitting.begin_step();
      std::vector<std::int64_t> cut(driver_.slots());
      driver_.for_each_line(false, [&](int slot, std::size_t begin, std::size_t end) {
        if (const auto light = integrate_line(begin, end)) cut[slot] += light;
      });
      state_.audit.counts[std::size_t(Counter::node_cutoffs)] +=
          std::accumulate(cut.begin(), cut.end(), std::int64_t(0));
      constrain(driver_, grid_, model_.faces, after);
    });
    if (m_.contact)
      m_.timers.time("contact", [&] {
        m_.contact->stop_approach(after);
        constrain(driver_, grid_, model_.faces, after);
      });
    return after;
  }

  // (6): changes the velocities of the points.
  void update_velocities(Velocity<T> before, Velocity<T> after) {
    velocities([&](auto&& update) { driver_.scatter(update); }, before, after);
  }
  // (6): changes the velocities of the points, and maps them back to the grid.
  Velocity<T> map_back(Velocity<T> before, Velocity<T> after) {
    const auto momentum = m_.other_momentum();
    Velocity<T> mapped{};
    velocities(
        [&](auto&& update) {
          driver_.scatter([&](int slot, const Block& block) {
            update(slot, block);
            mover_.add(block, momentum);
          });
        },
        before, after,
        [&] {
          mapped = to_velocity(momentum);
          constrain(driver_, grid_, model_.faces, mapped);
          if (m_.contact) fit(mapped);
        });
    return mapped;
  }
  // (6): changes velocities and positions of the points, where nothing between the two needs the old
  // positions. Adds their momentum for the next step to the array that is free: one pass does the work of
  // three.
  void update_velocities_and_move(Velocity<T> before, Velocity<T> after) {
    const auto momentum = m_.other_momentum();
    const auto motion = at_nodes_.carried(after);
    velocities(
        [&](auto&& update) {
          mover_.regroup(
              [&](int slot, const Block& block) {
                update(slot, block);
                return mover_.of_block(slot, block, motion, T(dt()));
              },
              momentum);
        },
        before, after);
    state_.momentum = 2 - state_.momentum;
    state_.is_mapped = true;
  }

  // Accounts for the energy that transmitting faces and contact took; `final`: the velocity that the points
  // got.
  void account(Velocity<T> before, Velocity<T> after, Velocity<T> final) {
    m_.timers.time("absorbed", [&] {
      m_.transmitting.add_absorbed(model_, driver_, before, final, m_.damping(), T(dt()), state_.absorbed);
      if (m_.contact) state_.contact += m_.contact->taken(before, after, final);
    });
  }

  // (6): changes the positions of the points, and adds their momentum for the next step, while they are in
  // the cache. Where velocities are carried to the nodes, points move as they were strained last. `before` is
  // lost: its array takes the momentum.
  void move(Velocity<T> after) {
    const auto by = at_nodes_.latest(after);
    move_with([&](int slot, const Block& block) { return mover_.of_block(slot, block, by, T(dt())); });
  }
  // Does the same, after a last strain by a nodal velocity.
  void strain_and_move(Velocity<T> after, Velocity<T> by, double dt) {
    carry(by);
    move_with([&](int slot, const Block& block) {
      StrainColumns<T> strains;
      if (!at_nodes_.is_linear()) {
        volume_.gather(block, by, T(dt), strains);
        strain(block, strains);
        return mover_.of_block(slot, block, after, T(this->dt()));
      }
      Columns<T, 3> motion;  // in half of dt
      volume_.gather(block, by, T(dt), strains, motion);
      strain(block, strains);
      return mover_.of_block(slot, block, motion, T(2 * this->dt() / dt));
    });
  }

 private:
  // Completes a sum of the points: other memories, mirrors.
  template <Nodal quantity>
  void finish(NodeField<T, quantity> sum) {
    driver_.exchange(sum);
    fold(driver_, grid_, model_.faces, sum, Mirrored::vector);
  }
  Velocity<T> to_velocity(Momentum<T> momentum) {
    return pockmark::to_velocity(driver_, grid_, model_.faces, momentum);
  }
  void fit(Velocity<T> velocity) {
    m_.contact->fit(velocity);
    constrain(driver_, grid_, model_.faces, velocity);
  }

  // Carries a velocity to the nodes, of which the strains are, and lets the cells know of it.
  void carry(Velocity<T> mean) {
    m_.timers.time("stress", [&] {
      at_nodes_.carry(mean);
      volume_.find(mean);
    });
  }
  void add_forces(const Block& block, Columns<T, 6>& push, Force<T> force) {
    volume_.take_mean_stress(block, push);
    driver_.template add_force<Shape>(block, push, force);
    if (grid_.is_axisymmetric) add_hoop_force<Shape>(driver_.points(), grid_, block, push, force);
  }
  void finish_forces(Force<T> force) {
    finish(force);
    volume_.add_to(force);
    at_nodes_.take_back(force);
    at_nodes_.put_back();
  }

  // Calls walk(update) with update(slot, block, push), which strains a block: block by block, while its
  // points are in the cache. Then takes what the blocks have counted.
  template <class Walk>
  void stress(Velocity<T> velocity, const Pay& pay, Walk&& walk) {
    m_.timers.time("stress", [&] {
      const StressStep<T> step{T(pay.dt), T(dt()), T(pay.old_share), T(pay.new_share)};
      auto& audits = state_.audits;
      audits.resize(driver_.slots());
      for (int slot = 0; slot < driver_.slots(); ++slot)
        if (driver_.is_awake(slot)) audits[slot] = {};
      walk([&](int slot, const Block& block, Columns<T, 6>& push) {
        StrainColumns<T> strains;
        volume_.gather(block, velocity, step.dt, strains);
        update_stress<V, Hints>(driver_.points(), model_.materials.data(), grid_.cell, block, strains, step,
                                audits[slot], push);
      });
      state_.extremes = {};
      for (const auto& audit : audits) state_.extremes.absorb(audit);
      state_.audit.absorb(state_.extremes);
    });
  }

  // Calls walk(update) with update(slot, block), which changes the velocities of a block; then finish().
  template <class Walk, class Finish = void (*)()>
  void velocities(Walk&& walk, Velocity<T> before, Velocity<T> after, Finish&& finish = [] {}) {
    m_.timers.time("g2p", [&] {
      std::vector<double> taken(driver_.slots());
      mover_.begin_step();
      walk([&](int slot, const Block& block) {
        const double lost = pockmark::update_velocities<Shape, V, Hints>(
            driver_.points(), grid_, block, before, after, T(model_.options.pic_fraction));
        if (lost != 0) taken[slot] += lost;  // those of other threads are on the same line of the cache
      });
      for (const double sum : taken) state_.pic += sum;
      finish();
    });
  }

  void strain(const Block& block, const StrainColumns<T>& strains) const {
    strain_points<V, Hints>(driver_.points(), model_.materials.data(), block, strains);
  }
  template <class Move>
  void move_with(Move&& move) {
    const auto momentum = m_.momentum();
    m_.timers.time("move", [&] {
      clear_nodes(driver_, momentum);
      mover_.regroup(move, momentum);
      state_.is_mapped = true;
    });
  }

  Machine<Driver>& m_;
  const Model<T>& model_ = m_.model;
  Driver& driver_ = m_.driver;
  State& state_ = m_.state;
  const GridGeometry<T>& grid_ = m_.model.grid;
  Volume<Driver, Shape> volume_;
  NodeVelocity<Driver> at_nodes_;
  Mover<Driver, Shape> mover_;
};

}  // namespace pockmark
