// The stress update of one material point: equation of state, radial return, damage, heat, bulk viscosity.
#pragma once
#include "audit.hpp"
#include "damage/johnson_cook_failure.hpp"
#include "eos/linear.hpp"
#include "eos/mie_gruneisen.hpp"
#include "one_of.hpp"
#include "points.hpp"
#include "strength/johnson_cook.hpp"
#include "strength/simple.hpp"

namespace pockmark {

// The closed lists. A new model: its file, and its name here.
template <class T>
using Eos = OneOf<MieGruneisen<T>, LinearEos<T>>;
template <class T>
using Strength = OneOf<JohnsonCook<T>, Elastic<T>, Fluid<T>>;
template <class T>
using Failure = OneOf<NoFailure<T>, JohnsonCookFailure<T>>;

template <class T>
struct Material {
  Eos<T> eos;
  Strength<T> strength;
  Failure<T> failure;
  T specific_heat, taylor_quinney, t_room, t_melt;
  T q_quadratic, q_linear;

  T specific_volume;  // 1/rho0
  T least_energy;     // J per m^3 of initial volume: below it a point counts as impossible

  PM_HD T density() const {
    return eos.visit([](const auto& e) { return e.density; });
  }
  PM_HD T shear_modulus() const {
    return strength.visit([](const auto& s) -> T { return s.shear_modulus; });
  }
  PM_HD bool deviator_per_initial_volume() const {
    return strength.visit([](const auto& s) { return s.per_initial_volume; });
  }
  PM_HD T bulk_modulus() const {
    return eos.visit([](const auto& e) { return e.bulk_modulus(); });
  }
  // Whether the equation of state limits its compression at V/V0 = ratio.
  PM_HD bool capped(T ratio) const {
    const Compression<T> c{T(1) / ratio - T(1), T(1) - ratio, ratio};
    return eos.visit([&](const auto& e) { return e.at(c).capped; });
  }
  PM_HD T dilatational_speed() const {
    return std::sqrt((bulk_modulus() + T(4) / T(3) * shear_modulus()) / density());
  }
  PM_HD T shear_speed() const { return std::sqrt(shear_modulus() / density()); }
};

// Work of the point's stress per m^3 of initial volume, (s - (p+q) I) : D dt V/V0.
template <class V>
PM_HD V stress_work(const PointState<V>& point, const Sym3<V>& strain) {
  return (double_dot(point.deviator, strain) - (point.pressure + point.viscosity) * trace(strain)) *
         point.ratio();
}

// Takes a point's volume and deviator through an elastic strain. Failed points have no deviator.
template <class V, class T>
PM_HD void strain_elastically(const Material<T>& material, PointState<V>& point, const Strain<V>& strain) {
  const V before = point.ratio();
  point.dilation += before * strain.growth;
  auto s = rotate(point.deviator, strain.half_turn, strain.turn);
  auto change = V(T(2) * material.shear_modulus()) * deviator(strain.small);
  if (material.deviator_per_initial_volume()) {
    const V after = V(1) / point.ratio();
    s = (before * after) * s, change = after * change;
  }
  s = s + change;
  point.deviator = select(point.damage < V(1), s, Sym3<V>{V(0), V(0), V(0), V(0), V(0), V(0)});
}

// Moves the point through a strain under its old stress: pays the whole work of that stress, takes the volume
// along, and leaves an elastic trial deviator for the StressUpdate that follows.
template <class V, class T>
PM_HD void follow_strain(const Material<T>& material, PointState<V>& point, const Strain<V>& strain) {
  point.energy += stress_work(point, strain.small);
  strain_elastically(material, point, strain);
}

// The update of a pack of points of one material, in four stages: strain, return to the yield surface,
// pressure, damage. The driver takes all points of a block through one stage before the next: a stage is
// short enough to live in registers, and few points need the second and the last. Only `active` lanes are
// tallied; `reference_volume` (m^3) is what turns work per volume into work.
template <class V>
struct StressUpdate {
  using T = number_t<V>;
  using Mask = mask_t<V>;
  const Material<T>& material;
  T cell;
  T dt;                    // duration of the strain
  T step;                  // duration of the whole step, for plastic strain rates
  T old_share, new_share;  // weights of sigma_old : D and sigma_new : D in the energy paid here

  // Half of the work, volume, elastic trial deviator. Returns which points may be beyond the yield surface.
  PM_HD Mask strain(PointState<V>& point, const Strain<V>& by, Mask active, Tally<V>& tally) const {
    if (old_share > T(0)) point.energy += old_share * stress_work(point, by.small);
    const V rate = absolute(trace(by.small)) * (T(1) / dt);
    tally.volumetric_rate = select(active, max(tally.volumetric_rate, rate), tally.volumetric_rate);
    strain_elastically(material, point, by);
    const V trial2 = effective_squared(point.deviator);
    return active && material.strength.visit(
                         [&](const auto& s) PM_INLINE { return s.may_yield(trial2, point.temperature); });
  }

