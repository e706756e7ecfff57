// The filter of what the grid cannot see (docs/theory.md, Filters). S interpolates from the nodes to the
// points, S+ maps to the nodes by mass. What lies in the null space of S+ neither feels the grid nor is felt
// by it, and stays for ever. Every few steps
//   v -= (1 - S S+)^m v                     loses the motion of that kind (XPIC, Hammerquist and Nairn 2017),
//   J += share (p - S S+ p) J/(rho0 c_d^2)  lets such a pressure relax, as sound between points would.
// What either takes becomes heat of the points around (map_unseen, heat). Points that have failed are free to
// fly: they neither give to the filter nor take from it.
#pragma once
#include "../motion.hpp"
#include "lines.hpp"
#include "machine.hpp"
#include "node_velocity.hpp"

namespace pockmark {

template <class Driver, class Shape>
class Filter {
  using T = typename Driver::Number;
  using V = typename Driver::Values;

 public:
  explicit Filter(Machine<Driver>& m)
      : m_(m), options_(m.model.options), driver_(m.driver), grid_(m.model.grid), at_nodes_(m) {}

  bool is_due() const {
    return options_.filter_interval > 0 && m_.state.cycle > 0 &&
           m_.state.cycle % options_.filter_interval == 0;
  }
  // Filters between two steps, when no nodal array is in use. The points are to be mapped anew.
  void run() {
    const Momentum<T> first = m_.momentum(), second = m_.other_momentum(), sum{m_.force().data};
    if (options_.filter_order > 0) find_velocity(first, second, sum);
    const T heat_share = map_unseen(first, sum);
    relax(first, second, heat_share);
    heat(second);
    m_.state.is_mapped = false;
  }

 private:
  // What the velocity filter took: the energy of the velocities that it took, and the kinetic energy lost.
  struct Loss {
    double taken = 0, kinetic = 0;
    Loss& operator+=(const Loss& other) {
      taken += other.taken;
      kinetic += other.kinetic;
      return *this;
    }
  };

