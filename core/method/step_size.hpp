// How long the next step may be.
#pragma once
#include <cmath>
#include <stdexcept>

#include "state.hpp"

namespace pockmark {

// Sets the length of the next step, which lands on `end_time`, without a sliver of a step before it. Returns
// the time after it. Throws std::runtime_error where no step makes sense any more.
inline double choose_step(State& state, const Options& options, double cell, double end_time) {
  double dt = options.cfl * cell / state.extremes.wave_speed;
  // The limit on the strain looks at the last step. When bodies meet the strain comes at once, of their cells
  // at about closing_speed/h: twice the limit is left to that first step.
  const double rate = std::max(state.extremes.volumetric_rate, state.closing_speed / (2 * cell));
  if (rate * dt > options.strain_limit) {
    dt = options.strain_limit / rate;
    state.audit.count(Counter::strain_limited_steps);
  }
  if (!(dt > 0) || !std::isfinite(dt)) throw std::runtime_error("the time step is no longer a number");
  if (state.cycle == 0) state.first_dt = dt;
  // Waves a thousand times faster than at the start are no physics, and the run would never end.
  if (dt < 1e-3 * state.first_dt)
    throw std::runtime_error("the time step fell to a thousandth of the first one");
  const double left = end_time - state.time;
  if (left < 2 * dt) dt = left <= dt ? left : left / 2;
  state.dt = dt;
  return left <= dt ? end_time : state.time + dt;
}

}  // namespace pockmark
