// The six faces of the grid: fixed velocity components and mirror images.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "grid.hpp"
#include "shape.hpp"

namespace pockmark {

enum class Face { free, symmetry, fixed, transmitting };
using Faces = std::array<Face, 6>;  // x_lower, x_upper, y_lower, y_upper, z_lower, z_upper

// A node on a face, its neighbour inside of the face, and the one outside, in the padding of the grid.
struct FaceNode {
  std::size_t on, inside, outside;
};
// Returns the node of a velocity field at (b, c) on a face: b and c count nodes along the two axes after the
// face's own.
template <class T>
PM_HD FaceNode face_node(const GridGeometry<T>& grid, int face, std::size_t field, int b, int c) {
  const int axis = face / 2, plane = face % 2 ? grid.pad + grid.cells[axis] : grid.pad;
  const int inward = face % 2 ? -1 : 1;
  int ijk[3];
  ijk[(axis + 1) % 3] = b;
  ijk[(axis + 2) % 3] = c;
  const auto node = [&](int offset) {
    ijk[axis] = plane + offset;
    return field * grid.node_count() + grid.index(ijk[0], ijk[1], ijk[2]);
  };
  return {node(0), node(inward), node(-inward)};
}
// Calls f(face node) over a face, in each velocity field.
template <class Driver, class T, class F>
void for_each_face_node(const Driver& driver, const GridGeometry<T>& grid, int face, F&& f) {
  const int b = (face / 2 + 1) % 3, c = (face / 2 + 2) % 3;
  for (std::size_t field = 0; field < grid.field_count; ++field)
    driver.for_each_pair(grid.nodes(b), grid.nodes(c),
                         [&, field](int ib, int ic) { f(face_node(grid, face, field, ib, ic)); });
}

// A symmetry plane is a mirror. So is a fixed face, one that also turns the tangential velocity round, so
// that it vanishes on the face. What stencils put on the nodes behind a mirror belongs to the images of these
// nodes.
inline bool is_mirror(Face face) { return face == Face::symmetry || face == Face::fixed; }
inline int mirror_sign(Face face, int face_axis, int component) {
  return face == Face::fixed || component == face_axis ? -1 : 1;
}

// A cell behind a mirror and the one whose image it is, called by their first nodes.
struct MirroredCell {
  std::size_t image, cell;
};
PM_HD MirroredCell mirrored_cell(int face, const FaceNode& at) {
  return face % 2 ? MirroredCell{at.on, at.inside} : MirroredCell{at.outside, at.on};
}

// Calls f(image, cell) for the cells along each mirror.
template <class Driver, class T, class F>
void for_each_mirrored_cell(const Driver& driver, const GridGeometry<T>& grid, const Faces& faces, F&& f) {
  for (int face = 0; face < 6; ++face) {
    if (!is_mirror(faces[face])) continue;
    for_each_face_node(driver, grid, face, [&, face](const FaceNode& at) {
      const auto [image, cell] = mirrored_cell(face, at);
      f(image, cell);
    });
  }
}

// What a mirror does to the components of a sum: it turns those of a vector, magnitudes stay.
enum class Mirrored { vector, magnitudes };

// Some nodes on each face.
using FaceNodes = std::array<std::vector<FaceNode>, 6>;

// Adds what the nodes behind a mirror have to their images. Nothing stays behind it. `walk` calls
// f(face node) over a face: walk(face, f).
template <class Walk, class T, Nodal quantity>
void fold_where(Walk&& walk, const Faces& faces, NodeField<T, quantity> nodes, Mirrored kind) {
  for (int face = 0; face < 6; ++face) {
    if (!is_mirror(faces[face])) continue;
    walk(face, [&, face](const FaceNode& at) {
      auto image = nodes[at.outside];
      if (kind == Mirrored::vector)
        for (int c = 0; c < 3; ++c) image.v[c] *= T(mirror_sign(faces[face], face / 2, c));
      nodes[at.inside] += image;
      nodes[at.outside] = {};
    });
  }
}

// Sets the components of a vector that a face holds to zero, then what is behind the face. The first is done
// on all faces before the second: where a grid is one cell thick, what lies inside of a face is on the one
// across. Magnitudes are only copied behind it.
template <class Walk, class T, Nodal quantity>
void constrain_where(Walk&& walk, const Faces& faces, NodeField<T, quantity> nodes, Mirrored kind) {
  const auto on_each = [&](auto&& act) {
    for (int face = 0; face < 6; ++face) {
      if (!is_mirror(faces[face])) continue;
      walk(face, [&, face](const FaceNode& at) {
        for (int c = 0; c < 3; ++c)
          act(at, c, kind == Mirrored::vector ? mirror_sign(faces[face], face / 2, c) : 1);
      });
    }
  };
  on_each([&](const FaceNode& at, int c, int sign) {
    if (sign < 0) nodes[at.on].v[c] = T(0);
  });
  on_each(
      [&](const FaceNode& at, int c, int sign) { nodes[at.outside].v[c] = T(sign) * nodes[at.inside].v[c]; });
}

// Do so at all nodes on the faces, or at some, to vectors.
template <class Driver, class T, Nodal quantity>
void fold(const Driver& driver, const GridGeometry<T>& grid, const Faces& faces, NodeField<T, quantity> nodes,
          Mirrored kind) {
  fold_where([&](int face, auto&& f) { for_each_face_node(driver, grid, face, f); }, faces, nodes, kind);
}
template <class Driver, class T, Nodal quantity>
void constrain(const Driver& driver, const GridGeometry<T>& grid, const Faces& faces,
               NodeField<T, quantity> nodes, Mirrored kind = Mirrored::vector) {
  constrain_where([&](int face, auto&& f) { for_each_face_node(driver, grid, face, f); }, faces, nodes, kind);
}
template <class T, Nodal quantity>
void fold(const FaceNodes& some, const Faces& faces, NodeField<T, quantity> nodes) {
  fold_where([&](int face, auto&& f) { std::ranges::for_each(some[face], f); }, faces, nodes,
             Mirrored::vector);
}
template <class T, Nodal quantity>
void constrain(const FaceNodes& some, const Faces& faces, NodeField<T, quantity> nodes) {
  constrain_where([&](int face, auto&& f) { std::ranges::for_each(some[face], f); }, faces, nodes,
                  Mirrored::vector);
}

}  // namespace pockmark
