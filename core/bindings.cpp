// The Python extension: names and conversions only. Defaults live in Python.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <stdexcept>

#include "bandwidth.hpp"
#include "bind_materials.hpp"
#include "cpu/driver.hpp"
#include "method/solver.hpp"
#include "plain/driver.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace pockmark;

namespace {

#ifdef POCKMARK_LANES
constexpr bool has_lanes = true;
template <class T>
using CpuDriver = cpu::Driver<T, Lanes<T>>;
#else
constexpr bool has_lanes = false;
template <class T>
using CpuDriver = cpu::Driver<T, T>;
#endif

// Whether the processor has these levels of x86-64. Clang before 18 knows their parts by name, not the
// levels.
#ifdef __x86_64__
#if defined(__clang__) && __clang_major__ < 18
bool has_x86_64_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
bool has_x86_64_v4() {
  return has_x86_64_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
#else
bool has_x86_64_v3() { return __builtin_cpu_supports("x86-64-v3"); }
bool has_x86_64_v4() { return __builtin_cpu_supports("x86-64-v4"); }
#endif
#endif

using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

template <class V>
nb::object to_array(std::vector<V> values, std::size_t dimensions, const std::size_t* shape) {
  auto* owned = new std::vector<V>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<V>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, V>(owned->data(), dimensions, shape, owner));
}
template <class V>
nb::object to_array(std::vector<V> values, std::size_t rows, std::size_t columns) {
  const std::size_t shape[2] = {rows, columns};
  return to_array(std::move(values), columns == 1 ? 1 : 2, shape);
}

// Runs the stress update alone, as the step does, on rows of states: volume, energy, pressure, viscosity,
// plastic_strain, temperature, damage, then the deviator; gradients: D (6), axial spin vector (3). Returns
// the states after it and the sound speed.
struct StressProbe {
  static constexpr int in = 13, out = 14;
  static constexpr Field fields[7]{Field::dilation,  Field::energy,         Field::pressure,
                                   Field::viscosity, Field::plastic_strain, Field::temperature,
                                   Field::damage};

  template <class V>
  static std::vector<double> run(const MaterialSpec& spec, Doubles states, Doubles gradients, double mass,
                                 double cell, double dt) {
    const std::vector<Material<double>> materials{spec.as<double>()};
    const double reference_volume = mass * materials[0].specific_volume;
    const std::size_t n = states.size() / in;
    PointStore<double> store;
    store.resize(n);
    const auto points = store.view();
    std::vector<double> rows(out * n);
    const auto component = [&](int c, std::size_t p) -> double& {
      return c < 7 ? points.at(fields[c])[p] : points.at(Field::deviator, c - 7)[p];
    };
    for (std::size_t p = 0; p < n; ++p) {
      points.at(Field::mass)[p] = mass;
      for (int c = 0; c < in; ++c) component(c, p) = states.data()[p * in + c];
      component(0, p) = component(0, p) / reference_volume - 1;
    }
    const auto update = [&](const Points<double>& of, std::size_t begin, std::size_t end) {
      const Block block{begin, end, true, 0, nullptr};
      StrainColumns<double> strains;
      for (std::size_t p = begin; p < end; ++p) {
        const double* d = gradients.data() + 9 * p;
        store_strain(strains, p - begin,
                     Strain<double>(dt * Sym3<double>{d[0], d[1], d[2], d[3], d[4], d[5]},
                                    dt / 2 * Vec3<double>{d[6], d[7], d[8]}));
      }
      Audit audit;
      Columns<double, 6> push;
      update_stress<V, NoHints>(of, materials.data(), cell, block, strains, {dt, dt, 0.5, 0.5}, audit, push);
      return audit.wave_speed;
    };
    auto copy = store;
    const auto alone = copy.view();  // at rest and one by one, the fastest wave is the sound speed
    for (std::size_t p = 0; p < n; ++p) rows[p * out + in] = update(alone, p, p + 1);
    for (std::size_t begin = 0; begin < n; begin += Block::most)
      update(points, begin, std::min(begin + Block::most, n));
    for (std::size_t p = 0; p < n; ++p) {
      component(0, p) = (1 + component(0, p)) * reference_volume;
      for (int c = 0; c < in; ++c) rows[p * out + c] = component(c, p);
    }
    return rows;
  }

