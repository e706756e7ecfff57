// Johnson-Cook failure: Liu et al. 2015, Eqs. 17-18 (its last factor is 1 + D5 T*); Johnson and Cook 1985.
//   eps_f = (D1 + D2 exp(D3 sigma*)) (1 + D4 ln max(rate/rate0, 1)) (1 + D5 T*),  dD = d eps / eps_f
// With the paper's constants eps_f <= 0 above a triaxiality of 1.3467. What happens there decides the crater,
// so it is an explicit choice of the material: Treatment.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "../elementary.hpp"

namespace pockmark {

enum class FailureTreatment {
  no_damage,          // no damage is added where eps_f <= 0
  signed_damage,      // damage falls where eps_f < 0 (but not below zero)
  floor,              // eps_f is at least `floor`
  clamp_triaxiality,  // sigma* is clamped first, then as no_damage
};

template <class T>
struct DamageStep {
  T increment = 0;
  bool treated = false;   // the treatment changed the law
  bool may_fail = false;  // melting fails the point too
};

template <class T>
struct JohnsonCookFailure {
  T D1, D2, D3, D4, D5, reference_rate, t_room, t_melt;
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
        t_room(t_room_),
        t_melt(t_melt_),
        treatment(treatment_),
        floor(floor_),
        triaxiality_min(triaxiality_min_),
        triaxiality_max(triaxiality_max_) {}
  template <class U>
  explicit JohnsonCookFailure(const JohnsonCookFailure<U>& o)
      : JohnsonCookFailure(T(o.D1), T(o.D2), T(o.D3), T(o.D4), T(o.D5), T(o.reference_rate), T(o.t_room),
                           T(o.t_melt), o.treatment, T(o.floor), T(o.triaxiality_min), T(o.triaxiality_max)) {
  }

  std::string check() const {
    if (!(t_melt > t_room && reference_rate > 0))
      return "t_melt must exceed t_room; reference_rate must be > 0";
    if (treatment == FailureTreatment::floor && !(floor > 0)) return "floor must be > 0";
    return triaxiality_max > triaxiality_min ? "" : "triaxiality_max must exceed triaxiality_min";
  }

  PM_HD T failure_strain(T triaxiality, T rate, T temperature) const {
    const T hot = std::clamp((temperature - t_room) / (t_melt - t_room), T(0), T(1));
    const T rate_factor = D4 == T(0) ? T(1) : T(1) + D4 * fast_log(std::max(rate / reference_rate, T(1)));
    return (D1 + D2 * fast_exp(D3 * triaxiality)) * rate_factor * (T(1) + D5 * hot);
  }

  // Damage added by a plastic strain increment; triaxiality = mean stress / effective stress.
  PM_HD DamageStep<T> step(T strain_increment, T mean_stress, T effective_stress, T rate,
                           T temperature) const {
    const T tiny = std::numeric_limits<T>::min() * T(1e6);
    T triaxiality = mean_stress / std::max(effective_stress, tiny);
    bool treated = false;
    if (treatment == FailureTreatment::clamp_triaxiality) {
      const T clamped = std::clamp(triaxiality, triaxiality_min, triaxiality_max);
      treated = clamped != triaxiality;
      triaxiality = clamped;
    }
    T strain = failure_strain(triaxiality, rate, temperature);
    if (treatment == FailureTreatment::floor && strain < floor) strain = floor, treated = true;
    if (strain > T(0)) return {strain_increment / strain, treated, true};
    if (treatment == FailureTreatment::signed_damage && strain < T(0))
      return {strain_increment / strain, true, true};
    return {T(0), true, true};
  }
};

template <class T>
struct NoFailure {
  NoFailure() = default;
  template <class U>
  explicit NoFailure(const NoFailure<U>&) {}
  std::string check() const { return ""; }
  PM_HD DamageStep<T> step(T, T, T, T, T) const { return {}; }
};

}  // namespace pockmark
