// Material points and background grid: owners (vectors) and what the kernels see of them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
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

// A node with less mass than this has a velocity of rounding only: its momentum is about as small as numbers
// get. Masses are in units of a full cell's (Solver), so nothing of weight is left out, however small a body.
template <class T>
inline constexpr T least_mass = std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon();

// The cell of a point that has left the grid.
inline constexpr std::uint32_t gone = UINT32_MAX;

// Structure of arrays, one array a component, in the order of the background grid's cells.
template <class T>
struct Particles {
  std::array<Array<T>, component_count> components;
  std::vector<std::uint8_t> body;
  std::vector<std::uint32_t> id;    // order in which the points were added
  std::vector<std::uint32_t> cell;  // first node of the point's stencil

  std::size_t size() const { return body.size(); }
  PM_HD T* at(Field field, int component = 0) {
    return components[first_component(field) + component].data();
  }
  PM_HD const T* at(Field field, int component = 0) const {
    return components[first_component(field) + component].data();
  }
  void reserve(std::size_t count) {
    for (auto& c : components) c.reserve(count);
    body.reserve(count);
    id.reserve(count);
    cell.reserve(count);
  }
  void resize(std::size_t count) {
    for (auto& c : components) c.resize(count);
    body.resize(count);
    id.resize(count);
    cell.resize(count);
  }

  // Asks the cache for fields of the points a few blocks on from p: their streams are too many for the
  // processor to foresee. Each loop asks for a share of them: the queue of lines under way is short.
  static constexpr std::size_t ahead = 144;
  template <class... Fields>
  PM_HD void prefetch(std::size_t p, Fields... fields) const {
    (prefetch_field(p, fields), ...);
  }
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
  PM_HD void set_vector(Field field, std::size_t p, const Vec3<V>& v, int n = Pack<V>::width) {
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
  PM_HD void store_deviator(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) {
    const V d[6] = {s.deviator.xx, s.deviator.yy, s.deviator.zz, s.deviator.xy, s.deviator.yz, s.deviator.zx};
    for (int c = 0; c < 6; ++c) Pack<V>::store(at(Field::deviator, c) + p, d[c], n);
  }
  template <class V>
  PM_HD void store_strained(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) {
    Pack<V>::store(at(Field::dilation) + p, s.dilation, n);
    Pack<V>::store(at(Field::energy) + p, s.energy, n);
    store_deviator(p, s, n);
  }
  template <class V>
  PM_HD void store_returned(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) {
    store_deviator(p, s, n);
    Pack<V>::store(at(Field::plastic_strain) + p, s.plastic_strain, n);
  }
  template <class V>
  PM_HD void store_pressed(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) {
    Pack<V>::store(at(Field::energy) + p, s.energy, n);
    Pack<V>::store(at(Field::pressure) + p, s.pressure, n);
    Pack<V>::store(at(Field::viscosity) + p, s.viscosity, n);
  }
  template <class V>
  PM_HD void store(std::size_t p, const PointState<V>& s, int n = Pack<V>::width) {
    store_strained(p, s, n);
    Pack<V>::store(at(Field::pressure) + p, s.pressure, n);
    Pack<V>::store(at(Field::viscosity) + p, s.viscosity, n);
    Pack<V>::store(at(Field::plastic_strain) + p, s.plastic_strain, n);
    Pack<V>::store(at(Field::temperature) + p, s.temperature, n);
    Pack<V>::store(at(Field::damage) + p, s.damage, n);
  }

 private:
  PM_HD void prefetch_field(std::size_t p, Field field) const {
#pragma GCC unroll 6
    for (int c = first_component(field); c < field_offsets[std::size_t(field) + 1]; ++c)
      __builtin_prefetch(components[c].data() + p + ahead, 1, 2);
  }
};

// A uniform grid with one layer of nodes outside each face, for stencils of three nodes an axis. With contact
// it carries a velocity field a body: the nodes of the second field follow those of the first in every array,
// and a point's cell says which field is its own, so that no kernel needs to know.
template <class T>
struct GridGeometry {
  static constexpr int pad = 1;
  Vec3<T> lower{};
  T cell = 1;
  T per_metre = 1;  // 1/cell
  std::array<int, 3> cells{};
  double per_plane = 1, per_row = 1;  // 1/nodes
  std::size_t field_count = 1;

  GridGeometry() = default;
  GridGeometry(const Vec3<T>& lower_, T cell_, const std::array<int, 3>& cells_)
      : lower(lower_), cell(cell_), per_metre(T(1) / cell_), cells(cells_) {
    per_plane = 1.0 / double(index(1, 0, 0)), per_row = 1.0 / double(index(0, 1, 0));
  }

  PM_HD int nodes(int axis) const { return cells[axis] + 1 + 2 * pad; }
  PM_HD std::size_t node_count() const { return std::size_t(nodes(0)) * nodes(1) * nodes(2); }  // of a field
  PM_HD std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * nodes(1) + j) * nodes(2) + k;
  }
  // The first node of the field that a node belongs to.
  PM_HD std::size_t field_of(std::size_t node) const {
    const std::size_t second = node_count();
    return field_count > 1 && node >= second ? second : 0;
  }
  // The inverse of index. Products are quicker than divisions; the half keeps them off whole numbers.
  PM_HD void split(std::size_t node, int (&ijk)[3]) const {
    node -= field_of(node);
    ijk[0] = int((double(node) + 0.5) * per_plane);
    const std::size_t in_plane = node - ijk[0] * index(1, 0, 0);
    ijk[1] = int((double(in_plane) + 0.5) * per_row);
    ijk[2] = int(in_plane - ijk[1] * index(0, 1, 0));
  }
};

template <class T>
struct Grid {
  GridGeometry<T> geometry;
  Array<Quad<T>> before;    // momentum, then velocity, before the forces act; mass
  Array<Quad<T>> after;     // internal force, then velocity after it acted
  Array<Quad<T>> damping;   // transmitting faces: sum of rho c A, an entry a direction (kg/s)
  Array<Quad<T>> remapped;  // MUSL, USAVG: the points' new velocity mapped back; USF: their next momentum

  T mass(std::size_t node) const { return before[node].v[3]; }
  bool has_mass(std::size_t node) const { return mass(node) > least_mass<T>; }
  void allocate(const GridGeometry<T>& g) {
    geometry = g;
    for (auto* field : {&before, &after, &damping, &remapped})
      field->assign(g.field_count * g.node_count(), {});
  }
};

}  // namespace pockmark
