// The explicit material point method: the step reads as the seven steps of Liu et al. 2015, Section 2.
#pragma once
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "boundary.hpp"
#include "cpu/contact.hpp"
#include "cpu/scatter.hpp"
#include "cpu/sort.hpp"
#include "cpu/tiles.hpp"
#include "grid_update.hpp"
#include "timers.hpp"
#include "update.hpp"

namespace pockmark {

enum class Scheme { usf, musl, usl, usavg };
enum class ShapeFunction { trilinear, quadratic };

struct Options {
  Scheme scheme;
  ShapeFunction shape;
  double cfl;           // dt <= cfl h / (|v| + c)
  double strain_limit;  // dt <= strain_limit / |tr D|
  double pic_fraction;
  double mass_cutoff;  // in units of the lightest rho0 h^3
  bool lanes;          // SIMD: packs of points
  bool sleep;          // tiles at rest are passed over
};

// Where the energy is (J).
struct Ledger {
  double kinetic = 0, internal = 0;
  double absorbed = 0;                         // by transmitting faces
  double left_kinetic = 0, left_internal = 0;  // carried out by points that left
  double pic = 0;                              // taken from the points' velocities by the PIC share
  double contact = 0;                          // by impact and friction where two bodies touch
  double viscous = 0, plastic = 0;             // parts of the internal energy's history, for information
  double initial = 0;
  double mass = 0;  // of the points in the grid (kg), and their momentum (kg m/s)
  Vec3<double> momentum{};
  double error() const {
    return kinetic + internal + absorbed + left_kinetic + left_internal + pic + contact - initial;
  }
};

struct Departed {
  double mass = 0, kinetic = 0, internal = 0;
  Vec3<double> momentum{};
};

template <class T>
class Solver {
 public:
  Solver(const GridGeometry<T>& geometry, const Faces& faces, std::vector<Material<T>> materials,
         const Options& options, int threads)
      : faces_(faces), materials_(std::move(materials)), options_(options), threads_(threads) {
    grid_.allocate(geometry);
    T lightest = std::numeric_limits<T>::max();
    for (const auto& m : materials_) {
      dampers_.push_back(
          {m.density * m.dilatational_speed(), m.density * m.shear_speed(), m.specific_volume});
      lightest = std::min(lightest, m.density);
    }
    const double cell_mass = double(lightest) * std::pow(double(geometry.cell), 3);
    mass_unit_ = std::exp2(std::round(std::log2(cell_mass)));
    cutoff_ = T(options.mass_cutoff * cell_mass / mass_unit_);
  }

  Particles<T>& points() { return points_; }
  const Particles<T>& points() const { return points_; }
  const Grid<T>& grid() const { return grid_; }
  const Audit& audit() const { return audit_; }
  const Timers& timers() const { return timers_; }
  const Departed& departed() const { return departed_; }
  double time() const { return time_; }
  double dt() const { return dt_; }
  std::int64_t cycle() const { return cycle_; }

  // Gives the bodies for which `in_second` a velocity field of their own, in contact with the others. Before
  // any point is placed.
  void set_contact(std::vector<std::uint8_t> in_second, double friction) {
    if (in_second.size() != materials_.size())
      throw std::invalid_argument("set_contact: a number a body is needed");
    auto geometry = grid_.geometry;
    geometry.field_count = 2;
    if (2 * geometry.node_count() >= UINT32_MAX)
      throw std::invalid_argument("set_contact: more than 4 billion nodes");
    grid_.allocate(geometry);
    in_second_ = std::move(in_second);
    contact_.emplace(geometry, faces_, T(friction));
  }

  // Names the bodies that are no part of the target: transmitting faces let them pass. Before initialize().
  void let_fly(std::vector<std::uint8_t> flies) {
    if (flies.size() != materials_.size()) throw std::invalid_argument("let_fly: a number a body is needed");
    anchorage_.let_fly(std::move(flies));
  }

