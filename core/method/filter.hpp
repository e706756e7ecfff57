// The filter of what the grid cannot see (docs/theory.md, Filters). S interpolates from the nodes to the
// points, S+ maps to the nodes by mass. What lies in the null space of S+ neither feels the grid nor is felt
// by it, and stays for ever. Every few steps
//   v -= (1 - S S+)^m v                    loses the motion of that kind (XPIC, Hammerquist and Nairn 2017),
//   J += share (-dJ/dp) (1 - S S+)^2 p    lets such a pressure relax, as sound between points would.
// What either takes becomes heat of the points around (map_unseen, heat). Points that are free to fly
// (connected.hpp) neither give to the filter nor take from it.
#pragma once
#include "../compliance.hpp"
#include "../motion.hpp"
#include "../stress.hpp"
#include "connected.hpp"
#include "node_velocity.hpp"

namespace pockmark {

template <class Driver, class Shape>
class Filter {
  using T = typename Driver::Number;
  using V = typename Driver::Values;

 public:
  explicit Filter(Machine<Driver>& m)
      : m_(m),
        options_(m.model.options),
        driver_(m.driver),
        grid_(m.model.grid),
        connected_(m),
        at_nodes_(m) {}

  bool is_due() const {
    return options_.filter_interval > 0 && m_.state.cycle > 0 &&
           m_.state.cycle % options_.filter_interval == 0;
  }
  // Filters between two steps, when no nodal array is in use. The points are to be mapped anew.
  void run() {
    const Momentum<T> first = m_.momentum(), second = m_.other_momentum(), sum{m_.force().data};
    connected_.find(first);
    if (options_.filter_order > 0) find_velocity(first, second, sum);
    const T heat_share = map_unseen(first, sum);
    if (options_.pressure_filter > 0) see_rest(first, second);
    relax(first, sum, heat_share);
    if (options_.pressure_filter > 0) heat(sum);
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
  // are, and the filter symmetric. These two steps are of order 2 by themselves.
  void find_velocity(Momentum<T> first, Momentum<T> second, Momentum<T> sum) {
    clear_nodes(driver_, sum);
    clear_nodes(driver_, first);
    driver_.scatter([&](int, const Block& block) {
      const auto v = [&](int a) { return driver_.points().at(Field::velocity, a) + block.begin; };
      map(block, {v(0), v(1), v(2)}, first);
    });
    if (!at_nodes_.is_linear()) return add_series(options_.filter_order, first, second, sum);
    at_nodes_.clear();
    const auto mean = to_grid(first, Mirrored::vector);
    at_nodes_.find(
        mean, [&](std::size_t p) { return connected_.has(p) ? driver_.points().at(Field::mass)[p] : T(0); });
    at_nodes_.carry(mean);
    add(T(1), mean, sum);
    map_rest(sum, first);
    if (options_.filter_order > 2) {
      add_series(options_.filter_order - 2, first, second, sum);
      map_rest(sum, first);
    }
    take_back(first, sum);
  }
  // Adds sum_k c_k (S+ S)^(k-1) S+ w, of which S makes what the binomial series of 1 - (1 - S S+)^m leaves of
  // w; `first` is what w maps.
  void add_series(int order, Momentum<T> first, Momentum<T> second, Momentum<T> sum) {
    Velocity<T> term = to_grid(first, Mirrored::vector);
    T share = T(order);
    add(share, term, sum);
    Momentum<T> next = second;
    for (int k = 2; k <= order; ++k) {
      share *= T(k - 1 - order) / T(k);
      clear_nodes(driver_, next);
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
    clear_nodes(driver_, rest);
    driver_.scatter([&](int, const Block& block) {
      Columns<T, 3> v;
      gather(block, {seen.data}, v);
      const auto& points = driver_.points();
      for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
        const std::size_t i = p - block.begin;
        const auto rest = points.template vector<V>(Field::velocity, p, n) - v.template vector<V>(i);
        for (int a = 0; a < 3; ++a) v.store(a, i, rest[a]);
      });
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
    clear_nodes(driver_, unseen);
    std::vector<Loss> losses(driver_.slots());
    driver_.scatter([&](int slot, const Block& block) {
      Columns<T, 1> energy{};
      if (options_.filter_order > 0) {
        const Loss loss = filter_velocity(block, {velocity.data}, energy);
        if (loss.taken != 0) losses[slot] += loss;
      }
      const T* const pressure = driver_.points().at(Field::pressure) + block.begin;
      map(block, {energy.at[0], pressure, energy.at[0]}, unseen);
    });
    to_grid(unseen, Mirrored::magnitudes);
    Loss sum;
    for (const Loss& one : losses) sum += one;
    return sum.taken > 0 ? T(sum.kinetic / sum.taken) : T(0);
  }
  // Gives the points of a block their velocity. Leaves the energy per mass of what this took of it.
  Loss filter_velocity(const Block& block, Velocity<T> velocity, Columns<T, 1>& energy) const {
    const auto& points = driver_.points();
    Columns<T, 3> seen;
    gather(block, velocity, seen);
    V taken = V(0), kinetic = V(0);
    for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
      const std::size_t i = p - block.begin;
      const auto v = points.template vector<V>(Field::velocity, p, n), now = seen.template vector<V>(i);
      const auto off = v - now;
      const auto acts = connected_.among(p, n);
      const V mass = select(acts, points.template load<V>(Field::mass, p, n), V(0));
      const V unseen = select(acts, V(T(0.5)) * dot(off, off), V(0));
      taken += mass * unseen;
      kinetic += mass * (unseen + select(acts, dot(off, now), V(0)));
      energy.store(0, i, unseen);
      const Vec3<V> filtered{select(acts, now.x, v.x), select(acts, now.y, v.y), select(acts, now.z, v.z)};
      points.set_vector(Field::velocity, p, filtered, n);
    });
    return {sum_of(taken), sum_of(kinetic)};
  }
  // Adds to the pressure at the nodes what they see of the rest: p - S S+ p. Then the rest of the sum is
  // (1 - S S+)^2 p, of which a wave that is long has hardly anything.
  void see_rest(Momentum<T> unseen, Momentum<T> rest) {
    clear_nodes(driver_, rest);
    driver_.scatter([&](int, const Block& block) {
      Columns<T, 3> seen;
      gather(block, {unseen.data}, seen);
      Columns<T, 1> pressure;
      for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
        const std::size_t i = p - block.begin;
        const V own = driver_.points().template load<V>(Field::pressure, p, n);
        pressure.store(0, i, own - seen.template load<V>(1, i));
      });
      map(block, {pressure.at[0], pressure.at[0], pressure.at[0]}, rest);
    });
    to_grid(rest, Mirrored::magnitudes);
    driver_.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) unseen[i].v[1] += rest[i].v[0];
    });
    constrain(driver_, grid_, m_.model.faces, unseen, Mirrored::magnitudes);
  }
  // Adds the heat of the velocities, relaxes the unseen pressure, and maps the energy per mass that this
  // took.
  void relax(Momentum<T> unseen, Momentum<T> taken, T heat_share) {
    const bool relaxes = options_.pressure_filter > 0;
    if (relaxes) clear_nodes(driver_, taken);
    std::vector<double> heat(driver_.slots());
    driver_.scatter([&](int slot, const Block& block) {
      Columns<T, 3> seen;
      Columns<T, 1> lost;
      gather(block, {unseen.data}, seen);
      for_each_material(driver_.points(), m_.model.materials.data(), block,
                        [&](const auto& range, const Material<T>& material) {
                          const double sum = relax_points(range, block, material, seen, heat_share, lost);
                          if (sum != 0) heat[slot] += sum;
                        });
      if (relaxes) map(block, {lost.at[0], lost.at[0], lost.at[0]}, taken);
    });
    if (relaxes) to_grid(taken, Mirrored::magnitudes);
    for (const double one : heat) m_.state.filtered += one;
  }
  // Does so for points of one material in a block. Leaves the energy per mass that the pressure lost; returns
  // the heat of both.
  template <class Range>
  double relax_points(const Range& range, const Block& block, const Material<T>& material,
                      const Columns<T, 3>& seen, T heat_share, Columns<T, 1>& lost) const {
    const auto& points = driver_.points();
    const V share = V(T(options_.pressure_filter));
    V sum = V(0);
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      const std::size_t i = p - block.begin;
      const auto acts = connected_.among(p, n);
      const auto of_acting = [&](V value) PM_INLINE { return select(acts, value, V(0)); };
      const auto point = points.template state<V>(p, n);
      const V pressure = point.pressure, unseen = pressure - seen.template load<V>(1, i);
      // What has failed bears no tension that its pressure could fall to; open, it has none that could rise.
      const V least = select(V(0) < pressure, share * unseen, V(0));
      const V fall = select(V(1) <= point.damage, min(least, pressure), share * unseen);
      const V growth = of_acting(fall * compliance(material, point, fall));
      // The pressure falls by the share of what is unseen: its mean does the work.
      const V work = of_acting((pressure - V(T(0.5)) * fall) * growth);
      const V heat = of_acting(V(heat_share) * seen.template load<V>(0, i));
      Pack<V>::store(points.at(Field::dilation) + p, point.dilation + growth, n);
      add_energy(p, n, V(material.density) * heat - work);
      const V loss = work * V(material.specific_volume);
      sum += points.template load<V>(Field::mass, p, n) * (heat + loss);
      lost.store(0, i, loss, n);
    });
    return sum_of(sum);
  }
  // Adds the heat of the pressures.
  void heat(Momentum<T> taken) {
    driver_.for_each_awake_block([&](int, const Block& block) {
      Columns<T, 3> share;
      gather(block, {taken.data}, share);
      for_each_material(driver_.points(), m_.model.materials.data(), block,
                        [&](const auto& range, const Material<T>& material) {
                          for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
                            const V gain = V(material.density) * share.template load<V>(0, p - block.begin);
                            add_energy(p, n, select(connected_.among(p, n), gain, V(0)));
                          });
                        });
    });
  }

  void add_energy(std::size_t p, int n, V more) const {
    T* const energy = driver_.points().at(Field::energy) + p;
    Pack<V>::store(energy, Pack<V>::load(energy, n) + more, n);
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
  // Adds three numbers per mass of the connected points of a block to the nodes.
  void map(const Block& block, const T* const (&per_mass)[3], Momentum<T> nodes) const {
    Columns<T, 1> mass;
    for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
      const V own = driver_.points().template load<V>(Field::mass, p, n);
      mass.store(0, p - block.begin, select(connected_.among(p, n), own, V(0)));
    });
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
  Connected<Driver, Shape> connected_;
  NodeVelocity<Driver> at_nodes_;
};

}  // namespace pockmark
