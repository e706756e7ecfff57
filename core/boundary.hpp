// The six faces of the grid: fixed velocity components, mirror images, and transmitting tractions.
#pragma once
#include <array>

#include "shape.hpp"
#include "state.hpp"
#include "transfer.hpp"

namespace pockmark {

enum class Face { free, symmetry, fixed, transmitting };
using Faces = std::array<Face, 6>;  // x_lower, x_upper, y_lower, y_upper, z_lower, z_upper

// Calls f(node on the face, node one inside, node one outside) over a face with its padding, in each field.
template <class T, class F>
void for_each_face_node(const GridGeometry<T>& grid, int face, F&& f) {
  const int axis = face / 2, b = (axis + 1) % 3, c = (axis + 2) % 3;
  const bool upper = face % 2 == 1;
  const int plane = upper ? grid.pad + grid.cells[axis] : grid.pad, inward = upper ? -1 : 1;
  for (std::size_t field = 0; field < grid.field_count; ++field)
    for (int ib = 0; ib < grid.nodes(b); ++ib)
      for (int ic = 0; ic < grid.nodes(c); ++ic) {
        int ijk[3];
        ijk[b] = ib, ijk[c] = ic;
        const auto node = [&](int offset) {
          ijk[axis] = plane + offset;
          return field * grid.node_count() + grid.index(ijk[0], ijk[1], ijk[2]);
        };
        f(node(0), node(inward), node(-inward));
      }
}

// A symmetry plane is a mirror, a fixed face one that also turns the tangential velocity round (so that it
// vanishes on the face): what stencils put on the nodes behind them belongs to their images.
inline bool is_mirror(Face face) { return face == Face::symmetry || face == Face::fixed; }
inline int mirror_sign(Face face, int face_axis, int component) {
  return face == Face::fixed || component == face_axis ? -1 : 1;
}

enum class Mirrored { vector, magnitudes };

template <class T>
void fold(const GridGeometry<T>& grid, const Faces& faces, Array<Quad<T>>& field, Mirrored kind) {
  for (int face = 0; face < 6; ++face)
    if (is_mirror(faces[face]))
      for_each_face_node(grid, face, [&](auto, auto inside, auto outside) {
        auto image = field[outside];
        if (kind == Mirrored::vector)
          for (int c = 0; c < 3; ++c) image.v[c] *= T(mirror_sign(faces[face], face / 2, c));
        field[inside] += image;
        field[outside] = {};
      });
}

// Velocity components that a face holds at zero, then the values behind the face.
template <class T>
void constrain(const GridGeometry<T>& grid, const Faces& faces, Array<Quad<T>>& velocity) {
  for (int face = 0; face < 6; ++face)
    if (is_mirror(faces[face]))
      for_each_face_node(grid, face, [&](auto on, auto inside, auto outside) {
        for (int c = 0; c < 3; ++c) {
          const int sign = mirror_sign(faces[face], face / 2, c);
          if (sign < 0) velocity[on].v[c] = T(0);
          velocity[outside].v[c] = T(sign) * velocity[inside].v[c];
        }
      });
}

// What a transmitting face needs of a body's material.
template <class T>
struct Damper {
  T normal, tangential;  // rho c_d, rho c_s
  T specific_volume;     // 1/rho0
};

// Transmitting face (Eqs. 14-15 through Eq. 10): t = -rho c_d v_n - rho c_s v_t on the face. A point in the
// layer of cells behind the face stands for the area V/h; projected onto the face it shares it among the
// nodes there, so edges get a half and corners a quarter without special cases.
template <class Shape, class T>
void add_damping(const Particles<T>& points, Grid<T>& grid, const Faces& faces, const Run& run,
                 const std::vector<Damper<T>>& dampers) {
  const auto& geometry = grid.geometry;
  Quad<T>* nodes = grid.damping.data() + geometry.field_of(run.node);
  bool near = false;
  for (int a = 0; a < 3; ++a)
    near = near || run.base[a] <= geometry.pad || run.base[a] >= geometry.pad + geometry.cells[a] - 2;
  if (!near) return;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    if (faces[face] != Face::transmitting) continue;
    const int layer = face % 2 ? geometry.pad + geometry.cells[axis] - 1 : geometry.pad;
    if (run.base[axis] < layer - 1 || run.base[axis] > layer)
      continue;  // no stencil of this run reaches the layer
    for (std::size_t p = run.begin; p < run.end; ++p) {
      Vec3<T> f = points.vector(Field::place, p);
      if (run.base[axis] + int(std::floor(f[axis])) != layer) continue;
      // Projected onto the face; the linear stencil of an upper face ends on it.
      int base[3] = {run.base[0], run.base[1], run.base[2]};
      base[axis] = Shape::support == 2 ? layer : layer + face % 2 - 1;
      f[axis] = T(layer + face % 2 - base[axis]);
      const Stencil<Shape, T> n(f, geometry.per_metre);
      const auto& damper = dampers[points.body[p]];
      const T volume =
          (T(1) + points.at(Field::dilation)[p]) * points.at(Field::mass)[p] * damper.specific_volume;
      const T area = volume * geometry.per_metre;
      Quad<T> per_direction;
      for (int a = 0; a < 3; ++a) per_direction.v[a] = a == axis ? damper.normal : damper.tangential;
      Patch<Shape, T>::for_each([&](int i, int j, int k) {
        add_scaled(nodes[geometry.index(base[0] + i, base[1] + j, base[2] + k)], n.weight(i, j, k) * area,
                   per_direction);
      });
    }
  }
}

}  // namespace pockmark