  // Puts a point, whose body is known, at x (m). Called once for each point, before initialize().
  void place(std::size_t p, const Vec3<double>& x) {
    const auto& g = grid_.geometry;
    const double offset =
        options_.shape == ShapeFunction::trilinear ? Linear<T>::offset : Quadratic<T>::offset;
    int base[3];
    Vec3<T> f;
    for (int a = 0; a < 3; ++a) {
      const double xi = (x[a] - double(g.lower[a])) / double(g.cell) + g.pad;
      const double most = g.cells[a] + 3.0;  // far outside is as good as farther
      base[a] = int(std::floor(std::min(std::max(xi - offset, 0.0), most)));
      f[a] = T(xi - base[a]);
    }
    points_.set_vector(Field::place, p, f);
    const int face = face_crossed(g, base, f);
    const std::size_t field = contact_ && in_second_[points_.body[p]] ? g.node_count() : 0;
    points_.cell[p] = face < 0 ? std::uint32_t(field + g.index(base[0], base[1], base[2])) : gone;
    if (face >= 0) outside_.push_back({p, face});
  }
  Vec3<double> position(std::size_t p) const {
    const auto& g = grid_.geometry;
    int base[3];
    g.split(points_.cell[p], base);
    const auto f = points_.vector(Field::place, p);
    Vec3<double> x;
    for (int a = 0; a < 3; ++a) x[a] = double(g.lower[a]) + (base[a] - g.pad + double(f[a])) * double(g.cell);
    return x;
  }

  void initialize() {
    live_ = points_.size();
    anchorage_.begin(grid_.geometry, materials_.size());
    for (const Exit& exit : outside_) account_for(exit);
    with_kernels([&]<class K>(K) { sort<K>(); });
    Vec3<T> least{}, most{};
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto& m = materials_[points_.body[p]];
      const auto v = points_.vector(Field::velocity, p);
      if (p == 0) least = most = v;
      for (int a = 0; a < 3; ++a) least[a] = min(least[a], v[a]), most[a] = max(most[a], v[a]);
      extremes_.wave_speed =
          std::max(extremes_.wave_speed, double(m.dilatational_speed() + std::sqrt(dot(v, v))));
    }
    const auto spread = most - least;
    closing_speed_ = std::sqrt(double(dot(spread, spread)));
    const auto now = energies();
    initial_ = now.kinetic + now.internal;
  }

  // Steps to end_time, landing on it, unless max_steps or the first step at or beyond `pause` comes before.
  std::int64_t advance(std::int64_t max_steps, double end_time, double pause) {
    const std::int64_t start = cycle_;
    with_kernels([&]<class K>(K) {
      while (cycle_ - start < max_steps && time_ < end_time && time_ < pause) {
        if (live_ == 0) {
          time_ = end_time;  // everything left: nothing more can happen
          break;
        }
        choose_step(end_time);
        step<K>();
      }
    });
    return cycle_ - start;
  }

  Ledger ledger() const {
    Ledger l = energies();
    l.absorbed = mass_unit_ * absorbed_, l.pic = mass_unit_ * pic_energy_;
    l.contact = mass_unit_ * contact_energy_;
    l.left_kinetic = departed_.kinetic, l.left_internal = departed_.internal;
    l.viscous = mass_unit_ * audit_.viscous_work, l.plastic = mass_unit_ * audit_.plastic_work;
    l.initial = initial_;
    return l;
  }

  // The deviator of a point with its trial part (see follow_strain) returned to the yield surface.
  Sym3<T> settled_deviator(std::size_t p) const {
    const auto point = points_.state(p);
    const T trial = effective(point.deviator);
    if (trial <= T(0) || point.damage >= T(1)) return point.deviator;
    const auto& m = materials_[points_.body[p]];
    const auto conditions = conditions_of(point);
    const T strain = m.return_map(trial, point.plastic_strain, conditions, T(dt_)).strain_increment;
    return ((trial - T(3) * m.shear(conditions) * strain) / trial) * point.deviator;
  }

