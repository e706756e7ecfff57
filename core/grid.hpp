// The background grid: its geometry, and what its nodes hold.
#pragma once
#include <array>
#include <cstddef>
#include <limits>

#include "array.hpp"
#include "tensor.hpp"

namespace pockmark {

// A node with less mass than this has a velocity of rounding only: its momentum is about as small as numbers
// get. Masses are in units of about a full cell's (Model::mass_unit), so nothing of weight is left out,
// however small a body.
template <class T>
inline constexpr T least_mass = std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon();

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
  double per_plane = 1, per_row = 1;   // 1 / nodes of a plane (one i), of a row (one i and j)
  std::size_t field_count = 1;         // velocity fields
  std::array<bool, 6> is_symmetric{};  // of each face: whether it is a plane of symmetry
  bool is_axisymmetric = false;        // x is a radius (hoop.hpp)

  GridGeometry() = default;
  GridGeometry(const Vec3<T>& lower_, T cell_, const std::array<int, 3>& cells_)
      : lower(lower_), cell(cell_), per_metre(T(1) / cell_), cells(cells_) {
    per_plane = 1.0 / double(index(1, 0, 0));
    per_row = 1.0 / double(index(0, 1, 0));
  }

  PM_HD int nodes(int axis) const { return cells[axis] + 1 + 2 * pad; }
  PM_HD std::size_t node_count() const { return std::size_t(nodes(0)) * nodes(1) * nodes(2); }  // of a field
  PM_HD std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * nodes(1) + j) * nodes(2) + k;
  }
  // Returns the first node of the velocity field that a node belongs to.
  PM_HD std::size_t field_of(std::size_t node) const {
    const std::size_t second = node_count();
    return field_count > 1 && node >= second ? second : 0;
  }
  // Undoes index(). Products are quicker than divisions; the half keeps them off whole numbers.
  PM_HD void split(std::size_t node, int (&ijk)[3]) const {
    node -= field_of(node);
    ijk[0] = int((double(node) + 0.5) * per_plane);
    const std::size_t in_plane = node - ijk[0] * index(1, 0, 0);
    ijk[1] = int((double(in_plane) + 0.5) * per_row);
    ijk[2] = int(in_plane - ijk[1] * index(0, 1, 0));
  }
};

// What the first three numbers of a node are, where kg stands for Model::mass_unit; the fourth is its mass
// where they are momentum or velocity. It is part of the type of every nodal array, so that an array is never
// taken for another.
enum class Nodal {
  momentum,  // kg m/s
  velocity,  // m/s
  force,     // N
  damping,   // of transmitting faces: sum of rho c A, an entry a direction, kg/s
  surface,   // what tells where a body ends (contact.hpp)
  cell,      // numbers of cells or nodes, in columns (cells.hpp, levers.hpp)
  lever,     // from the mass centre of the node's points to the node, cells (levers.hpp)
};

// What the kernels see of a nodal array: all nodes, field after field.
template <class T, Nodal quantity>
struct NodeField {
  Quad<T>* data;
  PM_HD Quad<T>& operator[](std::size_t node) const { return data[node]; }
};
template <class T>
using Momentum = NodeField<T, Nodal::momentum>;
template <class T>
using Velocity = NodeField<T, Nodal::velocity>;
template <class T>
using Force = NodeField<T, Nodal::force>;
template <class T>
using Damping = NodeField<T, Nodal::damping>;
template <class T>
using Surface = NodeField<T, Nodal::surface>;

template <class T>
PM_HD bool has_mass(Velocity<T> velocity, std::size_t node) {
  return velocity[node].v[3] > least_mass<T>;
}

}  // namespace pockmark