  // From a trial stress to the yield surface. P is V, or two of them: the iteration is one long chain.
  template <class P>
  PM_HD PlasticReturn<P> return_map(P trial, P plastic_strain, P temperature) const {
    return material.strength.visit(
        [&](const auto& s) { return s.return_map(trial, plastic_strain, temperature, step); });
  }

  // Takes a point back to the yield surface. Returns the increment of the effective plastic strain.
  PM_HD V yield(PointState<V>& point, V trial, const PlasticReturn<V>& back, V reference_volume, Mask active,
                Tally<V>& tally) const {
    const V increment = back.strain_increment;
    const auto yields = active && V(0) < increment;
    tally.count(Counter::return_failures, active && !back.converged);
    const V flow = trial - T(3) * material.shear_modulus() * increment;
    point.deviator = select(yields, flow / select(yields, trial, V(1)), V(1)) * point.deviator;
    point.plastic_strain += increment;
    tally.plastic_work += select(yields, flow * increment * (point.ratio() * reference_volume), V(0));
    return select(yields, increment, V(0));
  }

  // Returns the square of the sound speed.
  PM_HD V press(PointState<V>& point, const Sym3<V>& strain, V reference_volume, Mask active,
                Tally<V>& tally) const {
    const V ratio = point.ratio(), compression = V(1) / ratio;
    const V opened = trace(strain);
    const Compression<V> change{-point.dilation * compression, -point.dilation, ratio};
    const auto isochore = material.eos.visit([&](const auto& e) PM_INLINE { return e.at(change); });
    tally.count(Counter::eos_caps, active && isochore.capped);
    tally.compression = select(active, max(tally.compression, compression), tally.compression);

    const V stiffness = isochore.stiffness(point.pressure, point.energy, ratio);
    const V bulk_c2 = material.specific_volume * max(stiffness, V(0));
    const V closing = max(-opened, V(0)) * (T(1) / dt);  // rate
    point.viscosity = material.density() * cell * compression * closing *
                      (material.q_quadratic * cell * closing + material.q_linear * root(bulk_c2));

    // E1 = E + w (s:D' - (p1+q) tr D) V/V0 dt with p1 = cold + thermal E1, solved together.
    const V weight = new_share * ratio, work = weight * opened;
    const V share = V(1) / (V(1) + isochore.thermal * work);  // ready before what it multiplies
    const V known = point.energy + weight * double_dot(point.deviator, strain) - point.viscosity * work;
    const V p = share * (isochore.cold + isochore.thermal * known);
    const auto intact = point.damage < V(1);
    point.pressure = select(intact, p, max(p, V(0)));
    point.energy = known - work * point.pressure;
    const auto no_energy = point.energy < V(material.least_energy), no_volume = ratio <= V(0);
    if (any(no_energy || no_volume)) {
      tally.count(Counter::negative_energies, active && no_energy);
      tally.count(Counter::negative_volumes, active && no_volume);
    }
    tally.viscous_work -= select(active, point.viscosity * opened * ratio * reference_volume, V(0));

    const T shear = T(4.0 / 3.0) * material.shear_modulus() * material.specific_volume;
    return bulk_c2 + select(intact, material.deviator_per_initial_volume() ? V(shear) : shear * ratio, V(0));
  }

  // Damage and heat of a plastic increment. Points that fail lose their deviator and their tension.
  PM_HD void damage(PointState<V>& point, V plastic, const Sym3<V>& strain, Mask active,
                    Tally<V>& tally) const {
    const auto yields = active && V(0) < plastic;
    const V flow = effective(point.deviator);
    const auto damage = material.failure.visit([&](const auto& f) {
      return f.step(plastic, -point.pressure, flow, plastic * (T(1) / step), point.temperature);
    });
    const bool may_fail = material.failure.visit([](const auto& f) { return f.may_fail; });
    point.damage = select(yields, max(point.damage + damage.increment, V(0)), point.damage);
    tally.count(Counter::failure_treatments, yields && damage.treated);

    // Plastic work to heat: dT = chi sigma d eps / (rho C_p).
    const T heat = material.taylor_quinney * material.specific_volume / material.specific_heat;
    point.temperature += select(yields, heat * flow * plastic * point.ratio(), V(0));
    tally.count(Counter::negative_temperatures, active && point.temperature < V(0));
    if (!may_fail) return;
    const auto melted = yields && V(material.t_melt) <= point.temperature;
    tally.count(Counter::melted_points, melted);
    point.damage = select(melted, max(point.damage, V(1)), point.damage);
    const auto failed = yields && V(1) <= point.damage;
    if (!any(failed)) return;
    tally.count(Counter::failed_points, failed);
    // The nodes will feel the failed stress, so that is what the energy is paid with.
    auto after = point;
    after.energy -= new_share * stress_work(after, strain);
    after.deviator = {V(0), V(0), V(0), V(0), V(0), V(0)};
    after.pressure = max(after.pressure, V(0));
    after.energy += new_share * stress_work(after, strain);
    point = select(failed, after, point);
  }
};

}  // namespace pockmark
