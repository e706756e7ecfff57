// What a run is given and never changes: options, faces, materials.
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "../constitutive.hpp"
#include "../transmitting.hpp"

namespace pockmark {

enum class Scheme { usf, musl, usl, usavg };
enum class ShapeFunction { trilinear, quadratic };
enum class VolumetricStrain { points, cells };
enum class AtNodes { mean, linear };

struct Options {
  Scheme scheme;
  ShapeFunction shape;
  VolumetricStrain volumetric_strain;  // where a point takes it from
  AtNodes node_velocity;               // of which field a node has its value: levers.hpp
  double cfl;                          // dt <= cfl h / (|v| + c)
  double strain_limit;                 // dt <= strain_limit / |tr D|
  double pic_fraction;
  double mass_cutoff;      // in units of the lightest rho0 h^3
  bool sleep;              // points at rest are passed over
  int filter_interval;     // steps from one filtering to the next; 0: none (filter.hpp)
  int filter_order;        // of the velocity's filter; 0: velocities stay
  double pressure_filter;  // share of the unseen pressure that relaxes
};

template <class T>
struct Model {
  GridGeometry<T> grid;
  Faces faces;
  std::vector<Material<T>> materials;  // of each body
  std::vector<Damper<T>> dampers;      // of each body
  Options options;
  // What masses are kept in (kg), and with them volumes, forces and energies on their way through a step:
  // about a full cell's, so that single precision holds the mass of any node of any body. A power of two: no
  // digit of a result depends on it.
  double mass_unit = 1;
  T cutoff{};  // of a node's mass, in mass units
  std::vector<std::uint8_t>
      in_second;  // of each body, with contact: whether the second velocity field is its own

  Model(const GridGeometry<T>& geometry, const Faces& faces_, std::vector<Material<T>> materials_,
        const Options& options_)
      : grid(geometry), faces(faces_), materials(std::move(materials_)), options(options_) {
    for (int face = 0; face < 6; ++face) grid.is_symmetric[face] = faces[face] == Face::symmetry;
    T lightest = std::numeric_limits<T>::max();
    for (const auto& m : materials) {
      dampers.push_back({m.density * m.dilatational_speed(), m.density * m.shear_speed(), m.specific_volume});
      lightest = std::min(lightest, m.density);
    }
    const double cell_mass = double(lightest) * std::pow(double(geometry.cell), 3);
    mass_unit = std::exp2(std::round(std::log2(cell_mass)));
    cutoff = T(options.mass_cutoff * cell_mass / mass_unit);
  }

  bool by_cells() const { return options.volumetric_strain == VolumetricStrain::cells; }
  bool is_linear() const { return options.node_velocity == AtNodes::linear; }
  double mass(const Points<T>& points, std::size_t p) const {
    return mass_unit * double(points.at(Field::mass)[p]);
  }
  double reference_volume(const Points<T>& points, std::size_t p) const {
    return mass(points, p) * double(materials[points.body[p]].specific_volume);
  }
  double volume(const Points<T>& points, std::size_t p) const {
    return (1 + double(points.at(Field::dilation)[p])) * reference_volume(points, p);
  }
  double internal_energy(const Points<T>& points, std::size_t p) const {
    return double(points.at(Field::energy)[p]) * reference_volume(points, p);
  }
};

}  // namespace pockmark
