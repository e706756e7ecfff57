// What a step reads of the steps before it, but for the points: what a checkpoint must hold.
#pragma once
#include <stdexcept>

#include "ledger.hpp"

namespace pockmark {

struct State {
  double time = 0;
  double dt = 0, first_dt = 0;
  std::int64_t cycle = 0;
  std::int64_t live = 0;     // points that have not left
  double closing_speed = 0;  // largest difference of the points' velocities at the start (m/s)
  double initial = 0;        // energy at the start (J)
  Departed departed;
  // Energies taken so far, J / Model::mass_unit.
  double absorbed = 0, pic = 0, contact = 0, filtered = 0;
  Audit audit;                // of the whole run
  Audit extremes;             // of the last stress update
  std::vector<Audit> audits;  // of each slot in its last stress update: one at rest keeps its own
  int momentum = 0;           // which nodal array holds the points' momentum, or will
  bool is_mapped = false;     // whether it holds that of the next step already: it can be mapped anew

  // See Machine::for_each_part.
  template <class F>
  void for_each_part(F&& f) {
    f("time", time);
    f("dt", dt);
    f("first_dt", first_dt);
    f("cycle", cycle);
    f("live", live);
    f("closing_speed", closing_speed);
    f("initial", initial);
    f("departed.mass", departed.mass);
    f("departed.kinetic", departed.kinetic);
    f("departed.internal", departed.internal);
    f("departed.momentum.x", departed.momentum.x);
    f("departed.momentum.y", departed.momentum.y);
    f("departed.momentum.z", departed.momentum.z);
    f("absorbed", absorbed);
    f("pic", pic);
    f("contact", contact);
    f("filtered", filtered);
    std::vector<double> numbers;
    for (const Audit* one : {&audit, &extremes}) one->append_to(numbers);
    for (const Audit& one : audits) one.append_to(numbers);
    f("audits", numbers);
    if constexpr (!std::remove_cvref_t<F>::restores) return;
    if (numbers.size() < 2 * Audit::size || numbers.size() % Audit::size != 0)
      throw std::invalid_argument("audits: of another number of counters");
    audit = Audit::from(numbers.data());
    extremes = Audit::from(numbers.data() + Audit::size);
    audits.resize(numbers.size() / Audit::size - 2);
    for (std::size_t i = 0; i < audits.size(); ++i)
      audits[i] = Audit::from(numbers.data() + (i + 2) * Audit::size);
  }
};

}  // namespace pockmark
