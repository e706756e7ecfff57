// One node: momentum to velocity, and the time integration of Eq. 12 with the transmitting traction.
#pragma once
#include "tensor.hpp"

namespace pockmark {

template <class T>
struct NodeStep {
  Vec3<T> velocity;
  T absorbed;  // energy that the transmitting traction took (J)
  bool cut;
};

// m dv/dt = f - Z v, Z taken at mid-step: stable for any Z. A node lighter than `cutoff` takes the force of a
// share m/cutoff of its points only: it holds a sliver of their mass but the whole of their stress.
template <class T>
PM_HD NodeStep<T> integrate_node(T mass, const Vec3<T>& v, const Vec3<T>& force, const Vec3<T>& damping, T dt,
                                 T cutoff) {
  NodeStep<T> out{{}, T(0), mass < cutoff};
  const T share = out.cut ? mass / cutoff : T(1);
  for (int a = 0; a < 3; ++a) {
    const T z = T(0.5) * dt * damping[a];
    out.velocity[a] = ((mass - z) * v[a] + dt * share * force[a]) / (mass + z);
    const T middle = T(0.5) * (v[a] + out.velocity[a]);
    out.absorbed += T(2) * z * middle * middle;
  }
  return out;
}

}  // namespace pockmark
