// The explicit material point method: the step reads as the seven steps of Liu et al. 2015, Section 2.
#pragma once
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "boundary.hpp"
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
};

// Where the energy is (J).
struct Ledger {
  double kinetic = 0, internal = 0;
  double absorbed = 0;                         // by transmitting faces
  double left_kinetic = 0, left_internal = 0;  // carried out by points that left
  double pic = 0;                              // taken from the points' velocities by the PIC share
  double viscous = 0, plastic = 0;             // parts of the internal energy's history, for information
  double initial = 0;
  double error() const {
    return kinetic + internal + absorbed + left_kinetic + left_internal + pic - initial;
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
      impedance_.push_back({m.density() * m.dilatational_speed(), m.density() * m.shear_speed(), T(0)});
      lightest = std::min(lightest, m.density());
    }
    const T h = geometry.cell;
    cutoff_ = T(options.mass_cutoff) * lightest * h * h * h;
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

  void initialize() {
    with_kernels([&](auto kernels) { locate<decltype(kernels)>(true); });
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto& m = materials_[points_.body[p]];
      const auto v = points_.vector(Field::velocity, p);
      extremes_.wave_speed =
          std::max(extremes_.wave_speed, double(m.dilatational_speed() + std::sqrt(dot(v, v))));
    }
    const auto now = energies();
    initial_ = now.kinetic + now.internal;
  }

  std::int64_t advance(std::int64_t max_steps, double end_time) {
    const std::int64_t start = cycle_;
    with_kernels([&](auto kernels) {
      while (cycle_ - start < max_steps && time_ < end_time) {
        if (points_.size() == 0) {
          time_ = end_time;  // everything left: nothing more can happen
          break;
        }
        choose_step(end_time);
        step<decltype(kernels)>();
      }
    });
    return cycle_ - start;
  }

  Ledger ledger() const {
    Ledger l = energies();
    l.absorbed = absorbed_, l.pic = pic_energy_;
    l.left_kinetic = departed_.kinetic, l.left_internal = departed_.internal;
    l.viscous = audit_.viscous_work, l.plastic = audit_.plastic_work;
    l.initial = initial_;
    return l;
  }

  // The deviator of a point with its trial part (see strain_elastically) returned to the yield surface.
  Sym3<T> settled_deviator(std::size_t p) const {
    const auto point = points_.state(p);
    const T trial = effective(point.deviator);
    if (trial <= T(0) || point.damage >= T(1)) return point.deviator;
    const auto& m = materials_[points_.body[p]];
    const T strain = m.strength.visit([&](const auto& law) {
      return law.return_map(trial, point.plastic_strain, point.temperature, T(dt_)).strain_increment;
    });
    return ((trial - T(3) * m.shear_modulus() * strain) / trial) * point.deviator;
  }

  Vec3<double> momentum() const {
    Vec3<double> sum;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto v = points_.vector(Field::velocity, p);
      const double m = points_.at(Field::mass)[p];
      sum += m * Vec3<double>{double(v.x), double(v.y), double(v.z)};
    }
    return sum;
  }

 private:
  static constexpr int steps_between_sorts = 8;

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
    timers_.time("p2g", [&] { map_to_grid<K>(); });                                      // (1)
    timers_.time("boundary", [&] { constrain(grid_.geometry, faces_, grid_.before); });  // (2)
    const bool first = scheme == Scheme::usf || scheme == Scheme::usavg;
    timers_.time("stress", [&] { stress_and_forces<K>(first ? &grid_.before : nullptr, true); });  // (3, 4)
    timers_.time("momentum", [&] { integrate_momentum(); });                                       // (5)
    const bool remaps = scheme == Scheme::musl || scheme == Scheme::usavg;
    timers_.time("g2p", [&] { map_to_points<K>(remaps); });  // (6)
    timers_.time("absorbed", [&] { account_for_absorbed(remaps ? grid_.remapped : grid_.after); });
    if (!first)
      timers_.time("stress", [&] { stress_and_forces<K>(remaps ? &grid_.remapped : &grid_.after, false); });
    timers_.time("move", [&] { move<K>(); });
    timers_.time("sort", [&] { locate<K>(cycle_ % steps_between_sorts == 0); });
    time_ = next_time_;  // (7)
    ++cycle_;
  }

  void choose_step(double end_time) {
    const double h = grid_.geometry.cell;
    dt_ = options_.cfl * h / extremes_.wave_speed;
    if (extremes_.volumetric_rate * dt_ > options_.strain_limit) {
      dt_ = options_.strain_limit / extremes_.volumetric_rate;
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
    const std::int64_t n = std::int64_t(grid_.before.size());
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::int64_t i = 0; i < n; ++i) {
      grid_.before[i] = grid_.force[i] = grid_.damping[i] = grid_.remapped[i] = {};
    }
  }

  template <class K>
  void map_to_grid() {
    tiles_.scatter(points_, grid_.geometry, threads_, [&](int, const Block& block) {
      for_each_run(block, [&](const Run& run) {
        cpu::scatter_momentum<typename K::Shape, typename K::V>(points_, grid_.geometry, run, grid_.before);
        add_damping<typename K::Shape>(points_, grid_, faces_, run, impedance_);
      });
    });
    fold(grid_.geometry, faces_, grid_.before, Mirrored::vector);
    fold(grid_.geometry, faces_, grid_.damping, Mirrored::magnitudes);
    momentum_to_velocity(grid_.before);
  }

  void momentum_to_velocity(std::vector<Quad<T>>& field) {
    const std::int64_t n = std::int64_t(field.size());
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::int64_t i = 0; i < n; ++i)
      if (field[i].v[3] > T(0)) field[i].set_vector((T(1) / field[i].v[3]) * field[i].vector());
  }

  // Stress from a nodal velocity, if there is one, and the forces of the stress, if they are wanted: block by
  // block, while its points are in the cache.
  template <class K>
  void stress_and_forces(const std::vector<Quad<T>>* velocity, bool forces) {
    // USAVG strains by half a step here, pays it with the new stress, and by half after the forces
    // (move()).
    const bool average = options_.scheme == Scheme::usavg;
    const T old_share = T(average ? 0 : 0.5);
    const StressStep<T> step{T(average ? dt_ / 2 : dt_), T(dt_), old_share, T(1) - old_share};
    std::vector<Audit> audits(tiles_.count());
    const auto work = [&](int tile, const Block& block) {
      if (velocity)
        update_stress<typename K::Shape, typename K::V>(points_, grid_.geometry, materials_, block, *velocity,
                                                        step, audits[tile]);
      if (forces)
        for_each_run(block, [&](const Run& run) {
          cpu::scatter_force<typename K::Shape, typename K::V>(points_, grid_.geometry, run, grid_.force);
        });
    };
    forces ? tiles_.scatter(points_, grid_.geometry, threads_, work)
           : tiles_.gather(points_, grid_.geometry, threads_, work);
    if (forces) fold(grid_.geometry, faces_, grid_.force, Mirrored::vector);
    if (!velocity) return;
    extremes_ = {};
    for (const auto& a : audits) extremes_.absorb(a);
    audit_.absorb(extremes_);
  }

  // f(node, sum) over the nodes of each plane; the sums of the planes are added in order.
  template <class Sum, class F>
  Sum sum_over_nodes(F&& f) {
    const auto& g = grid_.geometry;
    std::vector<Sum> sums(g.nodes(0));
    const std::int64_t plane = std::int64_t(g.index(1, 0, 0));
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int i = 0; i < g.nodes(0); ++i)
      for (std::int64_t node = i * plane; node < (i + 1) * plane; ++node) f(node, sums[i]);
    return std::accumulate(sums.begin(), sums.end(), Sum{});
  }

  void integrate_momentum() {
    const auto cut = sum_over_nodes<std::int64_t>([&](std::int64_t node, std::int64_t& count) {
      grid_.after[node] = {};
      const T mass = grid_.mass(node);
      if (!(mass > T(0))) return;
      const auto step = integrate_node(mass, grid_.before[node].vector(), grid_.force[node].vector(),
                                       grid_.damping[node].vector(), T(dt_), cutoff_);
      grid_.after[node].set_vector(step.velocity);
      count += step.cut;
    });
    audit_.counts[std::size_t(Counter::node_cutoffs)] += cut;
    constrain(grid_.geometry, faces_, grid_.after);
  }

  void account_for_absorbed(const std::vector<Quad<T>>& final) {
    absorbed_ += sum_over_nodes<double>([&](std::int64_t node, double& sum) {
      if (!(grid_.mass(node) > T(0))) return;
      sum += double(absorbed_energy(grid_.before[node].vector(), grid_.after[node].vector(),
                                    final[node].vector(), grid_.damping[node].vector(), T(dt_)));
    });
  }

  template <class K>
  void map_to_points(bool remaps) {
    std::vector<double> taken(tiles_.count());
    const auto work = [&](int tile, const Block& block) {
      taken[tile] += update_velocities<typename K::Shape, typename K::V>(points_, grid_, block,
                                                                         T(options_.pic_fraction));
      if (remaps)
        for_each_run(block, [&](const Run& run) {
          cpu::scatter_momentum<typename K::Shape, typename K::V>(points_, grid_.geometry, run,
                                                                  grid_.remapped);
        });
    };
    remaps ? tiles_.scatter(points_, grid_.geometry, threads_, work)
           : tiles_.gather(points_, grid_.geometry, threads_, work);
    for (double t : taken) pic_energy_ += t;
    if (!remaps) return;
    fold(grid_.geometry, faces_, grid_.remapped, Mirrored::vector);
    momentum_to_velocity(grid_.remapped);
    constrain(grid_.geometry, faces_, grid_.remapped);
  }

  template <class K>
  void move() {
    const auto* remapped = options_.scheme == Scheme::usavg ? &grid_.remapped : nullptr;
    tiles_.gather(points_, grid_.geometry, threads_, [&](int, const Block& block) {
      pockmark::move<typename K::Shape, typename K::V>(points_, grid_, materials_, block, remapped, T(dt_));
    });
  }

  // The points' cells. They are sorted by cell now and then only: the kernels need each point near its tile,
  // and like neighbours in memory, no more.
  template <class K>
  void locate(bool sort_now) {
    const std::int64_t n = std::int64_t(points_.size());
    bool any_outside = false;
#pragma omp parallel for schedule(static) num_threads(threads_) reduction(|| : any_outside)
    for (std::int64_t p = 0; p < n; ++p) {
      const auto x = points_.vector(Field::position, p);
      const bool inside = face_crossed(x) < 0;
      points_.cell[p] = inside ? std::uint32_t(base_node<K>(x)) : cpu::gone;
      any_outside = any_outside || !inside;
    }
    if (any_outside) account_for_departed();
    if (!sort_now && !any_outside && tiles_.hold(points_, grid_.geometry, threads_)) return;
    sorter_(points_, grid_.geometry.node_count(), threads_);
    tiles_.locate(points_, grid_.geometry);
  }

  template <class K>
  std::size_t base_node(const Vec3<T>& x) const {
    const auto& g = grid_.geometry;
    return g.index(K::Shape::base(g.local(x.x, 0)), K::Shape::base(g.local(x.y, 1)),
                   K::Shape::base(g.local(x.z, 2)));
  }

  // The face behind which a point lies, or -1. Not-a-number counts as outside.
  int face_crossed(const Vec3<T>& x) const {
    const auto& g = grid_.geometry;
    for (int a = 0; a < 3; ++a) {
      if (!(x[a] >= g.lower[a])) return 2 * a;
      if (!(x[a] < g.upper(a))) return 2 * a + 1;
    }
    return -1;
  }

  void account_for_departed() {
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (points_.cell[p] != cpu::gone) continue;
      const auto v = points_.vector(Field::velocity, p);
      const double m = points_.at(Field::mass)[p];
      if (!std::isfinite(dot(v, v))) throw std::runtime_error("a point's velocity is no longer a number");
      departed_.mass += m;
      departed_.momentum += m * Vec3<double>{double(v.x), double(v.y), double(v.z)};
      departed_.kinetic += 0.5 * m * double(dot(v, v));
      departed_.internal += internal_energy(p);
      const Face face = faces_[face_crossed(points_.vector(Field::position, p))];
      const bool expected = face == Face::free || face == Face::transmitting;
      audit_.count(expected ? Counter::left_points : Counter::lost_points);
    }
  }

  double internal_energy(std::size_t p) const {
    return double(points_.at(Field::energy)[p]) * points_.at(Field::mass)[p] /
           materials_[points_.body[p]].density();
  }

  Ledger energies() const {
    std::vector<Ledger> parts(tiles_.count());
    tiles_.points(threads_, [&](int tile, std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const auto v = points_.vector(Field::velocity, p);
        parts[tile].kinetic += 0.5 * double(points_.at(Field::mass)[p]) * double(dot(v, v));
        parts[tile].internal += internal_energy(p);
      }
    });
    Ledger sum;
    for (const auto& part : parts) sum.kinetic += part.kinetic, sum.internal += part.internal;
    return sum;
  }

  Faces faces_;
  std::vector<Material<T>> materials_;
  std::vector<Vec3<T>> impedance_;  // rho c_d, rho c_s of each body
  Options options_;
  int threads_;
  T cutoff_;  // kg
  Particles<T> points_;
  Grid<T> grid_;
  cpu::Tiles tiles_;
  cpu::Sorter<T> sorter_;
  Timers timers_;
  Audit audit_;     // of the whole run
  Audit extremes_;  // of the last stress update
  Departed departed_;
  double time_ = 0, next_time_ = 0, dt_ = 0, first_dt_ = 0;
  std::int64_t cycle_ = 0;
  double initial_ = 0, absorbed_ = 0, pic_energy_ = 0;
};

}  // namespace pockmark
