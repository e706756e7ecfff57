// The stress update of one material point: equation of state, radial return, damage, heat, bulk viscosity.
#pragma once
#include "audit.hpp"
#include "material.hpp"
#include "points.hpp"
#include "twice.hpp"

namespace pockmark {

// Returns what a point tells its strength law.
template <class V>
PM_HD Conditions<V> conditions_of(const PointState<V>& point) {
  return {point.temperature, point.pressure, point.ratio(), point.damage};
}
template <class V>
PM_HD Conditions<Twice<V>> conditions_of(const PointState<V>& a, const PointState<V>& b) {
  return {
      {a.temperature, b.temperature}, {a.pressure, b.pressure}, {a.ratio(), b.ratio()}, {a.damage, b.damage}};
}

// Returns the work of the point's stress per m^3 of initial volume, (s - (p+q) I) : D dt V/V0.
template <class V>
PM_HD V stress_work(const PointState<V>& point, const Sym3<V>& strain) {
  return (double_dot(point.deviator, strain) - (point.pressure + point.viscosity) * trace(strain)) *
         point.ratio();
}

// Takes a point's volume and deviator through an elastic strain. Failed points have no deviator.
template <class V, class T>
PM_HD void strain_elastically(const Material<T>& material, PointState<V>& point, const Strain<V>& strain) {
  const V before = point.ratio(), shear = material.shear(conditions_of(point));
  point.dilation += before * strain.growth;
  auto s = rotate(point.deviator, strain.half_turn, strain.turn);
  auto change = (T(2) * shear) * deviator(strain.small);
  if (material.deviator_per_initial_volume()) {
    const V after = V(1) / point.ratio();
    s = (before * after) * s;
    change = after * change;
  }
  s = s + change;
  point.deviator = select(point.damage < V(1), s, Sym3<V>{V(0), V(0), V(0), V(0), V(0), V(0)});
}

// Takes a point through a strain under its old stress: pays the whole work of that stress, changes the
// volume, and leaves an elastic trial deviator to the StressUpdate that follows.
template <class V, class T>
PM_HD void follow_strain(const Material<T>& material, PointState<V>& point, const Strain<V>& strain) {
  point.energy += stress_work(point, strain.small);
  strain_elastically(material, point, strain);
}

// The update of a pack of points of one material, in four stages: strain, return to the yield surface,
// pressure, damage. update_stress() takes all points of a block through one stage before the next: a stage is
// short enough to live in registers, and few points need the second and the last. Only `active` lanes are
// tallied. `reference_volume` is V0 in m^3 / Model::mass_unit: it turns work per initial volume into work.
template <class V>
struct StressUpdate {
  using T = number_t<V>;
  using Mask = mask_t<V>;
  const Material<T>& material;
  T cell;
  T dt;                    // duration of the strain
  T step;                  // duration of the whole step, for plastic strain rates
  T old_share, new_share;  // weights of sigma_old : D and sigma_new : D in the energy paid here

  // Pays the work that the old stress does, changes the volume, and leaves an elastic trial deviator. Returns
  // which points may be beyond the yield surface.
  PM_HD Mask strain(PointState<V>& point, const Strain<V>& by, Mask active, Tally<V>& tally) const {
    if (old_share > T(0)) point.energy += old_share * stress_work(point, by.small);
    const V rate = absolute(trace(by.small)) * (T(1) / dt);
    tally.volumetric_rate = select(active, max(tally.volumetric_rate, rate), tally.volumetric_rate);
    strain_elastically(material, point, by);
    const V trial2 = effective_squared(point.deviator);
    return active && material.may_yield(trial2, conditions_of(point));
  }

  // Takes a point back to the yield surface. Returns the increment of the effective plastic strain.
  PM_HD V yield(PointState<V>& point, V trial, const PlasticReturn<V>& back, V reference_volume, Mask active,
                Tally<V>& tally) const {
    const V increment = back.strain_increment;
    const auto yields = active && V(0) < increment;
    tally.count(Counter::return_failures, active && !back.converged);
    const V flow = trial - T(3) * material.shear(conditions_of(point)) * increment;
    point.deviator = select(yields, flow / select(yields, trial, V(1)), V(1)) * point.deviator;
    point.plastic_strain += increment;
    tally.plastic_work += select(yields, flow * increment * (point.ratio() * reference_volume), V(0));
    return select(yields, increment, V(0));
  }

