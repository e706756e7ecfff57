// Material points: who owns their arrays, and what the kernels see of them.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "array.hpp"
#include "fields.hpp"
#include "tensor.hpp"

namespace pockmark {

// One material point as the constitutive update sees it.
template <class V>
struct PointState {
  V dilation;  // V/V0 - 1: small strains keep all their digits
  V energy, pressure, viscosity, plastic_strain, temperature, damage;
  Sym3<V> deviator;

  PM_HD V ratio() const { return V(1) + dilation; }  // V/V0 = rho0/rho
};
template <class M, class V>
PM_HD PointState<V> select(M m, const PointState<V>& a, const PointState<V>& b) {
  return {select(m, a.dilation, b.dilation),
          select(m, a.energy, b.energy),
          select(m, a.pressure, b.pressure),
          select(m, a.viscosity, b.viscosity),
          select(m, a.plastic_strain, b.plastic_strain),
          select(m, a.temperature, b.temperature),
          select(m, a.damage, b.damage),
          select(m, a.deviator, b.deviator)};
}

// The cell of a point that has left the grid.
inline constexpr std::uint32_t gone = UINT32_MAX;

// What the kernels see of the points: an array a component, side by side, in the driver's order. It may be
// copied to a device as it is.
template <class T>
struct Points {
  T* components[component_count];
  std::uint8_t* body;
  std::uint32_t* id;    // order in which the points were added
  std::uint32_t* cell;  // first node of the point's stencil
  std::size_t count;    // those that are gone included

  PM_HD T* at(Field field, int component = 0) const { return components[first_component(field) + component]; }

  // Of point p, or of the n points from p on in the lanes of V.
  template <class V = T>
  PM_HD V load(Field field, std::size_t p, int n = Pack<V>::width, int component = 0) const {
    return Pack<V>::load(at(field, component) + p, n);
  }
  template <class V = T>
  PM_HD Vec3<V> vector(Field field, std::size_t p, int n = Pack<V>::width) const {
    return {load<V>(field, p, n, 0), load<V>(field, p, n, 1), load<V>(field, p, n, 2)};
  }
  template <class V>
  PM_HD void set_vector(Field field, std::size_t p, const Vec3<V>& v, int n = Pack<V>::width) const {
    for (int a = 0; a < 3; ++a) Pack<V>::store(at(field, a) + p, v[a], n);
  }
  template <class V = T>
  PM_HD Sym3<V> deviator(std::size_t p, int n = Pack<V>::width) const {
    const auto s = [&](int c) { return load<V>(Field::deviator, p, n, c); };
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  template <class V = T>
  PM_HD PointState<V> state(std::size_t p, int n = Pack<V>::width) const {
    return {load<V>(Field::dilation, p, n),       load<V>(Field::energy, p, n),
            load<V>(Field::pressure, p, n),       load<V>(Field::viscosity, p, n),
            load<V>(Field::plastic_strain, p, n), load<V>(Field::temperature, p, n),
            load<V>(Field::damage, p, n),         deviator<V>(p, n)};
  }
  // What each stage of an update changes.
  template <class V>
  PM_HD void store_deviator(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) const {
    const V d[6] = {s.deviator.xx, s.deviator.yy, s.deviator.zz, s.deviator.xy, s.deviator.yz, s.deviator.zx};
    for (int c = 0; c < 6; ++c) Pack<V>::store(at(Field::deviator, c) + p, d[c], n);
  }
  template <class V>
  PM_HD void store_strained(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) const {
    Pack<V>::store(at(Field::dilation) + p, s.dilation, n);
    Pack<V>::store(at(Field::energy) + p, s.energy, n);
    store_deviator(p, s, n);
  }
  template <class V>
  PM_HD void store_returned(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) const {
    store_deviator(p, s, n);
    Pack<V>::store(at(Field::plastic_strain) + p, s.plastic_strain, n);
  }
  template <class V>
  PM_HD void store_pressed(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) const {
    Pack<V>::store(at(Field::energy) + p, s.energy, n);
    Pack<V>::store(at(Field::pressure) + p, s.pressure, n);
    Pack<V>::store(at(Field::viscosity) + p, s.viscosity, n);
  }
  template <class V>
  PM_HD void store(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) const {
    store_strained(p, s, n);
    Pack<V>::store(at(Field::pressure) + p, s.pressure, n);
    Pack<V>::store(at(Field::viscosity) + p, s.viscosity, n);
    Pack<V>::store(at(Field::plastic_strain) + p, s.plastic_strain, n);
    Pack<V>::store(at(Field::temperature) + p, s.temperature, n);
    Pack<V>::store(at(Field::damage) + p, s.damage, n);
  }
};

// The arrays of the points.
template <class T>
struct PointStore {
  std::array<Array<T>, component_count> components;
  std::vector<std::uint8_t> body;
  std::vector<std::uint32_t> id, cell;

  std::size_t size() const { return body.size(); }
  // f(array) for each of them.
  template <class F>
  void for_each_array(F&& f) {
    for (auto& component : components) f(component);
    f(body), f(id), f(cell);
  }
  void reserve(std::size_t count) {
    for_each_array([&](auto& array) { array.reserve(count); });
  }
  void resize(std::size_t count) {
    for_each_array([&](auto& array) { array.resize(count); });
  }
  // See Machine::for_each_part. Components are called by their field, with a number where it has several.
  template <class F>
  void for_each_part(F&& f) {
    for (const FieldInfo& info : field_table)
      for (int c = 0; c < info.components; ++c) {
        std::string name = std::string("points.") + info.name;
        if (info.components > 1) name.append(".").append(std::to_string(c));
        f(name, components[first_component(info.field) + c]);
      }
    f("points.body", body), f("points.id", id), f("points.cell", cell);
  }
  bool is_whole() const {
    return std::ranges::all_of(components, [&](const auto& c) { return c.size() == size(); }) &&
           id.size() == size() && cell.size() == size();
  }
  Points<T> view() {
    Points<T> points;
    for (int c = 0; c < component_count; ++c) points.components[c] = components[c].data();
    points.body = body.data(), points.id = id.data(), points.cell = cell.data(), points.count = size();
    return points;
  }
};

}  // namespace pockmark
