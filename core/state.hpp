// Material points and background grid: owners (vectors) and what the kernels see of them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fields.hpp"
#include "tensor.hpp"

namespace pockmark {

// One material point as the constitutive update sees it.
template <class T>
struct PointState {
  T volume, energy, pressure, viscosity, plastic_strain, temperature, damage;
  Sym3<T> deviator;
};

// Structure of arrays, one array a component, in the order of the background grid's cells.
template <class T>
struct Particles {
  std::array<std::vector<T>, component_count> components;
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
  void resize(std::size_t count) {
    for (auto& c : components) c.resize(count);
    body.resize(count);
    id.resize(count);
    cell.resize(count);
  }

  PM_HD Vec3<T> vector(Field field, std::size_t p) const {
    return {at(field, 0)[p], at(field, 1)[p], at(field, 2)[p]};
  }
  PM_HD void set_vector(Field field, std::size_t p, const Vec3<T>& v) {
    at(field, 0)[p] = v.x, at(field, 1)[p] = v.y, at(field, 2)[p] = v.z;
  }
  PM_HD Sym3<T> deviator(std::size_t p) const {
    const auto s = [&](int c) { return at(Field::deviator, c)[p]; };
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  PM_HD PointState<T> load(std::size_t p) const {
    return {at(Field::volume)[p],         at(Field::energy)[p],
            at(Field::pressure)[p],       at(Field::viscosity)[p],
            at(Field::plastic_strain)[p], at(Field::temperature)[p],
            at(Field::damage)[p],         deviator(p)};
  }
  // What a strain under a given stress changes.
  PM_HD void store_strained(std::size_t p, const PointState<T>& s) {
    at(Field::volume)[p] = s.volume;
    at(Field::energy)[p] = s.energy;
    const T d[6] = {s.deviator.xx, s.deviator.yy, s.deviator.zz, s.deviator.xy, s.deviator.yz, s.deviator.zx};
    for (int c = 0; c < 6; ++c) at(Field::deviator, c)[p] = d[c];
  }
  PM_HD void store(std::size_t p, const PointState<T>& s) {
    store_strained(p, s);
    at(Field::pressure)[p] = s.pressure;
    at(Field::viscosity)[p] = s.viscosity;
    at(Field::plastic_strain)[p] = s.plastic_strain;
    at(Field::temperature)[p] = s.temperature;
    at(Field::damage)[p] = s.damage;
  }
  // Cauchy stress with the bulk viscosity: what the nodes feel.
  PM_HD Sym3<T> stress(std::size_t p) const {
    Sym3<T> s = deviator(p);
    const T mean = at(Field::pressure)[p] + at(Field::viscosity)[p];
    s.xx -= mean, s.yy -= mean, s.zz -= mean;
    return s;
  }
};

// A uniform grid with one layer of nodes outside each face, for stencils of three nodes an axis.
template <class T>
struct GridGeometry {
  static constexpr int pad = 1;
  Vec3<T> lower{};
  T cell = 1;
  T per_metre = 1;  // 1/cell
  std::array<int, 3> cells{};

  GridGeometry() = default;
  GridGeometry(const Vec3<T>& lower_, T cell_, const std::array<int, 3>& cells_)
      : lower(lower_), cell(cell_), per_metre(T(1) / cell_), cells(cells_) {}

  PM_HD int nodes(int axis) const { return cells[axis] + 1 + 2 * pad; }
  std::size_t node_count() const { return std::size_t(nodes(0)) * nodes(1) * nodes(2); }
  PM_HD std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * nodes(1) + j) * nodes(2) + k;
  }
  T upper(int axis) const { return lower[axis] + cells[axis] * cell; }
  // Position in units of cells from the first (padding) node.
  PM_HD T local(T x, int axis) const { return (x - lower[axis]) * per_metre + pad; }
};

template <class T>
struct Grid {
  GridGeometry<T> geometry;
  std::vector<Quad<T>> before;    // momentum, then velocity, before the forces act; mass
  std::vector<Quad<T>> force;     // internal force
  std::vector<Quad<T>> damping;   // transmitting faces: sum of rho c A, an entry a direction (kg/s)
  std::vector<Quad<T>> after;     // velocity after the forces acted
  std::vector<Quad<T>> remapped;  // the points' new velocity mapped back (MUSL, USAVG)

  T mass(std::size_t node) const { return before[node].v[3]; }
  void allocate(const GridGeometry<T>& g) {
    geometry = g;
    for (auto* field : {&before, &force, &damping, &after, &remapped}) field->assign(g.node_count(), {});
  }
};

}  // namespace pockmark
