// Between a place in space and a place in the grid.
#pragma once
#include "model.hpp"

namespace pockmark {

// The first node of a point's stencil, counted along each axis, and its place from there, in cells.
template <class T>
struct Seat {
  int base[3];
  Vec3<T> place;
};

// Returns where x (m) lies in the grid, for stencils that begin `offset` cells before a point.
template <class T>
Seat<T> seat_of(const GridGeometry<T>& grid, const Vec3<double>& x, double offset) {
  Seat<T> seat;
  for (int a = 0; a < 3; ++a) {
    const double xi = (x[a] - double(grid.lower[a])) / double(grid.cell) + grid.pad;
    const double most = grid.cells[a] + 3.0;  // far outside is as good as farther
    seat.base[a] = int(std::floor(std::min(std::max(xi - offset, 0.0), most)));
    seat.place[a] = T(xi - seat.base[a]);
  }
  return seat;
}

// Returns a point's position (m).
template <class T>
Vec3<double> position_of(const GridGeometry<T>& grid, const Points<T>& points, std::size_t p) {
  int base[3];
  grid.split(points.cell[p], base);
  const auto f = points.vector(Field::place, p);
  Vec3<double> x;
  for (int a = 0; a < 3; ++a)
    x[a] = double(grid.lower[a]) + (base[a] - grid.pad + double(f[a])) * double(grid.cell);
  return x;
}

}  // namespace pockmark
