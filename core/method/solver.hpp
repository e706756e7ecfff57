// The explicit material point method: a run from its first point to its last step.
#pragma once
#include <stdexcept>

#include "../driver.hpp"
#include "filter.hpp"
#include "probes.hpp"
#include "schemes/musl.hpp"
#include "schemes/usavg.hpp"
#include "schemes/usf.hpp"
#include "schemes/usl.hpp"
#include "step.hpp"

namespace pockmark {

template <class Driver>
class Solver {
  static_assert(IsDriver<Driver>);

 public:
  using T = typename Driver::Number;

  Solver(const GridGeometry<T>& grid, const Faces& faces, std::vector<Material<T>> materials,
         const Options& options, int threads)
      : m_{Model<T>(grid, faces, std::move(materials), options),
           Driver(threads, options.sleep && options.mass_cutoff == 0,
                  options.node_velocity == AtNodes::linear),
           {},
           {},
           {},
           {},
           {},
           {}} {
    m_.allocate();
  }

  const Model<T>& model() const { return m_.model; }
  const Driver& driver() const { return m_.driver; }
  const State& state() const { return m_.state; }
  const Timers& timers() const { return m_.timers; }
  const Points<T>& points() const { return m_.driver.points(); }
  std::size_t node_bytes() const {
    return m_.driver.node_bytes() + m_.bytes() + anchorage_bytes_ + (m_.contact ? m_.contact->bytes() : 0);
  }

  // Gives the bodies for which `in_second` a velocity field of their own, in contact with the others. Before
  // any point is placed.
  void set_contact(std::vector<std::uint8_t> in_second, double friction) {
    require_one_a_body(in_second, "set_contact");
    auto& grid = m_.model.grid;
    grid.field_count = 2;
    if (2 * grid.node_count() >= UINT32_MAX)
      throw std::invalid_argument("set_contact: more than 4 billion nodes");
    m_.allocate();
    m_.model.in_second = std::move(in_second);
    m_.contact.emplace(grid, m_.model.faces, T(friction));
  }
  // Names the bodies that are no part of the target: transmitting faces let them pass. Before initialize().
  void let_fly(std::vector<std::uint8_t> flies) {
    require_one_a_body(flies, "let_fly");
    m_.transmitting.anchorage().let_fly(std::move(flies));
  }

  void reserve(std::size_t count) { m_.driver.reserve(count); }
  void resize(std::size_t count) { m_.driver.resize(count); }
  // Puts a point, whose body is known, at x (m). Called once for each point, before initialize().
  void place(std::size_t p, const Vec3<double>& x) {
    const auto& grid = m_.model.grid;
    const bool linear = m_.model.options.shape == ShapeFunction::trilinear;
    const auto seat = seat_of(grid, x, linear ? Linear<T>::offset : Quadratic<T>::offset);
    const auto& points = m_.driver.points();
    points.set_vector(Field::place, p, seat.place);
    const int face = face_crossed(grid, seat.base, seat.place);
    const std::size_t field = m_.contact && m_.model.in_second[points.body[p]] ? grid.node_count() : 0;
    const std::size_t node = field + grid.index(seat.base[0], seat.base[1], seat.base[2]);
    points.cell[p] = face < 0 ? std::uint32_t(node) : gone;
    if (face >= 0) outside_.push_back({p, face});
  }

  // Prepares for the first step, when all points are placed.
  void initialize() {
    auto& state = m_.state;
    state.live = std::int64_t(points().count);
    begin_anchorage();
    for (const Exit& exit : outside_) account_for(exit);
    with_shape([&]<class Shape>(Shape) { m_.driver.sort(Shape::support); });
    note_first_speeds();
    const auto now = energies(m_.model, m_.driver);
    state.initial = now.kinetic + now.internal;
  }

  // Steps to end_time, landing on it, unless max_steps or the first step at or beyond `pause` comes before.
  // Returns the steps done.
  std::int64_t advance(std::int64_t max_steps, double end_time, double pause) {
    const std::int64_t start = m_.state.cycle;
    const auto with_scheme = [&]<class Shape, class Scheme>(Shape, Scheme) {
      Step<Driver, Shape> step(m_);
      Filter<Driver, Shape> filter(m_);
      auto& state = m_.state;
      while (state.cycle - start < max_steps && state.time < end_time && state.time < pause) {
        if (state.live == 0) {
          state.time = end_time;  // everything left: nothing more can happen
          break;
        }
        const double next_time = choose_step(state, m_.model.options, m_.model.grid.cell, end_time);
        if (filter.is_due()) {
          m_.timers.time("filter", [&] { filter.run(); });
          m_.driver.rouse();  // what it moved, the step moves farther
        }
        step.clear();
        Scheme::run(step);
        m_.timers.time("sort", [&] { arrange(step.exits(), Shape::support); });
        state.time = next_time;  // (7)
        ++state.cycle;
      }
    };
    with_shape([&]<class Shape>(Shape shape) {
      switch (m_.model.options.scheme) {
        case Scheme::usf:
          return with_scheme(shape, Usf{});
        case Scheme::musl:
          return with_scheme(shape, Musl{});
        case Scheme::usl:
          return with_scheme(shape, Usl{});
        case Scheme::usavg:
          return with_scheme(shape, Usavg{});
      }
    });
    return m_.state.cycle - start;
  }