  // f(tile, block) for every block, in parallel; those at work at a time share no node.
  template <class F>
  void for_each_block_apart(F&& f) const {
    tiles_.scatter_all(threads_, f);
  }
  // f(p) for the points that have not left; those that have stay in memory until the next sort.
  template <class F>
  void for_each_point(F&& f) const {
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (points_.cell[p] != gone) f(p);
  }
  // Points in one place: how many, and the corners of a box around them (m).
  struct Gathering {
    std::int64_t points = 0;
    std::array<double, 3> lower{}, upper{};
    void add(const Vec3<double>& x) {
      for (int a = 0; a < 3; ++a) {
        lower[a] = points ? std::min(lower[a], x[a]) : x[a];
        upper[a] = points ? std::max(upper[a], x[a]) : x[a];
      }
      ++points;
    }
  };
  // The points that are in a state that no material can be in now, by the counter of such steps.
  std::map<Counter, Gathering> impossible() const {
    std::map<Counter, Gathering> out;
    for_each_point([&](std::size_t p) {
      const auto point = points_.state(p);
      const auto& m = materials_[points_.body[p]];
      const auto note = [&](Counter counter, bool is_so) {
        if (is_so) out[counter].add(position(p));
      };
      note(Counter::negative_energies, point.energy < m.least_energy);
      note(Counter::negative_volumes, point.ratio() <= T(0));
      note(Counter::negative_temperatures, point.temperature < T(0));
      note(Counter::eos_caps, m.capped(point.ratio()));
    });
    return out;
  }
  double reference_volume(std::size_t p) const {
    return mass(p) * double(materials_[points_.body[p]].specific_volume);
  }
  // What masses are kept in (kg), and with them volumes, forces and energies on their way through a step:
  // about a full cell's, so that single precision holds the mass of any node of any body. A power of two: no
  // digit of a result depends on it.
  double mass_unit() const { return mass_unit_; }
  double mass(std::size_t p) const { return mass_unit_ * double(points_.at(Field::mass)[p]); }
  // To be called when points were changed from outside.
  void wake() { tiles_.wake(), mapped_ = false; }
  std::int64_t sorts() const { return sorts_; }  // how often points were put in the order of the cells
  std::size_t other_grid_bytes() const { return anchorage_.bytes() + (contact_ ? contact_->bytes() : 0); }
  std::size_t run_bytes() const { return tiles_.run_count() * sizeof(Run); }
  std::size_t sleeping_points() const {
    std::size_t sum = 0;
    for (int tile = 0; tile < tiles_.count(); ++tile)
      if (tiles_.sleeps(tile))
        tiles_.for_each_block(tile, [&](int, const Block& block) { sum += block.end - block.begin; });
    return sum;
  }
  std::size_t live_points() const { return live_; }

 private:
  // What a run costs in a step, in points sorted.
  static constexpr std::int64_t points_per_run_cost = 3;
  // How often the areas of transmitting faces are renewed.
  static constexpr std::int64_t steps_per_area = 8;

  // The shape functions, and what the kernels compute with: a number at a time, or a pack.
  template <class ShapeOf, class Values>
  struct Kernels {
    using Shape = ShapeOf;
    using V = Values;
  };
  template <class F>
  void with_kernels(F&& f) {
    const auto with_shape = [&]<class V>(V) {
      options_.shape == ShapeFunction::trilinear ? f(Kernels<Linear<T>, V>{}) : f(Kernels<Quadratic<T>, V>{});
    };
#ifdef POCKMARK_LANES
    if (options_.lanes) return with_shape(Lanes<T>{});
#endif
    with_shape(T{});
  }

  // The seven steps. `before` is the nodal velocity at k-1/2, `after` at k+1/2.
  template <class K>
  void step() {
    const Scheme scheme = options_.scheme;
    timers_.time("clear", [&] { clear(); });
    timers_.time("p2g", [&] { map_damping<K>(), map_to_grid<K>(); });                    // (1)
    timers_.time("boundary", [&] { constrain(grid_.geometry, faces_, grid_.before); });  // (2)
    if (contact_) timers_.time("contact", [&] { meet<K>(); });
    const bool first = scheme == Scheme::usf || scheme == Scheme::usavg;
    timers_.time("stress", [&] { stress_and_forces<K>(first ? &grid_.before : nullptr, true); });  // (3, 4)
    timers_.time("momentum", [&] { integrate_momentum(); });                                       // (5)
    if (contact_) timers_.time("contact", [&] { press(); });
    timers_.time("g2p", [&] { map_to_points<K>(scheme == Scheme::usf); });  // (6)
    timers_.time("absorbed", [&] { account_for_absorbed(remaps() ? grid_.remapped : grid_.after); });
    if (!first)
      timers_.time("stress", [&] { stress_and_forces<K>(remaps() ? &grid_.remapped : &grid_.after, false); });
    scheme == Scheme::usf ? take_over() : timers_.time("move", [&] { move<K>(); });
    timers_.time("sort", [&] { arrange<K>(); });
    time_ = next_time_;  // (7)
    ++cycle_;
  }

