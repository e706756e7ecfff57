// A solver as Python holds it: with the materials as they were written.
#pragma once
#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "../method/solver.hpp"
#include "arrays.hpp"

namespace pockmark::bind {

template <class D>
struct PySolver {
  using T = typename D::Number;
  std::vector<MaterialSpec> materials;
  Solver<D> solver;

  PySolver(std::array<double, 3> lower, double cell, std::array<int, 3> cells, const std::vector<Face>& faces,
           std::vector<MaterialSpec> specs, const Options& options, int threads, bool axisymmetric)
      : materials(std::move(specs)),
        solver(make(lower, cell, cells, faces, materials, options, threads, axisymmetric)) {}

  // Throws std::invalid_argument unless a grid is the slice that hoop.hpp needs.
  static void require_slice(const GridGeometry<T>& grid, const Faces& faces) {
    const bool is_mirrored =
        faces[0] == Face::symmetry && faces[2] == Face::symmetry && faces[3] == Face::symmetry;
    if (grid.lower.x != T(0) || grid.cells[1] != 1 || !is_mirrored)
      throw std::invalid_argument(
          "axisymmetric: x must begin at 0, y have one cell, and their faces be symmetric");
  }
  static Solver<D> make(std::array<double, 3> lower, double cell, std::array<int, 3> cells,
                        const std::vector<Face>& faces, const std::vector<MaterialSpec>& specs,
                        const Options& options, int threads, bool axisymmetric) {
    if (faces.size() != 6) throw std::invalid_argument("faces: six are needed");
    GridGeometry<T> geometry{{T(lower[0]), T(lower[1]), T(lower[2])}, T(cell), cells};
    if (geometry.node_count() >= UINT32_MAX) throw std::invalid_argument("cells: more than 4 billion nodes");
    Faces six;
    std::copy(faces.begin(), faces.end(), six.begin());
    if (axisymmetric) require_slice(geometry, six);
    geometry.is_axisymmetric = axisymmetric;
    std::vector<Material<T>> materials;
    for (const auto& s : specs) materials.push_back(s.as<T>());
    return {geometry, six, std::move(materials), options, threads};
  }
};

template <class D>
using SolverClass = nb::class_<PySolver<D>>;

}  // namespace pockmark::bind
