// How much of the space around each node some bodies fill: what the depth of a crater is read off while a run
// goes on.
#pragma once
#include <vector>

#include "solver.hpp"

namespace pockmark {

// Each point's volume goes to the eight nodes around it; 1 where undistorted points fill the cells, half as
// much at the grid's faces. `counts`: whether each body does. In the order of the grid's nodes.
template <class T>
std::vector<float> volume_fraction(const Solver<T>& solver, const std::vector<std::uint8_t>& counts) {
  const auto& g = solver.grid().geometry;
  const auto& points = solver.points();
  const double per_cell = double(g.per_metre) * double(g.per_metre) * double(g.per_metre);
  std::vector<float> out(g.node_count());
  solver.for_each_block_apart([&](int, const Block& block) {
    for_each_run(block, [&](const Run& run) {
      for (std::size_t p = run.begin; p < run.end; ++p) {
        if (!counts[points.body[p]]) continue;
        const auto f = points.vector(Field::place, p);
        const float share =
            float((1 + double(points.at(Field::dilation)[p])) * solver.reference_volume(p) * per_cell);
        int base[3];
        float w[3][2];
        for (int a = 0; a < 3; ++a) {
          const int beyond = f[a] >= T(1);  // a wider stencil begins a node earlier
          base[a] = run.base[a] + beyond;
          w[a][1] = float(f[a]) - float(beyond), w[a][0] = 1 - w[a][1];
        }
        float* first = out.data() + g.index(base[0], base[1], base[2]);
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            for (int k = 0; k < 2; ++k) first[g.index(i, j, k)] += share * w[0][i] * w[1][j] * w[2][k];
      }
    });
  });
  return out;
}

}  // namespace pockmark
