// Where the energy is, and where it went: what the points have now, and what they lost.
#pragma once
#include "model.hpp"

namespace pockmark {

// Energies (J), and the mass (kg) and momentum (kg m/s) of the points in the grid.
struct Ledger {
  double kinetic = 0, internal = 0;
  double absorbed = 0;                         // by transmitting faces
  double left_kinetic = 0, left_internal = 0;  // carried out by points that left
  double pic = 0;                              // taken from the points' velocities by the PIC share
  double contact = 0;                          // by impact and friction where two bodies touch
  double filtered = 0;                         // heat of filters, a share of the internal energy's history
  double viscous = 0, plastic = 0;             // shares of the internal energy's history, for information
  double initial = 0;
  double mass = 0;
  Vec3<double> momentum{};
  double error() const {
    return kinetic + internal + absorbed + left_kinetic + left_internal + pic + contact - initial;
  }
  Ledger& operator+=(const Ledger& other) {
    kinetic += other.kinetic;
    internal += other.internal;
    mass += other.mass;
    momentum += other.momentum;
    return *this;
  }
};

// What left the grid.
struct Departed {
  double mass = 0, kinetic = 0, internal = 0;
  Vec3<double> momentum{};
};

// Adds a point to the energies, mass and momentum of the grid.
template <class T>
void add_point(Ledger& ledger, const Model<T>& model, const Points<T>& points, std::size_t p) {
  const auto v = points.vector(Field::velocity, p);
  const double m = model.mass(points, p);
  ledger.kinetic += 0.5 * m * double(dot(v, v));
  ledger.internal += model.internal_energy(points, p);
  ledger.mass += m;
  ledger.momentum += m * Vec3<double>{double(v.x), double(v.y), double(v.z)};
}

// Returns what the points have and carry now.
template <class T, class Driver>
Ledger energies(const Model<T>& model, const Driver& driver) {
  std::vector<Ledger> of_slots(driver.slots());
  driver.for_each_block([&](int slot, const Block& block) {
    for (std::size_t p = block.begin; p < block.end; ++p)
      add_point(of_slots[slot], model, driver.points(), p);
  });
  Ledger sum;
  for (const Ledger& one : of_slots) sum += one;
  return sum;
}

}  // namespace pockmark
