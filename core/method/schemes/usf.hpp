// Update stress first: the scheme of Liu et al. 2015.
#pragma once

namespace pockmark {

struct Usf {
  template <class Step>
  static void run(Step& step) {
    const auto before = step.map_points();
    const auto force = step.stress_and_force(before, {step.dt(), 0.5, 0.5});
    const auto after = step.integrate(before, force);
    step.update_velocities_and_move(before, after);
    step.account(before, after, after);
  }
};

}  // namespace pockmark