  static nb::object choose(const MaterialSpec& spec, Doubles states, Doubles gradients, double mass,
                           double cell, double dt, bool lanes) {
    const std::size_t n = states.size() / in;
    if (gradients.size() != 9 * n) throw std::invalid_argument("gradients: nine numbers a state are needed");
#ifdef POCKMARK_LANES
    if (lanes) return to_array(run<Lanes<double>>(spec, states, gradients, mass, cell, dt), n, out);
#else
    if (lanes) throw std::invalid_argument("this core was built without SIMD lanes");
#endif
    return to_array(run<double>(spec, states, gradients, mass, cell, dt), n, out);
  }
};

// log x, exp x or x^n of each number.
template <class V>
std::vector<double> elementary(const std::string& name, Doubles x, double n) {
  constexpr int width = Pack<V>::width;
  std::vector<double> in(x.data(), x.data() + x.size()), out(x.size() + width);
  in.resize(x.size() + width, 1.0);
  for (std::size_t i = 0; i < x.size(); i += width) {
    const V v = Pack<V>::load(in.data() + i);
    Pack<V>::store(out.data() + i, name == "log"         ? fast_log(v)
                                   : name == "rough_log" ? rough_log(v)
                                   : name == "exp"       ? fast_exp(v)
                                                         : fast_pow(v, n));
  }
  out.resize(x.size());
  return out;
}

const FieldInfo& field_named(const std::string& name) {
  for (const auto& info : field_table)
    if (name == info.name) return info;
  throw std::invalid_argument("no field is named '" + name + "'");
}

// A field between what the core keeps and what a user knows: the same, but for the volume, kept as V/V0 - 1,
// and the mass, in a unit of the solver's.
template <class D>
double to_user(const Solver<D>& solver, Field field, std::size_t p, double kept) {
  if (field == Field::mass) return kept * solver.model().mass_unit;
  return field == Field::dilation ? (1 + kept) * solver.model().reference_volume(solver.points(), p) : kept;
}
template <class D>
double from_user(const Solver<D>& solver, Field field, std::size_t p, double given) {
  if (field == Field::mass) return given / solver.model().mass_unit;
  return field == Field::dilation ? given / solver.model().reference_volume(solver.points(), p) - 1 : given;
}

// A field of the points that have not left.
template <class D>
nb::object get_field(const Solver<D>& solver, const std::string& name) {
  const auto& points = solver.points();
  const std::size_t n = solver.state().live;
  // `values(p)`: a row, as an array.
  const auto rows = [&](auto&& values) {
    using Row = decltype(values(std::size_t(0)));
    std::vector<typename Row::value_type> out;
    constexpr std::size_t columns = std::tuple_size_v<Row>;
    out.reserve(n * columns);
    for_each_point(points, [&](std::size_t p) {
      const Row row = values(p);
      out.insert(out.end(), row.begin(), row.end());
    });
    return to_array(std::move(out), n, columns);
  };
  if (name == "body") return rows([&](std::size_t p) { return std::array{points.body[p]}; });
  if (name == "id") return rows([&](std::size_t p) { return std::array{points.id[p]}; });
  const auto& info = field_named(name);
  if (info.field == Field::place)
    return rows([&](std::size_t p) {
      const auto x = position_of(solver.model().grid, points, p);
      return std::array{x.x, x.y, x.z};
    });
  if (info.field == Field::deviator)
    return rows([&](std::size_t p) {
      const auto s = settled_deviator(solver.model(), points, p, typename D::Number(solver.state().dt));
      return std::array{double(s.xx), double(s.yy), double(s.zz), double(s.xy), double(s.yz), double(s.zx)};
    });
  const auto kept = [&](std::size_t p, int c) {
    return to_user(solver, info.field, p, double(points.at(info.field, c)[p]));
  };
  if (info.components == 3)
    return rows([&](std::size_t p) { return std::array{kept(p, 0), kept(p, 1), kept(p, 2)}; });
  return rows([&](std::size_t p) { return std::array{kept(p, 0)}; });
}

template <class D>
void set_field(Solver<D>& solver, const std::string& name, Doubles values) {
  using T = typename D::Number;
  const auto& points = solver.points();
  const auto& info = field_named(name);
  if (info.field == Field::place) throw std::invalid_argument("points are placed when they are added");
  if (values.size() != std::size_t(solver.state().live) * info.components)
    throw std::invalid_argument(name + ": wrong size");
  solver.wake();
  const double* value = values.data();
  for_each_point(points, [&](std::size_t p) {
    for (int c = 0; c < info.components; ++c)
      points.at(info.field, c)[p] = T(from_user(solver, info.field, p, *value++));
  });
}

template <class D>
void add_points(Solver<D>& solver, const std::vector<MaterialSpec>& materials, Doubles position,
                Doubles velocity, Doubles mass, Doubles volume,
                nb::ndarray<const std::uint8_t, nb::c_contig, nb::device::cpu> body) {
  using T = typename D::Number;
  const std::size_t old = solver.points().count, n = mass.size();
  if (position.size() != 3 * n || velocity.size() != 3 * n || volume.size() != n || body.size() != n)
    throw std::invalid_argument("add_points: arrays of different lengths");
  if (old + n >= UINT32_MAX) throw std::invalid_argument("add_points: more than 4 billion points");
  solver.resize(old + n);
  const auto& points = solver.points();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t p = old + i;
    if (body.data()[i] >= materials.size())
      throw std::invalid_argument("add_points: a body without a material");
    points.body[p] = body.data()[i];
    const double* x = position.data() + 3 * i;
    solver.place(p, {x[0], x[1], x[2]});
    for (int a = 0; a < 3; ++a) points.at(Field::velocity, a)[p] = T(velocity.data()[3 * i + a]);
    // Points at the density of their material are kept with V/V0 - 1 = 0 exactly: they have no stress at all.
    const double density = materials[body.data()[i]].density;
    points.at(Field::mass)[p] = T(mass.data()[i] / solver.model().mass_unit);
    points.at(Field::dilation)[p] = T(volume.data()[i] * density / mass.data()[i] - 1);
    points.at(Field::temperature)[p] = T(materials[body.data()[i]].room_temperature);
    points.id[p] = std::uint32_t(p);
  }
}

