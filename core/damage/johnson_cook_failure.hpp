// Johnson-Cook failure: Liu et al. 2015, Eqs. 17-18 (its last factor is 1 + D5 T*); Johnson and Cook 1985.
//   eps_f = (D1 + D2 exp(D3 sigma*)) (1 + D4 ln max(rate/rate0, 1)) (1 + D5 T*),  dD = d eps / eps_f
// With the paper's constants eps_f <= 0 above a triaxiality of 1.3467. What happens there decides the crater,
// so it is an explicit choice of the material: Treatment.
#pragma once
#include <limits>
#include <string>

#include "../elementary.hpp"
#include "../homologous.hpp"

namespace pockmark {

enum class FailureTreatment {
  no_damage,          // no damage is added where eps_f <= 0
  signed_damage,      // damage falls where eps_f < 0 (but not below zero)
  floor,              // eps_f is at least `floor`
  clamp_triaxiality,  // sigma* is clamped first, then as no_damage
};

template <class V>
struct DamageStep {
  V increment = V(0);
  mask_t<V> treated = Pack<V>::mask(false);  // the treatment changed the law
};

template <class T>
struct JohnsonCookFailure {
  T D1, D2, D3, D4, D5, reference_rate;
  HomologousTemperature<T> homologous;
  FailureTreatment treatment;
  T floor, triaxiality_min, triaxiality_max;

  JohnsonCookFailure() = default;
  JohnsonCookFailure(T D1_, T D2_, T D3_, T D4_, T D5_, T reference_rate_, T t_room_, T t_melt_,
                     FailureTreatment treatment_, T floor_, T triaxiality_min_, T triaxiality_max_)
      : D1(D1_),
        D2(D2_),
        D3(D3_),
        D4(D4_),
        D5(D5_),
        reference_rate(reference_rate_),
        homologous(t_room_, t_melt_),
        treatment(treatment_),
        floor(floor_),
        triaxiality_min(triaxiality_min_),
        triaxiality_max(triaxiality_max_) {}
  template <class U>
  explicit JohnsonCookFailure(const JohnsonCookFailure<U>& o)
      : JohnsonCookFailure(T(o.D1), T(o.D2), T(o.D3), T(o.D4), T(o.D5), T(o.reference_rate),
                           T(o.homologous.t_room), T(o.homologous.t_melt), o.treatment, T(o.floor),
                           T(o.triaxiality_min), T(o.triaxiality_max)) {}

  std::string check() const {
    if (!(homologous.t_melt > homologous.t_room && reference_rate > 0))
      return "t_melt must exceed t_room; reference_rate must be > 0";
    if (treatment == FailureTreatment::floor && !(floor > 0)) return "floor must be > 0";
    return triaxiality_max > triaxiality_min ? "" : "triaxiality_max must exceed triaxiality_min";
  }

  static constexpr bool may_fail = true;

  template <class V>
  PM_HD V failure_strain(V triaxiality, V rate, V temperature) const {
    V strain = (D1 + D2 * fast_exp(D3 * triaxiality)) * (V(1) + D5 * homologous(temperature));
    if (D4 != T(0)) strain *= V(1) + D4 * fast_log(max(rate * (T(1) / reference_rate), V(1)));
    return strain;
  }

  // Damage added by a plastic strain increment; triaxiality = mean stress / effective stress.
  template <class V>
  PM_HD DamageStep<V> step(V strain_increment, V mean_stress, V effective_stress, V rate,
                           V temperature) const {
    const V tiny = V(std::numeric_limits<T>::min() * T(1e6));
    const V free = mean_stress / max(effective_stress, tiny);
    const bool clamps = treatment == FailureTreatment::clamp_triaxiality;
    const V triaxiality = clamps ? min(max(free, V(triaxiality_min)), V(triaxiality_max)) : free;
    V strain = failure_strain(triaxiality, rate, temperature);
    auto treated = clamps ? (free < triaxiality || triaxiality < free) : Pack<V>::mask(false);
    if (treatment == FailureTreatment::floor) {
      treated = strain < V(floor);
      strain = max(strain, V(floor));
    }
    const auto negative = strain < V(0), positive = V(0) < strain;
    const auto counts = treatment == FailureTreatment::signed_damage ? positive || negative : positive;
    return {select(counts, strain_increment / select(counts, strain, V(1)), V(0)), treated || !positive};
  }
};

template <class T>
struct NoFailure {
  static constexpr bool may_fail = false;  // nor does melting fail a point

  NoFailure() = default;
  template <class U>
  explicit NoFailure(const NoFailure<U>&) {}
  std::string check() const { return ""; }
  template <class V>
  PM_HD DamageStep<V> step(V, V, V, V, V) const {
    return {};
  }
};

}  // namespace pockmark