  // Whether the scheme maps the new velocities of the points back to the grid.
  bool remaps() const { return options_.scheme == Scheme::musl || options_.scheme == Scheme::usavg; }

  void choose_step(double end_time) {
    const double h = grid_.geometry.cell;
    dt_ = options_.cfl * h / extremes_.wave_speed;
    // The limit on the strain looks at the last step. When bodies meet the strain comes at once, of their
    // cells at about closing_speed_/h: twice the limit is left to that first step.
    const double rate = std::max(extremes_.volumetric_rate, closing_speed_ / (2 * h));
    if (rate * dt_ > options_.strain_limit) {
      dt_ = options_.strain_limit / rate;
      audit_.count(Counter::strain_limited_steps);
    }
    if (!(dt_ > 0) || !std::isfinite(dt_)) throw std::runtime_error("the time step is no longer a number");
    if (cycle_ == 0) first_dt_ = dt_;
    // Waves a thousand times faster than at the start are no physics, and the run would never end.
    if (dt_ < 1e-3 * first_dt_)
      throw std::runtime_error("the time step fell to a thousandth of the first one");
    // Land on the end exactly, without a sliver of a step before it.
    const double left = end_time - time_;
    if (left < 2 * dt_) dt_ = left <= dt_ ? left : left / 2;
    next_time_ = left <= dt_ ? end_time : time_ + dt_;
  }

  void clear() {
    const auto zero = [](Array<Quad<T>>& field, std::size_t begin, std::size_t end) {
      std::fill(field.begin() + begin, field.begin() + end, Quad<T>{});
    };
    tiles_.for_each_line(grid_.geometry, threads_, true, [&](int, std::size_t begin, std::size_t end) {
      if (!mapped_) zero(grid_.before, begin, end);
      zero(grid_.after, begin, end);
      zero(grid_.remapped, begin, end);
    });
    tiles_.forget_stale();
  }

  template <class K>
  void map_to_grid() {
    if (!mapped_)
      tiles_.scatter(threads_, [&](int, const Block& block) { add_to_grid<K>(block, grid_.before); });
    fold(grid_.geometry, faces_, grid_.before, Mirrored::vector);
    momentum_to_velocity(grid_.before);
  }

  template <class K>
  void add_to_grid(const Block& block, Array<Quad<T>>& momentum) {
    cpu::scatter_momentum<typename K::Shape, typename K::V>(points_, grid_.geometry, block, momentum);
  }

  // The areas of the transmitting faces change with the points behind them, that is, slowly. The steps at
  // which they are renewed must not depend on how the points lie in memory: runs that mirror each other would
  // differ.
  template <class K>
  void map_damping() {
    const bool none = std::ranges::count(faces_, Face::transmitting) == 0;
    if (cycle_ > 0 && (none || cycle_ % steps_per_area != 0)) return;
    std::fill(grid_.damping.begin(), grid_.damping.end(), Quad<T>{});
    tiles_.scatter_all(threads_, [&](int, const Block& block) {
      for_each_run(block, [&](const Run& run) {
        add_damping<typename K::Shape>(points_, grid_, faces_, run, dampers_, anchorage_);
      });
    });
    anchorage_.renew();
    fold(grid_.geometry, faces_, grid_.damping, Mirrored::magnitudes);
    damped_.clear(), damped_row_.clear();
    const std::size_t row = grid_.geometry.nodes(2);
    for (std::size_t node = 0; node < grid_.damping.size(); ++node) {
      if (node % row == 0) damped_row_.push_back(damped_.size());
      if (dot(grid_.damping[node].vector(), grid_.damping[node].vector()) > T(0)) damped_.push_back(node);
    }
  }