template <class D>
nb::dict get_ledger(const Solver<D>& solver) {
  const auto l = solver.ledger();
  const auto& momentum = l.momentum;
  const auto& departed = solver.state().departed;
  nb::dict d;
  d["time"] = solver.state().time;
  d["kinetic"] = l.kinetic, d["internal"] = l.internal, d["absorbed"] = l.absorbed,
  d["left_kinetic"] = l.left_kinetic, d["left_internal"] = l.left_internal;
  d["left_energy"] = l.left_kinetic + l.left_internal;
  d["pic"] = l.pic, d["contact"] = l.contact, d["viscous"] = l.viscous, d["plastic"] = l.plastic;
  d["initial"] = l.initial, d["error"] = l.error();
  d["momentum_x"] = momentum.x, d["momentum_y"] = momentum.y, d["momentum_z"] = momentum.z;
  d["mass"] = l.mass, d["left_mass"] = departed.mass;
  d["left_momentum_x"] = departed.momentum.x, d["left_momentum_y"] = departed.momentum.y;
  d["left_momentum_z"] = departed.momentum.z;
  return d;
}

// Makes a dictionary of the parts of a solver: numbers, and arrays of which long ones are views that keep
// `owner`.
struct Saver {
  static constexpr bool restores = false;
  nb::dict& out;
  nb::handle owner;

  template <class V>
  void operator()(const std::string& name, const V& number) {
    out[name.c_str()] = number;
  }
  template <class V, class A>
  void operator()(const std::string& name, const std::vector<V, A>& values) {
    const std::size_t shape[1] = {values.size()};
    if constexpr (std::is_same_v<A, std::allocator<V>>)
      out[name.c_str()] = to_array(values, 1, shape);
    else
      out[name.c_str()] = nb::ndarray<nb::numpy, const V>(values.data(), 1, shape, owner);
  }
};

// Takes the parts of a solver out of such a dictionary, or of another mapping, one at a time. Throws
// std::invalid_argument where one is missing.
struct Restorer {
  static constexpr bool restores = true;
  const nb::object& in;

  nb::object at(const std::string& name) const {
    nb::object found = in.attr("get")(name);
    if (found.is_none()) throw std::invalid_argument(name + ": is missing");
    return found;
  }
  template <class V>
  void operator()(const std::string& name, V& number) const {
    if (!nb::try_cast(at(name), number)) throw std::invalid_argument(name + ": is no such number");
  }
  template <class V, class A>
  void operator()(const std::string& name, std::vector<V, A>& values) const {
    nb::ndarray<const V, nb::ndim<1>, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(at(name), given, false)) throw std::invalid_argument(name + ": is no such array");
    values.assign(given.data(), given.data() + given.size());
  }
};

template <class D>
struct PySolver {
  using T = typename D::Number;
  std::vector<MaterialSpec> materials;
  Solver<D> solver;

  PySolver(std::array<double, 3> lower, double cell, std::array<int, 3> cells, const std::vector<Face>& faces,
           std::vector<MaterialSpec> specs, const Options& options, int threads)
      : materials(std::move(specs)), solver(make(lower, cell, cells, faces, materials, options, threads)) {}

