// Update stress last.
#pragma once

namespace pockmark {

struct Usl {
  template <class Step>
  static void run(Step& step) {
    const auto before = step.map_points();
    const auto force = step.force_only();
    const auto after = step.integrate(before, force);
    step.update_velocities(before, after);
    step.account(before, after, after);
    step.stress_only(after, {step.dt(), 0.5, 0.5});
    step.move(after);
  }
};

}  // namespace pockmark