  // Finds in `sum` the nodal velocity of which S makes the filtered one. Where nodes have the velocity of the
  // mass centres it is the series below. Otherwise that series filters what v is besides the velocity carried
  // to the nodes, and what it leaves of that is mapped and taken back, so that linear velocities stay as they
  // are, and the filter symmetric.
  void find_velocity(Momentum<T> first, Momentum<T> second, Momentum<T> sum) {
    clear(sum);
    if (!at_nodes_.is_linear()) return add_series(first, second, sum);
    at_nodes_.clear();
    at_nodes_.find([&](std::size_t p) { return is_intact(p) ? driver_.points().at(Field::mass)[p] : T(0); });
    map_rest(sum, first);
    const auto carried = at_nodes_.of(to_grid(first, Mirrored::vector));
    add(T(1), carried, sum);
    add_series(first, second, sum);
    map_rest(sum, first);
    take_back(first, sum);
  }
  // Adds sum_k c_k (S+ S)^(k-1) S+ w, of which S makes what the binomial series of 1 - (1 - S S+)^m leaves of
  // w = v - S `sum`.
  void add_series(Momentum<T> first, Momentum<T> second, Momentum<T> sum) {
    map_rest(sum, first);
    Velocity<T> term = to_grid(first, Mirrored::vector);
    const int order = options_.filter_order;
    T share = T(order);
    add(share, term, sum);
    Momentum<T> next = second;
    for (int k = 2; k <= order; ++k) {
      share *= T(k - 1 - order) / T(k);
      clear(next);
      driver_.scatter([&](int, const Block& block) {
        Columns<T, 3> at_points;
        gather(block, term, at_points);
        map(block, {at_points.at[0], at_points.at[1], at_points.at[2]}, next);
      });
      const Momentum<T> free{term.data};
      term = to_grid(next, Mirrored::vector);
      next = free;
      add(share, term, sum);
    }
  }
  // Maps the momentum of the velocity that the points have besides S `seen`.
  void map_rest(Momentum<T> seen, Momentum<T> rest) {
    clear(rest);
    driver_.scatter([&](int, const Block& block) {
      Columns<T, 3> v;
      gather(block, {seen.data}, v);
      const auto& points = driver_.points();
      for (int a = 0; a < 3; ++a)
        for (std::size_t p = block.begin; p < block.end; ++p)
          v.store(a, p - block.begin, points.at(Field::velocity, a)[p] - v.at[a][p - block.begin]);
      map(block, {v.at[0], v.at[1], v.at[2]}, rest);
    });
  }
  // Takes momentum at the nodes back to the mass centres, and adds its velocity.
  void take_back(Momentum<T> momentum, Momentum<T> sum) {
    driver_.exchange(momentum);
    fold(driver_, grid_, m_.model.faces, momentum, Mirrored::vector);
    at_nodes_.take_back({momentum.data});
    driver_.for_each_line(
        false, [&](int, std::size_t begin, std::size_t end) { divide_by_mass(momentum, begin, end); });
    constrain(driver_, grid_, m_.model.faces, momentum);
    add(T(1), {momentum.data}, sum);
  }
  // Gives the points their velocity, and maps the energy per mass of what this took of it, and their
  // pressure. Returns the kinetic energy that was lost, as a multiple of that energy: the loss of a single
  // point depends on the frame, and may be a gain.
  T map_unseen(Momentum<T> unseen, Momentum<T> velocity) {
    clear(unseen);
    std::vector<Loss> losses(driver_.slots());
    driver_.scatter([&](int slot, const Block& block) {
      const auto& points = driver_.points();
      Columns<T, 2> carried;
      Columns<T, 3> seen;
      if (options_.filter_order > 0) gather(block, {velocity.data}, seen);
      Loss loss;
      for (std::size_t p = block.begin; p < block.end; ++p) {
        const std::size_t i = p - block.begin;
        const auto v = points.vector(Field::velocity, p);
        T energy = 0;
        if (options_.filter_order > 0 && is_intact(p)) {
          const auto now = seen.template vector<T>(i);
          const auto taken = v - now;
          energy = T(0.5) * dot(taken, taken);
          const double mass = points.at(Field::mass)[p];
          loss.taken += mass * energy;
          loss.kinetic += mass * (energy + dot(taken, now));
          points.set_vector(Field::velocity, p, now);
        }
        carried.store(0, i, energy);
        carried.store(1, i, points.at(Field::pressure)[p]);
      }
      if (loss.taken != 0) losses[slot] += loss;
      map(block, {carried.at[0], carried.at[1], carried.at[0]}, unseen);
    });
    to_grid(unseen, Mirrored::magnitudes);
    Loss sum;
    for (const Loss& one : losses) sum += one;
    return sum.taken > 0 ? T(sum.kinetic / sum.taken) : T(0);
  }
  // Adds the heat of the velocities, relaxes the unseen pressure, and maps the energy per mass that this
  // took.
  void relax(Momentum<T> unseen, Momentum<T> taken, T heat_share) {
    clear(taken);
    std::vector<double> heat(driver_.slots());
    driver_.scatter([&](int slot, const Block& block) {
      const auto& points = driver_.points();
      Columns<T, 3> seen;
      Columns<T, 1> carried;
      gather(block, {unseen.data}, seen);
      double sum = 0;
      for (std::size_t p = block.begin; p < block.end; ++p) {
        const std::size_t i = p - block.begin;
        T lost = 0;
        if (is_intact(p)) {
          const auto& material = m_.model.materials[points.body[p]];
          const T stiffness =
              material.density * material.dilatational_speed() * material.dilatational_speed();
          const T pressure = points.at(Field::pressure)[p], unseen = pressure - seen.at[1][i];
          const T ratio = T(1) + points.at(Field::dilation)[p];
          const T growth = T(options_.pressure_filter) * unseen * ratio / stiffness;
          // The pressure falls by the share of what is unseen: its mean does the work.
          const T work = (pressure - T(0.5 * options_.pressure_filter) * unseen) * growth;
          points.at(Field::dilation)[p] += growth;
          points.at(Field::energy)[p] += material.density * heat_share * seen.at[0][i] - work;
          lost = work * material.specific_volume;
          sum += double(points.at(Field::mass)[p] * (heat_share * seen.at[0][i] + lost));
        }
        carried.store(0, i, lost);
      }
      if (sum != 0) heat[slot] += sum;
      map(block, {carried.at[0], carried.at[0], carried.at[0]}, taken);
    });
    to_grid(taken, Mirrored::magnitudes);
    for (const double one : heat) m_.state.filtered += one;
  }
  // Adds the heat of the pressures.
  void heat(Momentum<T> taken) {
    driver_.for_each_awake_block([&](int, const Block& block) {
      const auto& points = driver_.points();
      Columns<T, 3> share;
      gather(block, {taken.data}, share);
      for (std::size_t p = block.begin; p < block.end; ++p)
        if (is_intact(p))
          points.at(Field::energy)[p] +=
              m_.model.materials[points.body[p]].density * share.at[0][p - block.begin];
    });
  }

  bool is_intact(std::size_t p) const { return driver_.points().at(Field::damage)[p] < T(1); }
  void clear(Momentum<T> nodes) const {
    driver_.for_each_line(false,
                          [&](int, std::size_t begin, std::size_t end) { clear_line(nodes, begin, end); });
  }
  void add(T share, Velocity<T> term, Momentum<T> sum) const {
    driver_.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sum[i].v += share * term[i].v;
    });
  }
  // Finds a nodal quantity at the points of a block.
  void gather(const Block& block, Velocity<T> nodes, Columns<T, 3>& out) const {
    gather_values<Shape, V>(driver_.points(), block, out, [&](Patch<Shape, T>& patch, const Bundle& bundle) {
      patch.load(grid_, bundle, nodes);
    });
  }
  // Adds three numbers per mass of the intact points of a block to the nodes.
  void map(const Block& block, const T* const (&per_mass)[3], Momentum<T> nodes) const {
    Columns<T, 1> mass;
    for (std::size_t p = block.begin; p < block.end; ++p)
      mass.store(0, p - block.begin, is_intact(p) ? driver_.points().at(Field::mass)[p] : T(0));
    const Carried<T> carried{mass.at[0], {per_mass[0], per_mass[1], per_mass[2]}, block.begin};
    driver_.template add_carried<Shape>(block, carried, nodes);
  }
  Velocity<T> to_grid(Momentum<T> nodes, Mirrored kind) const {
    const auto values = to_velocity(driver_, grid_, m_.model.faces, nodes, kind);
    constrain(driver_, grid_, m_.model.faces, values, kind);
    return values;
  }

  Machine<Driver>& m_;
  const Options& options_;
  Driver& driver_;
  const GridGeometry<T>& grid_;
  NodeVelocity<Driver> at_nodes_;
};

}  // namespace pockmark
