// One node: momentum to velocity, and the time integration of Eq. 12 with the transmitting traction.
#pragma once
#include "tensor.hpp"

namespace pockmark {

template <class T>
struct NodeStep {
  Quad<T> velocity;
  bool cut;
};

// Integrates m dv/dt = f - Z v, with v at mid-step in Z v: stable for any Z. A node lighter than `cutoff`
// takes the force of a share m/cutoff of its points only: it holds a sliver of their mass but the whole of
// their stress.
template <class T>
PM_HD NodeStep<T> integrate_node(const Quad<T>& before, const Quad<T>& force, const Quad<T>& damping, T dt,
                                 T cutoff) {
  const T mass = before.v[3];
  const bool cut = mass < cutoff;
  const auto z = T(0.5) * dt * damping.v;
  const auto push = (cut ? dt * mass / cutoff : dt) * force.v;
  return {{((mass - z) * before.v + push) / (mass + z)}, cut};
}

// Returns the energy (J / Model::mass_unit) that the transmitting traction takes from the points: dt Z (v +
// v_after)/2 . (v + v_final)/2, v_final the velocity that the points really got, where the scheme maps it
// back (docs/theory.md, Eq. 6).
template <class T>
PM_HD T absorbed_energy(const Vec3<T>& v, const Vec3<T>& after, const Vec3<T>& final, const Vec3<T>& damping,
                        T dt) {
  T sum = 0;
  for (int a = 0; a < 3; ++a) sum += damping[a] * (v[a] + after[a]) * (v[a] + final[a]);
  return T(0.25) * dt * sum;
}

}  // namespace pockmark
