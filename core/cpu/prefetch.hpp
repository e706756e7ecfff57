// What the CPU asks its cache for ahead of each pass over the points: their streams are too many for the
// processor to foresee.
#pragma once
#include <utility>

#include "../transfer.hpp"

namespace pockmark::cpu {

struct Prefetch {
  // Asks for fields of the points a few blocks on from p. Each pass asks for a share of what the passes after
  // it read: the queue of lines under way is short.
  template <Pass pass, class T>
  PM_HD static void before(const Points<T>& points, std::size_t p) {
    if constexpr (pass == Pass::gradient) ask<Field::place>(points, p);
    if constexpr (pass == Pass::strain) ask<Field::dilation, Field::energy, Field::deviator>(points, p);
    if constexpr (pass == Pass::pressure)
      ask<Field::velocity, Field::mass, Field::pressure, Field::viscosity, Field::plastic_strain,
          Field::temperature, Field::damage>(points, p);
    if constexpr (pass == Pass::velocity)
      ask<Field::place, Field::velocity, Field::mass>(points, p);  // the mass is for the mapping
    if constexpr (pass == Pass::last_strain)  // and what the mapping that follows will read
      ask<Field::dilation, Field::energy, Field::deviator, Field::pressure, Field::viscosity, Field::damage,
          Field::velocity, Field::mass>(points, p);
  }

 private:
  static constexpr std::size_t ahead = 144;

  template <Field... fields, class T>
  PM_HD static void ask(const Points<T>& points, std::size_t p) {
    (ask_for<fields>(points, p), ...);
  }
  template <Field field, class T>
  PM_HD static void ask_for(const Points<T>& points, std::size_t p) {
    constexpr int first = first_component(field), count = field_offsets[std::size_t(field) + 1] - first;
    [&]<int... c>(std::integer_sequence<int, c...>) PM_INLINE {
      (__builtin_prefetch(points.components[first + c] + p + ahead, 1, 2), ...);
    }(std::make_integer_sequence<int, count>{});
  }
};

}  // namespace pockmark::cpu