  Ledger ledger() const {
    const auto& state = m_.state;
    const double unit = m_.model.mass_unit;
    Ledger l = energies(m_.model, m_.driver);
    l.absorbed = unit * state.absorbed;
    l.pic = unit * state.pic;
    l.contact = unit * state.contact;
    l.left_kinetic = state.departed.kinetic;
    l.left_internal = state.departed.internal;
    l.filtered = unit * state.filtered;
    l.viscous = unit * state.audit.viscous_work;
    l.plastic = unit * state.audit.plastic_work;
    l.initial = state.initial;
    return l;
  }

  // Where F::restores it does for a solver without points what place() and initialize() do. See
  // Machine::for_each_part.
  template <class F>
  void for_each_part(F&& f) {
    if constexpr (std::remove_cvref_t<F>::restores) begin_anchorage();
    m_.for_each_part(f);
  }
  // To be called when points were changed from outside.
  void wake() {
    m_.driver.wake();
    m_.state.is_mapped = false;
  }

 private:
  void begin_anchorage() {
    m_.transmitting.anchorage().begin(m_.model.grid, m_.model.materials.size());
    anchorage_bytes_ = m_.transmitting.anchorage().bytes();
  }
  template <class F>
  void with_shape(F&& f) {
    if (m_.model.options.shape == ShapeFunction::trilinear)
      f(Linear<T>{});
    else
      f(Quadratic<T>{});
  }
  void require_one_a_body(const std::vector<std::uint8_t>& values, const char* who) const {
    if (values.size() != m_.model.materials.size())
      throw std::invalid_argument(std::string(who) + ": a number a body is needed");
  }

  // Notes the fastest wave at the start, and how fast points may meet.
  void note_first_speeds() {
    auto& state = m_.state;
    Vec3<T> least{}, most{};
    for (std::size_t p = 0; p < points().count; ++p) {
      const auto& m = m_.model.materials[points().body[p]];
      const auto v = points().vector(Field::velocity, p);
      if (p == 0) least = most = v;
      for (int a = 0; a < 3; ++a) {
        least[a] = min(least[a], v[a]);
        most[a] = max(most[a], v[a]);
      }
      state.extremes.wave_speed =
          std::max(state.extremes.wave_speed, double(m.dilatational_speed() + std::sqrt(dot(v, v))));
    }
    // Their images move too.
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      if (!m_.model.grid.is_symmetric[face]) continue;
      most[axis] = max(most[axis], -least[axis]);
      least[axis] = min(least[axis], -most[axis]);
    }
    const auto spread = most - least;
    state.closing_speed = std::sqrt(double(dot(spread, spread)));
  }

  void arrange(const std::vector<std::vector<Exit>>& exits, int support) {
    for (const auto& slot : exits)
      for (const Exit& exit : slot) account_for(exit);
    if (m_.driver.arrange(support, m_.state.cycle == 0)) m_.state.is_mapped = false;
  }

  void account_for(const Exit& exit) {
    const auto v = points().vector(Field::velocity, exit.point);
    if (!std::isfinite(dot(v, v))) throw std::runtime_error("a point's velocity is no longer a number");
    Ledger left;
    add_point(left, m_.model, points(), exit.point);
    auto& state = m_.state;
    state.departed.mass += left.mass;
    state.departed.momentum += left.momentum;
    state.departed.kinetic += left.kinetic;
    state.departed.internal += left.internal;
    const Face face = m_.model.faces[exit.face];
    const bool expected = face == Face::free || face == Face::transmitting;
    state.audit.count(expected ? Counter::left_points : Counter::lost_points);
    --state.live;
  }

  Machine<Driver> m_;
  std::vector<Exit> outside_;  // points that were put outside the grid
  std::size_t anchorage_bytes_ = 0;
};

}  // namespace pockmark
