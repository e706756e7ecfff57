// Update stress averaged (Nairn 2003): half of the strain before the forces, half after, by the velocity
// mapped back. Both halves are paid with the stress that made the forces, so the ledger closes to rounding
// (docs/theory.md).
#pragma once

namespace pockmark {

struct Usavg {
  template <class Step>
  static void run(Step& step) {
    const double half = step.dt() / 2;
    const auto before = step.map_points();
    const auto force = step.stress_and_force(before, {half, 0, 1});
    const auto after = step.integrate(before, force);
    const auto mapped = step.map_back(before, after);
    step.account(before, after, mapped);
    step.strain_and_move(after, mapped, half);
  }
};

}  // namespace pockmark
