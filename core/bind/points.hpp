// The points of a solver for Python: adding them, reading and writing their fields, the space that they fill.
#pragma once
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "py_solver.hpp"

namespace pockmark::bind {

inline nb::typed<nb::list, nb::typed<nb::dict, std::string, nb::any>> fields() {
  nb::list out;
  for (const auto& info : field_table) {
    nb::dict d;
    d["name"] = info.name;
    d["components"] = info.components;
    d["unit"] = info.unit;
    d["description"] = info.description;
    out.append(d);
  }
  return out;
}

template <class D>
void add_points(Solver<D>& solver, const std::vector<MaterialSpec>& materials, Doubles position,
                Doubles velocity, Doubles mass, Doubles volume, Bytes body) {
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

inline const FieldInfo& field_named(const std::string& name) {
  for (const auto& info : field_table)
    if (name == info.name) return info;
  throw std::invalid_argument("no field is named '" + name + "'");
}

// Convert a field between what the core keeps and what a user knows. They are the same, but for the volume,
// kept as V/V0 - 1, and the mass, kept in Model::mass_unit.
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

// Returns a field of the points that have not left.
template <class D>
nb::object get_field(const Solver<D>& solver, const std::string& name) {
  const auto& points = solver.points();
  const std::size_t n = solver.state().live;
  // values(p) is a row, as a std::array.
  const auto rows = [&](auto&& values) {
    using Row = decltype(values(std::size_t(0)));
    std::vector<typename Row::value_type> out;
    constexpr std::size_t columns = std::tuple_size_v<Row>;
    out.reserve(n * columns);
    for_each_point(points, [&](std::size_t p) {
      const Row row = values(p);
      out.insert(out.end(), row.begin(), row.end());
    });
    return nb::cast(to_array(std::move(out), n, columns));
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
NumPy<float> get_volume_fraction(const PySolver<D>& s, const std::vector<std::uint8_t>& counts) {
  if (counts.size() != s.materials.size())
    throw std::invalid_argument("volume_fraction: a number a body is needed");
  const auto& g = s.solver.model().grid;
  const std::size_t shape[3] = {std::size_t(g.nodes(0)), std::size_t(g.nodes(1)), std::size_t(g.nodes(2))};
  return to_array(volume_fraction(s.solver.model(), s.solver.driver(), counts), 3, shape);
}

template <class D>
void bind_points(SolverClass<D>& solver) {
  using S = PySolver<D>;
  solver
      .def(
          "reserve", [](S& s, std::size_t points) { s.solver.reserve(points); }, "points"_a,
          "Make room for a number of points.")
      .def(
          "add_points",
          [](S& s, Doubles x, Doubles v, Doubles m, Doubles volume, Bytes body) {
            add_points(s.solver, s.materials, x, v, m, volume, body);
          },
          "position"_a, "velocity"_a, "mass"_a, "volume"_a, "body"_a, "Add points, before `initialize`.")
      .def_prop_ro(
          "points", [](const S& s) { return s.solver.state().live; }, "Points that have not left.")
      .def(
          "field", [](const S& s, const std::string& name) { return get_field(s.solver, name); }, "name"_a,
          nb::sig("def field(self, name: str) -> numpy.typing.NDArray[typing.Any]"),
          "Return a field of the points that have not left, SI; also `body` and `id`.")
      .def(
          "set_field", [](S& s, const std::string& name, Doubles v) { set_field(s.solver, name, v); },
          "name"_a, "values"_a, "Change a field of the points that have not left, SI.")
      .def("volume_fraction", &get_volume_fraction<D>, "counts"_a,
           "Return the share of the space around each node, the rim of nodes included, that some bodies "
           "fill.");
}

}  // namespace pockmark::bind
