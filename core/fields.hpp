// The one table of material-point fields (in the order of `Field`): allocation, sorting, output and
// checkpoints all read it.
#pragma once
#include <array>
#include <cstddef>

namespace pockmark {

enum class Field {
  place,
  velocity,
  mass,
  dilation,
  energy,
  deviator,
  pressure,
  viscosity,
  plastic_strain,
  temperature,
  damage
};

struct FieldInfo {
  Field field;
  const char* name;
  int components;
  const char* unit;
  const char* description;
};

inline constexpr std::array field_table{
    FieldInfo{Field::place, "position", 3, "m",
              "position x, y, z; kept as the place in the stencil, in cells from its first node"},
    FieldInfo{Field::velocity, "velocity", 3, "m/s", "velocity x, y, z"},
    FieldInfo{Field::mass, "mass", 1, "kg", "mass; kept in units of a full cell's (Model::mass_unit)"},
    FieldInfo{Field::dilation, "volume", 1, "m^3", "current volume; kept as V/V0 - 1"},
    FieldInfo{Field::energy, "energy", 1, "J/m^3", "internal energy per initial volume"},
    FieldInfo{Field::deviator, "deviator", 6, "Pa", "deviatoric stress xx, yy, zz, xy, yz, zx"},
    FieldInfo{Field::pressure, "pressure", 1, "Pa",
              "pressure of the equation of state, positive in compression"},
    FieldInfo{Field::viscosity, "viscosity", 1, "Pa", "bulk viscosity q, added to the pressure"},
    FieldInfo{Field::plastic_strain, "plastic_strain", 1, "1", "effective plastic strain"},
    FieldInfo{Field::temperature, "temperature", 1, "K", "temperature"},
    FieldInfo{Field::damage, "damage", 1, "1", "damage D; at 1 and above the point has failed"},
};

// Index of each field's first component among all components.
inline constexpr auto field_offsets = [] {
  std::array<int, field_table.size() + 1> offsets{};
  for (std::size_t f = 0; f < field_table.size(); ++f)
    offsets[f + 1] = offsets[f] + field_table[f].components;
  return offsets;
}();
constexpr int first_component(Field field) { return field_offsets[std::size_t(field)]; }
inline constexpr int component_count = field_offsets[field_table.size()];

}  // namespace pockmark
