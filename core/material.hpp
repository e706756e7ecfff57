// A material: one law of each closed list, its heat and its bulk viscosity.
#pragma once
#include <string>

#include "eos/energy.hpp"
#include "eos/linear.hpp"
#include "eos/mie_gruneisen.hpp"
#include "eos/tillotson.hpp"
#include "failure/failure.hpp"
#include "failure/johnson_cook.hpp"
#include "failure/spall.hpp"
#include "one_of.hpp"
#include "strength/johnson_cook.hpp"
#include "strength/return_map.hpp"
#include "strength/simple.hpp"
#include "strength/steinberg_guinan.hpp"

namespace pockmark {

template <class T, template <class> class... Laws>
  requires(EquationOfState<Laws<T>, T> && ...)
using EosList = OneOf<Laws<T>...>;
template <class T, template <class> class... Laws>
  requires(StrengthLaw<Laws<T>, T> && ...)
using StrengthList = OneOf<Laws<T>...>;
template <class T, template <class> class... Laws>
  requires(FailureLaw<Laws<T>, T> && ...)
using FailureList = OneOf<Laws<T>...>;

// The closed lists. A new law: its file, and its name here. The first of a list is the quickest to reach.
template <class T>
using Eos = EosList<T, MieGruneisen, LinearEos, Tillotson>;
template <class T>
using Strength = StrengthList<T, JohnsonCook, Elastic, Fluid, SteinbergGuinan>;
template <class T>
using Failure = FailureList<T, JohnsonCookFailure, NoFailure, Spall>;

template <class T>
struct Material {
  Eos<T> eos;
  Strength<T> strength;
  Failure<T> failure;
  T density, specific_heat, taylor_quinney, t_room, t_melt;
  T q_quadratic, q_linear;

  T specific_volume;              // 1/rho0
  T least_energy;                 // J per m^3 of initial volume: below it a point counts as impossible
  T bulk_modulus, shear_modulus;  // at rest

  PM_HD bool deviator_per_initial_volume() const {
    return strength.visit([](const auto& s) { return s.per_initial_volume; });
  }
  // Returns the shear modulus at a point's conditions.
  template <class V>
  PM_HD V shear(const Conditions<V>& conditions) const {
    return strength.visit([&](const auto& s) PM_INLINE { return V(shear_modulus_of(s, conditions)); });
  }
  // Returns whether a trial stress, of which the square is given, may be beyond the yield surface.
  template <class V>
  PM_HD mask_t<V> may_yield(V trial_squared, const Conditions<V>& conditions) const {
    return strength.visit([&]<class Law>(const Law& s) PM_INLINE {
      if constexpr (YieldingLaw<Law, V>) {
        const V least = s.least(conditions);
        return least * least < trial_squared;
      } else {
        return Pack<V>::mask(false);
      }
    });
  }
  // Returns the plastic strain that takes a trial stress to the yield surface. P is V, or two of them side by
  // side: the iteration is one long chain.
  template <class P>
  PM_HD PlasticReturn<P> return_map(P trial, P plastic_strain, const Conditions<P>& conditions, T dt) const {
    return strength.visit(
        [&](const auto& s) { return return_to_yield_surface(s, trial, plastic_strain, conditions, dt); });
  }
  PM_HD bool linear_in_energy() const {
    return eos.visit([](const auto& e) { return e.linear_in_energy; });
  }
  PM_HD bool fails_without_flow() const {
    return failure.visit([](const auto& f) { return !f.needs_flow; });
  }
  // Returns which points a law that needs no plastic flow may damage.
  template <class V>
  PM_HD mask_t<V> may_fail(V mean_stress) const {
    return failure.visit([&]<class Law>(const Law& f) PM_INLINE {
      if constexpr (Law::needs_flow)
        return Pack<V>::mask(false);
      else
        return f.may_act(mean_stress);
    });
  }
  // Returns whether the equation of state limits its compression at V/V0 = ratio.
  PM_HD bool capped(T ratio) const {
    return any(eos.visit([&](const auto& e) { return e.at(Compression<T>::of(ratio - T(1)), T(0)).capped; }));
  }
  PM_HD T dilatational_speed() const {
    return std::sqrt((bulk_modulus + T(4) / T(3) * shear_modulus) / density);
  }
  PM_HD T shear_speed() const { return std::sqrt(shear_modulus / density); }
};

// A material as it is written: made in the solver's precision.
struct MaterialSpec {
  struct Law {
    std::string model;
    Constants constants;
  };
  Law eos, strength, failure;
  double density, specific_heat, taylor_quinney, room_temperature, melt_temperature, q_quadratic, q_linear;

  template <class T>
  Material<T> as() const {
    Material<T> m{};
    choose(m.eos, eos, "eos");
    choose(m.strength, strength, "strength");
    choose(m.failure, failure, "failure");
    m.density = T(density);
    m.specific_heat = T(specific_heat);
    m.taylor_quinney = T(taylor_quinney);
    m.t_room = T(room_temperature);
    m.t_melt = T(melt_temperature);
    m.q_quadratic = T(q_quadratic);
    m.q_linear = T(q_linear);
    m.specific_volume = T(1) / m.density;
    m.least_energy = T(-0.001) * m.density * m.specific_heat * m.t_room;
    m.bulk_modulus = m.eos.visit([](const auto& e) { return e.at(Compression<T>::of(T(0)), T(0)).by_mu; });
    m.shear_modulus = m.strength.visit([](const auto& s) { return T(s.shear_modulus); });
    return m;
  }

 private:
  template <class Laws>
  void choose(Laws& laws, const Law& written, const std::string& kind) const {
    Constants constants;
    Laws::for_each([&]<class L>() {
      if (written.model == L::declaration.name) constants = completed(L::declaration, written.constants);
    });
    constants.set("density", density);
    constants.set("room_temperature", room_temperature);
    constants.set("melt_temperature", melt_temperature);
    if (!laws.choose(written.model, constants))
      throw std::invalid_argument(kind + ": no model is named '" + written.model + "'");
  }
};

}  // namespace pockmark
