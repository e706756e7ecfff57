// Modified update stress last (Sulsky, Zhou and Schreyer 1995): strains by the points' new velocity, mapped
// back.
#pragma once

namespace pockmark {

struct Musl {
  template <class Step>
  static void run(Step& step) {
    const auto before = step.map_points();
    const auto force = step.force_only();
    const auto after = step.integrate(before, force);
    const auto mapped = step.map_back(before, after);
    step.account(before, after, mapped);
    step.stress_only(mapped, {step.dt(), 0.5, 0.5});
    step.move(after);
  }
};

}  // namespace pockmark
