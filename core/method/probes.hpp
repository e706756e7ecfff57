// What is asked of the points between steps.
#pragma once
#include <array>
#include <map>

#include "placement.hpp"

namespace pockmark {

// Calls f(p) for the points that have not left, in the driver's order.
template <class T, class F>
void for_each_point(const Points<T>& points, F&& f) {
  for (std::size_t p = 0; p < points.count; ++p)
    if (points.cell[p] != gone) f(p);
}

// Returns the deviator of a point with its trial part (see follow_strain) returned to the yield surface.
template <class T>
Sym3<T> settled_deviator(const Model<T>& model, const Points<T>& points, std::size_t p, T dt) {
  const auto point = points.state(p);
  const T trial = effective(point.deviator);
  if (trial <= T(0) || point.damage >= T(1)) return point.deviator;
  const auto& m = model.materials[points.body[p]];
  const auto conditions = conditions_of(point);
  const T strain = m.return_map(trial, point.plastic_strain, conditions, dt).strain_increment;
  return ((trial - T(3) * m.shear(conditions) * strain) / trial) * point.deviator;
}

// Points that are found together: how many, and the corners of a box around them (m).
struct Gathering {
  std::int64_t points = 0;
  std::array<double, 3> lower{}, upper{};
  void add(const Vec3<double>& x) {
    for (int a = 0; a < 3; ++a) {
      lower[a] = points ? std::min(lower[a], x[a]) : x[a];
      upper[a] = points ? std::max(upper[a], x[a]) : x[a];
    }
    ++points;
  }
};

// Returns the points that are in a state that no material can be in now, by the counter of such steps.
template <class T>
std::map<Counter, Gathering> impossible(const Model<T>& model, const Points<T>& points) {
  std::map<Counter, Gathering> out;
  for_each_point(points, [&](std::size_t p) {
    const auto point = points.state(p);
    const auto& m = model.materials[points.body[p]];
    const auto note = [&](Counter counter, bool is_so) {
      if (is_so) out[counter].add(position_of(model.grid, points, p));
    };
    note(Counter::negative_energies, point.energy < m.least_energy);
    note(Counter::negative_volumes, point.ratio() <= T(0));
    note(Counter::negative_temperatures, point.temperature < T(0));
    note(Counter::eos_caps, m.capped(point.ratio()));
  });
  return out;
}

// Returns how much of the space around each node some bodies fill, in the order of the grid's nodes: what the
// depth of a crater is read off while a run goes on. Each point's volume goes to the eight nodes around it; 1
// where undistorted points fill the cells, half as much at the grid's faces. `counts`: whether each body
// does.
template <class T, class Driver>
std::vector<float> volume_fraction(const Model<T>& model, const Driver& driver,
                                   const std::vector<std::uint8_t>& counts) {
  const auto& grid = model.grid;
  const auto& points = driver.points();
  const double per_cell = double(grid.per_metre) * double(grid.per_metre) * double(grid.per_metre);
  std::vector<float> out(grid.node_count());
  const auto add = [&](std::size_t p, const Bundle& bundle) {
    const auto f = points.vector(Field::place, p);
    double volume = (1 + double(points.at(Field::dilation)[p])) * model.reference_volume(points, p);
    if (grid.is_axisymmetric) volume *= double(grid.cell) / circumference(grid, points, p);  // in the slice
    const float share = float(volume * per_cell);
    int base[3];
    float w[3][2];
    for (int a = 0; a < 3; ++a) {
      const int beyond = f[a] >= T(1);  // a wider stencil begins a node earlier
      base[a] = bundle.base[a] + beyond;
      w[a][1] = float(f[a]) - float(beyond);
      w[a][0] = 1 - w[a][1];
    }
    float* first = out.data() + grid.index(base[0], base[1], base[2]);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        for (int k = 0; k < 2; ++k) first[grid.index(i, j, k)] += share * w[0][i] * w[1][j] * w[2][k];
  };
  driver.scatter_all([&](int, const Block& block) {
    for_each_bundle(block, [&](const Bundle& bundle) {
      for (std::size_t p = bundle.begin; p < bundle.end; ++p)
        if (counts[points.body[p]]) add(p, bundle);
    });
  });
  return out;
}

}  // namespace pockmark