  static Solver<D> make(std::array<double, 3> lower, double cell, std::array<int, 3> cells,
                        const std::vector<Face>& faces, const std::vector<MaterialSpec>& specs,
                        const Options& options, int threads) {
    if (faces.size() != 6) throw std::invalid_argument("faces: six are needed");
    GridGeometry<T> geometry{{T(lower[0]), T(lower[1]), T(lower[2])}, T(cell), cells};
    if (geometry.node_count() >= UINT32_MAX) throw std::invalid_argument("cells: more than 4 billion nodes");
    Faces six;
    std::copy(faces.begin(), faces.end(), six.begin());
    std::vector<Material<T>> materials;
    for (const auto& s : specs) materials.push_back(s.as<T>());
    return {geometry, six, std::move(materials), options, threads};
  }
};

template <class D>
void bind_solver(nb::module_& m, const char* name) {
  using S = PySolver<D>;
  nb::class_<S>(m, name)
      .def(nb::init<std::array<double, 3>, double, std::array<int, 3>, const std::vector<Face>&,
                    std::vector<MaterialSpec>, const Options&, int>(),
           "lower"_a, "cell"_a, "cells"_a, "faces"_a, "materials"_a, "options"_a, "threads"_a)
      .def(
          "set_contact",
          [](S& s, const std::vector<std::uint8_t>& in_second, double friction) {
            if (s.solver.points().count > 0)
              throw std::invalid_argument("set_contact: comes before the points");
            s.solver.set_contact(in_second, friction);
          },
          "in_second"_a, "friction"_a)
      .def(
          "let_fly", [](S& s, const std::vector<std::uint8_t>& flies) { s.solver.let_fly(flies); }, "flies"_a)
      .def(
          "reserve", [](S& s, std::size_t points) { s.solver.reserve(points); }, "points"_a)
      .def(
          "add_points",
          [](S& s, Doubles x, Doubles v, Doubles m, Doubles vol,
             nb::ndarray<const std::uint8_t, nb::c_contig, nb::device::cpu> body) {
            add_points(s.solver, s.materials, x, v, m, vol, body);
          },
          "position"_a, "velocity"_a, "mass"_a, "volume"_a, "body"_a)
      .def("initialize", [](S& s) { s.solver.initialize(); })
      .def(
          "advance",
          [](S& s, std::int64_t max_steps, double end, double pause) {
            return s.solver.advance(max_steps, end, pause);
          },
          "max_steps"_a, "end_time"_a, "pause"_a = std::numeric_limits<double>::infinity(),
          nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("time", [](const S& s) { return s.solver.state().time; })
      .def_prop_ro("dt", [](const S& s) { return s.solver.state().dt; })
      .def_prop_ro("cycle", [](const S& s) { return s.solver.state().cycle; })
      .def_prop_ro("points", [](const S& s) { return s.solver.state().live; })
      .def_prop_ro("cells",
                   [](const S& s) {
                     const auto& c = s.solver.model().grid.cells;
                     return std::int64_t(c[0]) * c[1] * c[2];
                   })
      .def(
          "field", [](const S& s, const std::string& name) { return get_field(s.solver, name); }, "name"_a)
      .def(
          "set_field", [](S& s, const std::string& name, Doubles v) { set_field(s.solver, name, v); },
          "name"_a, "values"_a)
      // Share of the space around each node, the rim of nodes included, that some bodies fill.
      .def(
          "volume_fraction",
          [](const S& s, const std::vector<std::uint8_t>& counts) {
            if (counts.size() != s.materials.size())
              throw std::invalid_argument("volume_fraction: a number a body is needed");
            const auto& g = s.solver.model().grid;
            const std::size_t shape[3] = {std::size_t(g.nodes(0)), std::size_t(g.nodes(1)),
                                          std::size_t(g.nodes(2))};
            return to_array(volume_fraction(s.solver.model(), s.solver.driver(), counts), 3, shape);
          },
          "counts"_a)
      .def("ledger", [](const S& s) { return get_ledger(s.solver); })
      .def("counters",
           [](const S& s) {
             nb::dict d;
             for (std::size_t i = 0; i < counter_names.size(); ++i)
               d[counter_names[i]] = s.solver.state().audit.counts[i];
             return d;
           })
      // Of the points that are in an impossible state now: how many, and the corners of a box around them
      // (m).
      .def("impossible",
           [](const S& s) {
             nb::dict d;
             for (const auto& [counter, where] : impossible(s.solver.model(), s.solver.points()))
               d[counter_names[std::size_t(counter)]] =
                   nb::make_tuple(where.points, where.lower, where.upper);
             return d;
           })
      .def("max_compression", [](const S& s) { return s.solver.state().audit.compression; })
      .def_prop_ro("sorts", [](const S& s) { return s.solver.driver().sorts(); })
      .def_prop_ro("sleeping_points", [](const S& s) { return s.solver.driver().sleeping_points(); })
      .def("timers", [](const S& s) { return s.solver.timers().seconds(); })
      // All that a step reads of the steps before it, by name; and back, into a solver without points.
      .def("save",
           [](nb::handle self) {
             nb::dict out;
             nb::cast<S&>(self).solver.for_each_part(Saver{out, self});
             return out;
           })
      .def(
          "restore", [](S& s, const nb::object& parts) { s.solver.for_each_part(Restorer{parts}); },
          "parts"_a)
      .def("memory_bytes", [](const S& s) {
        nb::dict d;
        d["points"] = s.solver.driver().point_bytes(), d["grid"] = s.solver.node_bytes();
        return d;
      });
}

}  // namespace

