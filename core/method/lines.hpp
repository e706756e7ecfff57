// What a step does to a line of nodes, from one node to before another.
#pragma once
#include <algorithm>

#include "transmitting_faces.hpp"

namespace pockmark {

template <class T, Nodal quantity>
void clear_line(NodeField<T, quantity> nodes, std::size_t begin, std::size_t end) {
  std::fill(nodes.data + begin, nodes.data + end, Quad<T>{});
}

// Sets the nodes that points touch to zero.
template <class Driver, class T, Nodal quantity>
void clear_nodes(const Driver& driver, NodeField<T, quantity> nodes) {
  driver.for_each_line(false,
                       [&](int, std::size_t begin, std::size_t end) { clear_line(nodes, begin, end); });
}

// Turns momentum into velocity, in the same array.
template <class T>
void divide_by_mass(Momentum<T> momentum, std::size_t begin, std::size_t end) {
  const Velocity<T> velocity{momentum.data};
  for (std::size_t i = begin; i < end; ++i)
    velocity[i].set_vector(has_mass(velocity, i) ? (T(1) / velocity[i].v[3]) * momentum[i].vector()
                                                 : Vec3<T>{});
}

// Completes what the points have put on nodes, and divides it by the mass: the velocity takes its place.
template <class Driver, class T>
Velocity<T> to_velocity(const Driver& driver, const GridGeometry<T>& grid, const Faces& faces,
                        Momentum<T> momentum, Mirrored kind = Mirrored::vector) {
  driver.exchange(momentum);
  fold(driver, grid, faces, momentum, kind);
  driver.for_each_line(
      false, [&](int, std::size_t begin, std::size_t end) { divide_by_mass(momentum, begin, end); });
  return {momentum.data};
}

// Integrates the momentum of nodes (5). `after` holds the forces first, and then the velocity.
template <class T>
struct LineIntegration {
  const GridGeometry<T>& grid;
  TransmittingFaces<T>& transmitting;
  Velocity<T> before, after;
  Damping<T> damping;
  T dt, cutoff;

  // Returns how many nodes were lighter than the cut-off.
  std::int64_t operator()(std::size_t begin, std::size_t end) const {
    std::size_t next = transmitting.first_from(grid, begin);
    std::int64_t light = 0;
    for (std::size_t node = begin; node < end; ++node) {
      const std::size_t i = next;
      const bool is_damped = transmitting.is_damped(i, node);
      next += is_damped;
      if (!has_mass(before, node)) {
        after[node] = {};
        continue;
      }
      const Quad<T> force = after[node];
      const auto step =
          integrate_node(before[node], force, is_damped ? damping[node] : Quad<T>{}, dt, cutoff);
      after[node] = step.velocity;
      if (is_damped) transmitting.keep(i, step.velocity);
      light += step.cut;
    }
    return light;
  }
};

}  // namespace pockmark
