// The stress update of one material point: equation of state, radial return, damage, heat, bulk viscosity.
#pragma once
#include <algorithm>
#include <cmath>

#include "audit.hpp"
#include "damage/johnson_cook_failure.hpp"
#include "eos/linear.hpp"
#include "eos/mie_gruneisen.hpp"
#include "one_of.hpp"
#include "state.hpp"
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

  PM_HD T reference_volume(T mass) const { return mass * specific_volume; }
  PM_HD T density() const {
    return eos.visit([](const auto& e) { return e.density; });
  }
  PM_HD T shear_modulus() const {
    return strength.visit([](const auto& s) -> T { return s.shear_modulus; });
  }
  PM_HD T bulk_modulus() const {
    return eos.visit([](const auto& e) { return e.bulk_modulus(); });
  }
  PM_HD T dilatational_speed() const {
    return std::sqrt((bulk_modulus() + T(4) / T(3) * shear_modulus()) / density());
  }
  PM_HD T shear_speed() const { return std::sqrt(shear_modulus() / density()); }
};

// Power of the point's stress per m^3 of initial volume, (s - (p+q) I) : D V/V0; ratio = V/V0.
template <class T>
PM_HD T stress_power(const PointState<T>& point, const Sym3<T>& rate, T ratio) {
  return (double_dot(point.deviator, rate) - (point.pressure + point.viscosity) * trace(rate)) * ratio;
}

// Of a volume through a volumetric strain, taken at mid-step.
template <class T>
PM_HD T stretch(T strain) {
  return (T(1) + T(0.5) * strain) / (T(1) - T(0.5) * strain);
}

// Moves the point through a strain of duration dt under its old stress: pays the whole work of that stress,
// takes the volume along, and leaves an elastic trial deviator for the StressUpdate that follows.
template <class T>
PM_HD void strain_elastically(const Material<T>& material, PointState<T>& point, const VelocityGradient<T>& L,
                              T mass, T dt) {
  point.energy += dt * stress_power(point, L.strain_rate, point.volume / material.reference_volume(mass));
  point.volume *= stretch(trace(L.strain_rate) * dt);
  if (point.damage >= T(1)) return;
  point.deviator =
      rotate(point.deviator, dt * L.spin) + (T(2) * material.shear_modulus() * dt) * deviator(L.strain_rate);
}

template <class T>
struct StressUpdate {
  const Material<T>& material;
  T cell;
  T dt;                    // duration of the strain
  T step;                  // duration of the whole step, for plastic strain rates
  T old_share, new_share;  // weights of sigma_old : D and sigma_new : D in the energy paid here

  // Advances the point by dt under the velocity gradient `L`. Returns its sound speed (m/s).
  PM_HD T operator()(PointState<T>& point, const VelocityGradient<T>& L, T mass, Audit& audit) const {
    const T reference_volume = material.reference_volume(mass);
    if (old_share > T(0))
      point.energy += old_share * dt * stress_power(point, L.strain_rate, point.volume / reference_volume);

    const T rate = trace(L.strain_rate);
    point.volume *= stretch(rate * dt);
    audit.volumetric_rate = std::max(audit.volumetric_rate, double(std::abs(rate)));

    const T ratio = point.volume / reference_volume;
    const T plastic = update_deviator(point, L, audit);
    const T c = update_pressure(point, L.strain_rate, ratio, audit);
    update_damage(point, plastic, L.strain_rate, ratio, audit);
    return c;
  }

 private:
  PM_HD T update_deviator(PointState<T>& point, const VelocityGradient<T>& L, Audit& audit) const {
    if (point.damage >= T(1)) {
      point.deviator = {};
      return T(0);
    }
    const T g = material.shear_modulus();
    point.deviator = rotate(point.deviator, dt * L.spin) + (T(2) * g * dt) * deviator(L.strain_rate);
    const T trial = effective(point.deviator);
    const auto back = material.strength.visit(
        [&](const auto& s) { return s.return_map(trial, point.plastic_strain, point.temperature, step); });
    if (!back.converged) audit.count(Counter::return_failures);
    const T increment = back.strain_increment;
    if (increment <= T(0)) return T(0);
    const T flow = trial - T(3) * g * increment;
    point.deviator = (flow / trial) * point.deviator;
    point.plastic_strain += increment;
    const T work = flow * increment;  // per current volume
    audit.plastic_work += double(work * point.volume);
    return increment;
  }

  // ratio = V/V0.
  PM_HD T update_pressure(PointState<T>& point, const Sym3<T>& strain_rate, T ratio, Audit& audit) const {
    const T compression = T(1) / ratio;
    const T rate = trace(strain_rate), strain = rate * dt;
    const auto isochore = material.eos.visit([&](const auto& e) { return e.at(compression - T(1)); });
    if (isochore.capped) audit.count(Counter::eos_caps);
    audit.compression = std::max(audit.compression, double(compression));

    const T bulk_c2 =
        material.specific_volume * std::max(isochore.stiffness(point.pressure, point.energy, ratio), T(0));
    point.viscosity = T(0);
    if (rate < T(0))
      point.viscosity = material.density() * compression * cell * -rate *
                        (material.q_quadratic * cell * -rate + material.q_linear * std::sqrt(bulk_c2));

    // E1 = E + w (s:D' - (p1+q) tr D) V/V0 dt with p1 = cold + thermal E1, solved together.
    const T weight = new_share * ratio;
    const T known =
        point.energy + weight * (dt * double_dot(point.deviator, strain_rate) - point.viscosity * strain);
    T p = (isochore.cold + isochore.thermal * known) / (T(1) + isochore.thermal * weight * strain);
    if (point.damage >= T(1)) p = std::max(p, T(0));
    point.pressure = p;
    point.energy = known - weight * p * strain;
    audit.viscous_work -= double(point.viscosity * strain * point.volume);

    const T shear = point.damage >= T(1)
                        ? T(0)
                        : T(4) / T(3) * material.shear_modulus() * ratio * material.specific_volume;
    return std::sqrt(bulk_c2 + shear);
  }

  PM_HD void update_damage(PointState<T>& point, T plastic, const Sym3<T>& strain_rate, T ratio,
                           Audit& audit) const {
    if (point.damage >= T(1) || plastic <= T(0)) return;
    const T flow = effective(point.deviator);
    const auto damage = material.failure.visit([&](const auto& f) {
      return f.step(plastic, -point.pressure, flow, plastic / step, point.temperature);
    });
    point.damage = std::max(point.damage + damage.increment, T(0));
    if (damage.treated) audit.count(Counter::failure_treatments);

    // Plastic work to heat: dT = chi sigma d eps / (rho C_p).
    const T work = flow * plastic * ratio;
    point.temperature += material.taylor_quinney * material.specific_volume * work / material.specific_heat;
    const bool melted = damage.may_fail && point.temperature >= material.t_melt;
    if (melted) audit.count(Counter::melted_points);
    if (melted) point.damage = std::max(point.damage, T(1));
    if (point.damage < T(1)) return;
    audit.count(Counter::failed_points);
    // The nodes will feel the failed stress, so that is what the energy is paid with.
    point.energy -= new_share * dt * stress_power(point, strain_rate, ratio);
    point.deviator = {};
    point.pressure = std::max(point.pressure, T(0));
    point.energy += new_share * dt * stress_power(point, strain_rate, ratio);
  }
};

}  // namespace pockmark