NB_MODULE(POCKMARK_MODULE, m) {
  nb::enum_<Face>(m, "Face")
      .value("free", Face::free)
      .value("symmetry", Face::symmetry)
      .value("fixed", Face::fixed)
      .value("transmitting", Face::transmitting);
  nb::enum_<Scheme>(m, "Scheme")
      .value("usf", Scheme::usf)
      .value("musl", Scheme::musl)
      .value("usl", Scheme::usl)
      .value("usavg", Scheme::usavg);
  nb::enum_<ShapeFunction>(m, "ShapeFunction")
      .value("trilinear", ShapeFunction::trilinear)
      .value("quadratic", ShapeFunction::quadratic);
  bind_materials(m);
  nb::class_<Options>(m, "Options")
      .def(
          "__init__",
          [](Options* self, Scheme scheme, ShapeFunction shape, double cfl, double strain_limit,
             double pic_fraction, double mass_cutoff, bool sleep) {
            new (self) Options{scheme, shape, cfl, strain_limit, pic_fraction, mass_cutoff, sleep};
          },
          "scheme"_a, "shape"_a, "cfl"_a, "strain_limit"_a, "pic_fraction"_a, "mass_cutoff"_a, "sleep"_a);

  bind_solver<CpuDriver<double>>(m, "Solver");
  bind_solver<CpuDriver<float>>(m, "SolverSingle");
  bind_solver<plain::Driver<double>>(m, "PlainSolver");
  bind_solver<plain::Driver<float>>(m, "PlainSolverSingle");

  m.def("fields", [] {
    nb::list out;
    for (const auto& info : field_table) {
      nb::dict d;
      d["name"] = info.name, d["components"] = info.components, d["unit"] = info.unit;
      d["description"] = info.description;
      out.append(d);
    }
    return out;
  });
  // One stress update of given states and velocity gradients: for tests against independent references.
  m.def("update_stress", &StressProbe::choose, "material"_a, "states"_a, "gradients"_a, "mass"_a, "cell"_a,
        "dt"_a, "lanes"_a);
  m.def(
      "elementary",
      [](const std::string& name, Doubles x, double n, [[maybe_unused]] bool lanes) {
        const std::size_t count = x.size();
#ifdef POCKMARK_LANES
        if (lanes) return to_array(elementary<Lanes<double>>(name, x, n), count, 1);
#endif
        return to_array(elementary<double>(name, x, n), count, 1);
      },
      "name"_a, "x"_a, "n"_a, "lanes"_a);
  m.def("build_info", [] {
    nb::dict d;
    d["compiler"] = __VERSION__;
    d["flags"] = POCKMARK_FLAGS;
    d["isa"] = POCKMARK_ISA;
    d["lanes"] = has_lanes;
#ifdef _OPENMP
    d["openmp"] = true;
#else
    d["openmp"] = false;
#endif
    return d;
  });
  // Instruction sets that pockmark is built for and this processor has, the best first.
  m.def("supported_isas", [] {
    std::vector<std::string> isas;
#ifdef __x86_64__
    if (has_x86_64_v4()) isas.push_back("avx512");
    if (has_x86_64_v3()) isas.push_back("avx2");
#endif
    isas.push_back("scalar");
    return isas;
  });
  m.def("copy_bandwidth", &copy_bandwidth, "threads"_a, nb::call_guard<nb::gil_scoped_release>());
}
