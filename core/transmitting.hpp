// Transmitting faces: which points damp them, and the areas for which they stand.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "boundary.hpp"
#include "transfer.hpp"

namespace pockmark {

// What a transmitting face needs of a body's material.
template <class T>
struct Damper {
  T normal, tangential;  // rho c_d, rho c_s
  T specific_volume;     // 1/rho0
};

// What the kernels see of an Anchorage.
struct AnchorageView {
  const std::uint8_t *flies, *held;
  std::uint8_t* filled;

  // Notes that the target fills a cell. Returns whether it is held there: in this cell, or in one beside it,
  // so that a surface that moves by less than a cell changes nothing.
  template <class T>
  PM_HD bool note(const GridGeometry<T>& grid, const int (&cell)[3], int axis) const {
    filled[grid.index(cell[0], cell[1], cell[2])] = 1;
    int low[3], high[3];
    for (int a = 0; a < 3; ++a) {
      const int reach = a == axis ? 0 : 1;
      low[a] = max(cell[a] - reach, 0);
      high[a] = min(cell[a] + reach, grid.nodes(a) - 1);
    }
    for (int i = low[0]; i <= high[0]; ++i)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int k = low[2]; k <= high[2]; ++k)
          if (held[grid.index(i, j, k)]) return true;
    return false;
  }
};

// The cells at transmitting faces behind which the target goes on: those that it filled at the start and has
// never left since. What flies into another one is debris, and passes.
class Anchorage {
 public:
  // `flies`: the bodies that are no part of the target.
  void let_fly(std::vector<std::uint8_t> flies) { flies_ = std::move(flies); }
  // Holds every cell until the first renewal. Bodies of which nothing was said are the target's.
  template <class T>
  void begin(const GridGeometry<T>& grid, std::size_t bodies) {
    flies_.resize(bodies);
    held_.assign(grid.node_count(), 1);
    filled_.assign(grid.node_count(), 0);
  }
  AnchorageView view() { return {flies_.data(), held_.data(), filled_.data()}; }
  // Gives up the cells in which nothing was noted since the last time.
  void renew() {
    for (std::size_t cell = 0; cell < held_.size(); ++cell) held_[cell] &= filled_[cell];
    std::fill(filled_.begin(), filled_.end(), std::uint8_t(0));
  }
  std::size_t bytes() const { return 2 * held_.size(); }
  std::vector<std::uint8_t>& held() { return held_; }  // what a checkpoint keeps

 private:
  std::vector<std::uint8_t> flies_, held_, filled_;
};

// Returns how much of a point, `depth` cells behind a face, counts in the layer of one cell there. The layer
// ends on a short slope, so that no result depends on the last bit of a place.
template <class T>
PM_HD T share_of_layer(T depth) {
  constexpr T half_slope = T(1) / 16;
  return min(max((T(1) + half_slope - depth) / (2 * half_slope), T(0)), T(1));
}

// Adds the damping of transmitting faces (Eqs. 14-15 through Eq. 10): t = -rho c_d v_n - rho c_s v_t on the
// face. A point in the layer of cells behind the face stands for the area V/h. It is projected onto the face
// and shares the area among the nodes there, so edges get a half and corners a quarter without special cases.
template <class Shape, class T>
void add_damping(const Points<T>& points, const GridGeometry<T>& grid, const Faces& faces,
                 const Bundle& bundle, const Damper<T>* dampers, const AnchorageView& anchorage,
                 Damping<T> damping) {
  Quad<T>* nodes = damping.data + grid.field_of(bundle.node);
  bool near = false;
  for (int a = 0; a < 3; ++a)
    near = near || bundle.base[a] <= grid.pad + 1 || bundle.base[a] >= grid.pad + grid.cells[a] - 3;
  if (!near) return;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    if (faces[face] != Face::transmitting) continue;
    const int layer = face % 2 ? grid.pad + grid.cells[axis] - 1 : grid.pad;
    if (bundle.base[axis] < layer - 2 || bundle.base[axis] > layer + 1)
      continue;  // no point of this bundle reaches the layer
    for (std::size_t p = bundle.begin; p < bundle.end; ++p) {
      Vec3<T> f = points.vector(Field::place, p);
      if (anchorage.flies[points.body[p]]) continue;
      const T depth = std::abs(T(bundle.base[axis] - (layer + face % 2)) + f[axis]);
      const T share = share_of_layer(depth);
      if (!(share > T(0))) continue;
      int cell[3];
      for (int a = 0; a < 3; ++a) cell[a] = a == axis ? layer : bundle.base[a] + int(std::floor(f[a]));
      if (!anchorage.note(grid, cell, axis)) continue;
      const T radius = radius_in_cells(grid, bundle, f.x);  // of a ring, which is shorter than the face's
      // Projected onto the face; the linear stencil of an upper face ends on it.
      int base[3] = {bundle.base[0], bundle.base[1], bundle.base[2]};
      base[axis] = Shape::support == 2 ? layer : layer + face % 2 - 1;
      f[axis] = T(layer + face % 2 - base[axis]);
      const Stencil<Shape, T> n(f, grid.per_metre);
      const auto& damper = dampers[points.body[p]];
      const T volume =
          (T(1) + points.at(Field::dilation)[p]) * points.at(Field::mass)[p] * damper.specific_volume;
      T area = share * volume * grid.per_metre;
      if (grid.is_axisymmetric && axis == 0) area *= T(layer + face % 2 - grid.pad) / radius;
      Quad<T> per_direction;
      for (int a = 0; a < 3; ++a) per_direction.v[a] = a == axis ? damper.normal : damper.tangential;
      Patch<Shape, T>::for_each([&](int i, int j, int k) {
        add_scaled(nodes[grid.index(base[0] + i, base[1] + j, base[2] + k)], n.weight(i, j, k) * area,
                   per_direction);
      });
    }
  }
}

}  // namespace pockmark
