// What a run must account for: every clamp, floor and lost point, and the extremes that set the step.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "lanes.hpp"

namespace pockmark {

enum class Counter {
  left_points,           // through a free or transmitting face
  lost_points,           // through a symmetry or fixed face: a numerical fault
  failed_points,         // damage reached one
  melted_points,         // failed because the temperature reached melting
  failure_treatments,    // plastic steps in which the failure treatment changed the law
  eos_caps,              // compression capped short of the pole of the Hugoniot
  return_failures,       // radial return not converged
  eos_failures,          // energy and pressure of a step not converged
  node_cutoffs,          // nodes lighter than the cut-off: force scaled down
  strain_limited_steps,  // steps set by the strain increment, not by the fastest wave
  // States that no material can be in: steps of a point.
  negative_energies,      // less internal energy than at rest, by more than a thousandth of its heat there
  negative_volumes,       // V <= 0
  negative_temperatures,  // T < 0 K
};
inline constexpr std::array counter_names{
    "left_points",       "lost_points",      "failed_points",        "melted_points", "failure_treatments",
    "eos_caps",          "return_failures",  "eos_failures",         "node_cutoffs",  "strain_limited_steps",
    "negative_energies", "negative_volumes", "negative_temperatures"};

// Counts of the packs of a block, lane by lane. An Audit absorbs it once the block is done.
template <class V>
struct Tally {
  std::array<std::int64_t, counter_names.size()> counts{};
  V wave_speed = V(0), volumetric_rate = V(0), compression = V(0);  // the largest in each lane
  V plastic_work = V(0), viscous_work = V(0);

  PM_HD void count(Counter c, mask_t<V> mask) {
    if (any(mask)) counts[std::size_t(c)] += pockmark::count(mask);
  }
  // Notes |v| + c, of which the squares are given. Most points are below the largest so far, which shows
  // without a root.
  PM_HD void note_speed(mask_t<V> active, V c2, V v2) {
    const V left = wave_speed * wave_speed - c2 - v2;
    const auto record = active && (left < V(0) || left * left < V(4) * c2 * v2);
    if (any(record)) wave_speed = select(record, max(wave_speed, root(c2) + root(v2)), wave_speed);
  }
};

// What a driver's slot has counted. Audits are added up in the order of the slots, so that sums do not depend
// on the number of threads.
struct Audit {
  std::array<std::int64_t, counter_names.size()> counts{};
  double wave_speed = 0;                      // largest |v| + c of any point
  double volumetric_rate = 0;                 // largest |tr D|
  double compression = 0;                     // largest rho/rho0
  double plastic_work = 0, viscous_work = 0;  // J / Model::mass_unit

  // Returns an empty tally, but for the largest wave speed so far.
  template <class V>
  Tally<V> tally() const {
    Tally<V> out;
    out.wave_speed = V(number_t<V>(wave_speed));
    return out;
  }
  // Appends its numbers in a fixed order; from() takes them back. Counts are below 2^53, so a double holds
  // them.
  static constexpr std::size_t size = counter_names.size() + 5;
  void append_to(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), counts.begin(), counts.end());
    numbers.insert(numbers.end(), {wave_speed, volumetric_rate, compression, plastic_work, viscous_work});
  }
  static Audit from(const double* numbers) {
    Audit audit;
    for (auto& count : audit.counts) count = std::int64_t(*numbers++);
    audit.wave_speed = numbers[0];
    audit.volumetric_rate = numbers[1];
    audit.compression = numbers[2];
    audit.plastic_work = numbers[3];
    audit.viscous_work = numbers[4];
    return audit;
  }
  void count(Counter c) { ++counts[std::size_t(c)]; }
  template <class Other>
  void absorb(const Other& other) {
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
    wave_speed = std::max(wave_speed, largest_of(other.wave_speed));
    volumetric_rate = std::max(volumetric_rate, largest_of(other.volumetric_rate));
    compression = std::max(compression, largest_of(other.compression));
    plastic_work += sum_of(other.plastic_work);
    viscous_work += sum_of(other.viscous_work);
  }
};

}  // namespace pockmark
