// Johnson-Cook failure: Liu et al. 2015, Eqs. 17-18 (its last factor is 1 + D5 T*); Johnson and Cook 1985.
//   eps_f = (D1 + D2 exp(D3 sigma*)) (1 + D4 ln max(rate/rate0, 1)) (1 + D5 T*),  dD = d eps / (eps_f + u/h)
// The displacement u is 0 in the paper. Strain that softens gathers in a layer one cell thick, which then
// fails after a slip of eps_f h: nothing, in the limit. With u its sides slip by u more, whatever the cell h,
// and the work that parts them is a material's own (Hillerborg 1976). With the paper's constants eps_f <= 0
// above a triaxiality of 1.3467. What happens there decides the crater, so it is an explicit choice of the
// material: Treatment.
#pragma once
#include <algorithm>
#include <array>
#include <limits>

#include "../elementary.hpp"
#include "../homologous.hpp"
#include "failure.hpp"

namespace pockmark {

enum class FailureTreatment {
  no_damage,          // no damage is added where eps_f <= 0
  signed_damage,      // damage falls where eps_f < 0 (but not below zero)
  floor,              // eps_f is at least `floor`
  clamp_triaxiality,  // sigma* is clamped first, then as no_damage
};
inline constexpr std::array failure_treatments{"no_damage", "signed", "floor", "clamp_triaxiality"};

inline constexpr std::array johnson_cook_failure_constants{
    Constant{.name = "treatment",
             .unit = "",
             .least = 0,
             .most = 3,
             .doc = "what happens where the failure strain is not positive",
             .choices = "no_damage signed floor clamp_triaxiality"},
    Constant{"D1", "", -100, 100, "failure strain at high triaxiality", 0},
    Constant{"D2", "", -100, 100, "what triaxiality 0 adds to it", 0},
    Constant{"D3", "", -100, 100, "exponent of the triaxiality", 0},
    Constant{"D4", "", -100, 100, "share that a rate e times as high adds", 0},
    Constant{"D5", "", -100, 100, "share that melting adds", 0},
    Constant{"reference_rate", "1/s", 1e-8, 1e8, "rate at and below which the rate does not count", 1},
    Constant{"floor", "", 1e-9, 100, "least failure strain, with treatment floor", 1e-3},
    Constant{"triaxiality_min", "", -100, 100, "least triaxiality, with treatment clamp_triaxiality", -1.5},
    Constant{"triaxiality_max", "", -100, 100, "largest triaxiality, with treatment clamp_triaxiality",
             1.0 / 3.0, "triaxiality_min"},
    Constant{"displacement", "m", 0, 1,
             "slip of a layer as thick as a cell before it fails, beyond its failure strain", 0},
};

template <class T>
struct JohnsonCookFailure {
  static constexpr Declaration declaration{
      "johnson-cook", "plastic strain over a failure strain by triaxiality, rate and temperature",
      "e_f = (D1 + D2 exp(D3 sigma*))(1 + D4 ln max(rate/rate0, 1))(1 + D5 T*), dD = de/(e_f + u/h)",
      "Johnson and Cook 1985; Liu et al. 2015, Eqs. 17-18, corrected", johnson_cook_failure_constants};
  static constexpr bool may_fail = true, needs_flow = true;
  T D1, D2, D3, D4, D5, reference_rate;
  HomologousTemperature<T> homologous;
  FailureTreatment treatment;
  T floor, triaxiality_min, triaxiality_max, displacement;

  JohnsonCookFailure() = default;
  explicit JohnsonCookFailure(const Constants& given)
      : D1(T(given["D1"])),
        D2(T(given["D2"])),
        D3(T(given["D3"])),
        D4(T(given["D4"])),
        D5(T(given["D5"])),
        reference_rate(T(given["reference_rate"])),
        homologous(T(given["room_temperature"]), T(given["melt_temperature"])),
        treatment(FailureTreatment(int(given["treatment"]))),
        floor(T(given["floor"])),
        triaxiality_min(T(given["triaxiality_min"])),
        triaxiality_max(T(given["triaxiality_max"])),
        displacement(T(given["displacement"])) {}

  // Says why the law never acts; nothing where it does. A negative factor turns the sign of the others.
  std::string fault() const {
    if (treatment == FailureTreatment::floor || D4 < 0 || D5 < 0) return "";
    if ((D3 == 0 ? D1 + D2 : std::max(D1, D2)) > 0) return "";
    return text("treatment '%s' adds no damage, for with D1 = %g and D2 = %g no failure strain is above 0",
                treatment_name(), double(D1), double(D2));
  }
  // Says what decides the crater beside the constants.
  std::string caution() const {
    if (D2 == 0 || D3 == 0 || -D1 / D2 <= 0) return "";
    return text(
        "its failure strain is <= 0 above a triaxiality of %.4f; there the treatment '%s' decides the crater",
        double(std::log(-D1 / D2) / D3), treatment_name());
  }

  template <class V>
  PM_HD V failure_strain(V triaxiality, V rate, V temperature) const {
    V strain = (D1 + D2 * fast_exp(D3 * triaxiality)) * (V(1) + D5 * homologous(temperature));
    if (D4 != T(0)) strain *= V(1) + D4 * fast_log(max(rate * (T(1) / reference_rate), V(1)));
    return strain;
  }

  // Triaxiality = mean stress / effective stress.
  template <class V>
  PM_HD DamageStep<V> step(const Loading<V>& at) const {
    const V tiny = V(std::numeric_limits<T>::min() * T(1e6));
    const V free = at.mean_stress / max(at.effective_stress, tiny);
    const bool clamps = treatment == FailureTreatment::clamp_triaxiality;
    const V triaxiality = clamps ? min(max(free, V(triaxiality_min)), V(triaxiality_max)) : free;
    V strain = failure_strain(triaxiality, at.rate, at.temperature);
    auto treated = clamps ? (free < triaxiality || triaxiality < free) : Pack<V>::mask(false);
    if (treatment == FailureTreatment::floor) {
      treated = strain < V(floor);
      strain = max(strain, V(floor));
    }
    const auto negative = strain < V(0), positive = V(0) < strain;
    const auto counts = treatment == FailureTreatment::signed_damage ? positive || negative : positive;
    strain += select(positive, V(displacement) / at.cell, V(0));
    return {select(counts, at.strain_increment / select(counts, strain, V(1)), V(0)), treated || !positive};
  }

 private:
  const char* treatment_name() const { return failure_treatments[std::size_t(treatment)]; }
};

}  // namespace pockmark