  // Finds pressure, bulk viscosity and energy. Returns the square of the sound speed.
  PM_HD V press(PointState<V>& point, const Sym3<V>& strain, V reference_volume, Mask active,
                Tally<V>& tally) const {
    const auto change = Compression<V>::of(point.dilation);
    const V ratio = change.ratio, compression = V(1) / ratio;
    const V opened = trace(strain);
    const auto now = material.eos.visit([&](const auto& e) PM_INLINE { return e.at(change, point.energy); });
    tally.count(Counter::eos_caps, active && now.capped);
    tally.compression = select(active, max(tally.compression, compression), tally.compression);

    const V bulk_c2 = material.specific_volume * max(now.stiffness(point.pressure, ratio), V(0));
    const V closing = max(-opened, V(0)) * (T(1) / dt);  // rate
    point.viscosity = material.density * cell * compression * closing *
                      (material.q_quadratic * cell * closing + material.q_linear * root(bulk_c2));

    // E1 = E + w (s:D' - (p1+q) tr D) V/V0 dt with p1 at E1, solved together.
    const V weight = new_share * ratio, work = weight * opened;
    const V paid = weight * double_dot(point.deviator, strain) - point.viscosity * work;
    const V known = point.energy + paid;
    V p = corrected_pressure(now, paid, work);
    if (!material.linear_in_energy()) p = refined(change, p, known, work, active, tally);
    const auto intact = point.damage < V(1);
    point.pressure = select(intact, p, max(p, V(0)));
    point.energy = known - work * point.pressure;
    const auto no_energy = point.energy < V(material.least_energy), no_volume = ratio <= V(0);
    if (any(no_energy || no_volume)) {
      tally.count(Counter::negative_energies, active && no_energy);
      tally.count(Counter::negative_volumes, active && no_volume);
    }
    tally.viscous_work -= select(active, point.viscosity * opened * ratio * reference_volume, V(0));

    const V shear = T(4.0 / 3.0) * material.specific_volume * material.shear(conditions_of(point));
    // What has failed and opened has no stress that a wave could travel by.
    const auto is_loose = !intact && p < V(0);
    return select(is_loose, V(0), bulk_c2) +
           select(intact, material.deviator_per_initial_volume() ? shear : shear * ratio, V(0));
  }

  // Returns which points the failure law may damage although they do not yield.
  PM_HD Mask breaks(const PointState<V>& point, Mask active) const {
    return active && point.damage < V(1) && material.may_fail(-point.pressure);
  }

  // Adds damage, and the heat of a plastic increment. Points that fail lose their deviator and their tension.
  PM_HD void damage(PointState<V>& point, V plastic, const Sym3<V>& strain, Mask active,
                    Tally<V>& tally) const {
    const auto yields = active && V(0) < plastic;
    const V flow = effective(point.deviator);
    const auto acts = yields || breaks(point, active);
    const Loading<V> loading{
        plastic, plastic * (T(1) / step), -point.pressure, flow, point.temperature, point.damage, V(cell)};
    const auto damage = material.failure.visit([&](const auto& f) { return f.step(loading); });
    const bool may_fail = material.failure.visit([](const auto& f) { return f.may_fail; });
    point.damage = select(acts, max(point.damage + damage.increment, V(0)), point.damage);
    tally.count(Counter::failure_treatments, acts && damage.treated);

    // Plastic work to heat: dT = chi sigma d eps / (rho C_p).
    const T heat = material.taylor_quinney * material.specific_volume / material.specific_heat;
    point.temperature += select(yields, heat * flow * plastic * point.ratio(), V(0));
    tally.count(Counter::negative_temperatures, active && point.temperature < V(0));
    if (!may_fail) return;
    const auto melted = yields && V(material.t_melt) <= point.temperature;
    tally.count(Counter::melted_points, melted);
    point.damage = select(melted, max(point.damage, V(1)), point.damage);
    const auto failed = acts && V(1) <= point.damage;
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

 private:
  // Returns the pressure of a law that is not linear in the energy.
  PM_HD V refined(const Compression<V>& change, V pressure, V known, V work, Mask active,
                  Tally<V>& tally) const {
    const auto solved = material.eos.visit([&]<class Law>(const Law& e) {
      if constexpr (Law::linear_in_energy)
        return SolvedPressure<V>{pressure, Pack<V>::mask(true)};
      else
        return refined_pressure(e, change, pressure, known, work);
    });
    tally.count(Counter::eos_failures, active && !solved.converged);
    return solved.pressure;
  }
};

}  // namespace pockmark
