// What the CPU asks its cache for ahead of each pass over the points: their streams are too many for the
// processor to foresee.
#pragma once
#include "../transfer.hpp"

namespace pockmark::cpu {

// `width`: of the kernels' packs.
template <int width>
struct Prefetch {
  // Asks for fields of the points three blocks on from p. Each pass asks for a share of what the passes after
  // it read: the processor keeps few lines under way at a time.
  template <Pass pass, class T>
  PM_HD static void before(const Points<T>& points, std::size_t p) {
    if constexpr (width == 1)
      if (p % (line / sizeof(T)) != 0) return;  // asked for with the first point of its line
    if constexpr (pass == Pass::gradient) ask(points, p, Field::place);
    if constexpr (pass == Pass::strain) ask(points, p, Field::dilation, Field::energy, Field::deviator);
    if constexpr (pass == Pass::pressure)
      ask(points, p, Field::velocity, Field::mass, Field::pressure, Field::viscosity, Field::plastic_strain,
          Field::temperature, Field::damage);
    if constexpr (pass == Pass::velocity)
      ask(points, p, Field::place, Field::velocity, Field::mass);  // the mass is for the mapping
    if constexpr (pass == Pass::last_strain)  // and what the mapping that follows will read
      ask(points, p, Field::dilation, Field::energy, Field::deviator, Field::pressure, Field::viscosity,
          Field::damage, Field::velocity, Field::mass);
  }
  // Asks for what the moments of the points of a bundle take.
  template <class T>
  PM_HD static void moments(const Points<T>& points, const Bundle& bundle) {
    for (const T* at : {points.at(Field::place, 0), points.at(Field::place, 1), points.at(Field::place, 2),
                        points.at(Field::mass)}) {
      __builtin_prefetch(at + bundle.begin);
      __builtin_prefetch(at + bundle.end - 1);
    }
  }

 private:
  static constexpr std::size_t ahead = 3 * Block::most, line = 64;

  template <class T, class... Fields>
  PM_HD static void ask(const Points<T>& points, std::size_t p, Fields... fields) {
    (ask_for(points, p, fields), ...);
  }
  template <class T>
  PM_HD static void ask_for(const Points<T>& points, std::size_t p, Field field) {
    for (int c = first_component(field); c < field_offsets[std::size_t(field) + 1]; ++c)
      __builtin_prefetch(points.components[c] + p + ahead, 1, 2);
  }
};

}  // namespace pockmark::cpu