  void momentum_to_velocity(Array<Quad<T>>& field) {
    tiles_.for_each_line(grid_.geometry, threads_, false, [&](int, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const T mass = field[i].v[3];
        field[i].set_vector(mass > least_mass<T> ? (T(1) / mass) * field[i].vector() : Vec3<T>{});
      }
    });
  }

  // Stress from a nodal velocity, if there is one, and the forces of the stress, if they are wanted: block by
  // block, while its points are in the cache.
  template <class K>
  void stress_and_forces(const Array<Quad<T>>* velocity, bool forces) {
    // USAVG strains by half a step here, pays it with the new stress, and by half after the forces
    // (move()).
    const bool average = options_.scheme == Scheme::usavg;
    const T old_share = T(average ? 0 : 0.5);
    const StressStep<T> step{T(average ? dt_ / 2 : dt_), T(dt_), old_share, T(1) - old_share};
    audits_.resize(tiles_.count());
    for (int tile = 0; tile < tiles_.count(); ++tile)
      if (velocity && !tiles_.sleeps(tile)) audits_[tile] = {};
    const auto work = [&](int tile, const Block& block) {
      Columns<T, 6> push;
      if (velocity) {
        StrainColumns<T> strains;
        gather_strain<typename K::Shape, typename K::V>(points_, grid_.geometry, block, *velocity, step.dt,
                                                        strains);
        update_stress<typename K::V>(points_, materials_, grid_.geometry.cell, block, strains, step,
                                     audits_[tile], push);
      } else
        push_of_stress<typename K::V>(points_, materials_, block, push);
      if (forces)
        cpu::scatter_force<typename K::Shape, typename K::V>(points_, grid_.geometry, block, push,
                                                             grid_.after);
    };
    forces ? tiles_.scatter(threads_, work) : tiles_.gather(threads_, work);
    if (forces) fold(grid_.geometry, faces_, grid_.after, Mirrored::vector);
    if (!velocity) return;
    extremes_ = {};
    for (const auto& a : audits_) extremes_.absorb(a);
    audit_.absorb(extremes_);
  }

  // Where damped_ has its first node from this one on.
  std::size_t first_damped(std::size_t node) const {
    std::size_t i = damped_row_[node / grid_.geometry.nodes(2)];
    while (i < damped_.size() && damped_[i] < node) ++i;
    return i;
  }

  void integrate_momentum() {
    damped_after_.assign(damped_.size(), {});
    std::vector<std::int64_t> cut(tiles_.count());
    tiles_.for_each_line(grid_.geometry, threads_, false, [&](int tile, std::size_t begin, std::size_t end) {
      std::size_t next = first_damped(begin);
      std::int64_t light = 0;
      for (std::size_t node = begin; node < end; ++node) {
        const std::size_t i = next;
        const bool damped = i < damped_.size() && damped_[i] == node;
        next += damped;
        if (!grid_.has_mass(node)) {
          grid_.after[node] = {};
          continue;
        }
        const auto step = integrate_node(grid_.before[node], grid_.after[node],
                                         damped ? grid_.damping[node] : Quad<T>{}, T(dt_), cutoff_);
        grid_.after[node] = step.velocity;
        if (damped) damped_after_[i] = step.velocity;
        light += step.cut;
      }
      if (light > 0) cut[tile] += light;  // tiles of other threads are on the same line of the cache
    });
    audit_.counts[std::size_t(Counter::node_cutoffs)] +=
        std::accumulate(cut.begin(), cut.end(), std::int64_t(0));
    constrain(grid_.geometry, faces_, grid_.after);
  }

  template <class K>
  void meet() {
    contact_->template find<typename K::Shape>(points_, grid_, tiles_, threads_, T(dt_),
                                               [&](std::size_t p) { return T(volume(p)); });
    fit(grid_.before);
  }
  void fit(Array<Quad<T>>& velocity) {
    contact_->fit(grid_, velocity);
    constrain(grid_.geometry, faces_, velocity);
  }
  void press() {
    contact_->press(grid_);
    constrain(grid_.geometry, faces_, grid_.after);
  }

  void account_for_absorbed(const Array<Quad<T>>& final) {
    std::vector<double> absorbed(tiles_.count());
    tiles_.for_each_line(grid_.geometry, threads_, false, [&](int tile, std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = first_damped(begin); i < damped_.size() && damped_[i] < end; ++i) {
        const std::size_t node = damped_[i];
        if (!grid_.has_mass(node)) continue;
        sum += double(absorbed_energy(grid_.before[node].vector(), damped_after_[i].vector(),
                                      final[node].vector(), grid_.damping[node].vector(), T(dt_)));
      }
      if (sum != 0) absorbed[tile] += sum;
    });
    for (const double sum : absorbed) absorbed_ += sum;
    if (contact_) contact_energy_ += contact_->taken(grid_, final);
  }

  // Velocities; positions too where nothing between the two needs the old ones, and then the points' momentum
  // for the next step, to the array that is free: one pass does the work of three.
  template <class K>
  void map_to_points(bool moves) {
    std::vector<double> taken(tiles_.count());
    exits_.assign(tiles_.count(), {});
    const auto work = [&](int tile, const Block& block) {
      const double lost = update_velocities<typename K::Shape, typename K::V>(points_, grid_, block,
                                                                              T(options_.pic_fraction));
      if (lost != 0) taken[tile] += lost;  // tiles of other threads are on the same line of the cache
      if (remaps()) add_to_grid<K>(block, grid_.remapped);
      return moves && move_block<K>(tile, block);
    };
    const auto map_ahead = [&](int, const Block& block) { add_to_grid<K>(block, grid_.remapped); };
    moves ? regroup<K>(work, map_ahead) : tiles_.scatter(threads_, work);
    for (double t : taken) pic_energy_ += t;
    if (!remaps()) return;
    fold(grid_.geometry, faces_, grid_.remapped, Mirrored::vector);
    momentum_to_velocity(grid_.remapped);
    constrain(grid_.geometry, faces_, grid_.remapped);
    if (contact_) fit(grid_.remapped);
  }

  // The momentum that USF has mapped ahead.
  void take_over() {
    std::swap(grid_.before, grid_.remapped);
    mapped_ = true;
  }

  // Maps the points to the grid for the next step as well, while they are in the cache.
  template <class K>
  void move() {
    tiles_.for_each_line(grid_.geometry, threads_, false, [&](int, std::size_t begin, std::size_t end) {
      std::fill(grid_.before.begin() + begin, grid_.before.begin() + end, Quad<T>{});
    });
    mapped_ = true;
    const auto work = [&](int tile, const Block& block) {
      if (options_.scheme == Scheme::usavg) {
        StrainColumns<T> strains;
        gather_strain<typename K::Shape, typename K::V>(points_, grid_.geometry, block, grid_.remapped,
                                                        T(dt_ / 2), strains);
        strain_points<typename K::V>(points_, materials_, block, strains);
      }
      return move_block<K>(tile, block);
    };
    regroup<K>(work, [&](int, const Block& block) { add_to_grid<K>(block, grid_.before); });
  }
  // Whether a point changed its cell.
  template <class K>
  bool move_block(int tile, const Block& block) {
    return move_points<typename K::Shape, typename K::V>(points_, grid_, block, T(dt_), exits_[tile]);
  }
  template <class K, class F, class G>
  void regroup(F&& moved, G&& then) {
    tiles_.regroup(points_, grid_.geometry, K::Shape::support, threads_, moved, then);
  }

  // Order for the next step. Points are sorted by cell again when that pays: once the runs that disorder has
  // added since, step by step, have cost as much; and when one has strayed too far from its tile.
  template <class K>
  void arrange() {
    for (const auto& tile : exits_)
      for (const Exit& exit : tile) account_for(exit);
    tiles_.renew_spans();
    disorder_ += std::max(std::int64_t(tiles_.run_count()) - sorted_runs_, std::int64_t(0));
    if (points_per_run_cost * disorder_ > std::int64_t(points_.size()) || !tiles_.hold()) sort<K>();
    if (options_.sleep && cutoff_ == T(0))
      if (tiles_.send_to_sleep(cycle_ == 0, [&](int tile) { return rests(tile); })) mapped_ = false;
  }

  // Whether a step without motion would leave the points of a tile as they are.
  bool rests(int tile) const {
    bool all = true;
    tiles_.for_each_block(tile, [&](int, const Block& block) {
      for (std::size_t p = block.begin; all && p < block.end; ++p) {
        const auto point = points_.state(p);
        const auto v = points_.vector(Field::velocity, p);
        all = v.x == T(0) && v.y == T(0) && v.z == T(0) && effective(point.deviator) == T(0) &&
              point.dilation == T(0) && point.energy == T(0) && point.pressure == T(0) &&
              point.viscosity == T(0);
      }
    });
    return all;
  }

  template <class K>
  void sort() {
    sorter_(points_, grid_.before.size(), threads_);
    tiles_.locate(points_, grid_.geometry);
    tiles_.split(points_, grid_.geometry, K::Shape::support, threads_);
    tiles_.renew_spans();
    sorted_runs_ = std::int64_t(tiles_.run_count()), disorder_ = 0;
    mapped_ = false;
    ++sorts_;
  }

  void account_for(const Exit& exit) {
    const std::size_t p = exit.point;
    const auto v = points_.vector(Field::velocity, p);
    const double m = mass(p);
    if (!std::isfinite(dot(v, v))) throw std::runtime_error("a point's velocity is no longer a number");
    departed_.mass += m;
    departed_.momentum += m * Vec3<double>{double(v.x), double(v.y), double(v.z)};
    departed_.kinetic += 0.5 * m * double(dot(v, v));
    departed_.internal += internal_energy(p);
    const Face face = faces_[exit.face];
    const bool expected = face == Face::free || face == Face::transmitting;
    audit_.count(expected ? Counter::left_points : Counter::lost_points);
    --live_;
  }

  double volume(std::size_t p) const {
    return (1 + double(points_.at(Field::dilation)[p])) * reference_volume(p);
  }
  double internal_energy(std::size_t p) const {
    return double(points_.at(Field::energy)[p]) * reference_volume(p);
  }

  Ledger energies() const {
    std::vector<Ledger> parts(tiles_.count());
    tiles_.visit(threads_, [&](int tile, const Block& block) {
      for (std::size_t p = block.begin; p < block.end; ++p) {
        const auto v = points_.vector(Field::velocity, p);
        const double m = mass(p);
        parts[tile].kinetic += 0.5 * m * double(dot(v, v));
        parts[tile].internal += internal_energy(p);
        parts[tile].mass += m;
        parts[tile].momentum += m * Vec3<double>{double(v.x), double(v.y), double(v.z)};
      }
    });
    Ledger sum;
    for (const auto& part : parts) {
      sum.kinetic += part.kinetic, sum.internal += part.internal;
      sum.mass += part.mass, sum.momentum += part.momentum;
    }
    return sum;
  }

  Faces faces_;
  Anchorage anchorage_;
  std::vector<Material<T>> materials_;
  std::vector<Damper<T>> dampers_;  // of each body
  Options options_;
  int threads_;
  T cutoff_;  // in units of mass_unit_
  Particles<T> points_;
  Grid<T> grid_;
  cpu::Tiles tiles_;
  cpu::Sorter<T> sorter_;
  std::optional<cpu::Contact<T>> contact_;
  std::vector<std::uint8_t> in_second_;  // of each body, with contact
  Timers timers_;
  std::vector<Audit> audits_;             // of each tile in the last stress update
  std::vector<std::vector<Exit>> exits_;  // of each tile in the last move
  std::vector<Exit> outside_;             // points that were put outside the grid
  std::vector<std::size_t> damped_;       // nodes of transmitting faces
  std::vector<std::size_t> damped_row_;   // where damped_ has the first of each row of nodes along z
  Array<Quad<T>> damped_after_;           // their velocities before contact
  std::size_t live_ = 0;
  std::int64_t sorted_runs_ = 0, disorder_ = 0;
  bool mapped_ = false;  // whether the points are in grid_.before already
  Audit audit_;          // of the whole run
  Audit extremes_;       // of the last stress update
  Departed departed_;
  double time_ = 0, next_time_ = 0, dt_ = 0, first_dt_ = 0;
  std::int64_t cycle_ = 0, sorts_ = 0;
  double mass_unit_ = 1;      // kg
  double initial_ = 0;        // J
  double closing_speed_ = 0;  // largest difference of the points' velocities at the start (m/s)
  double absorbed_ = 0, pic_energy_ = 0, contact_energy_ = 0;  // J/kg times mass_unit_
};

}  // namespace pockmark
