// The homologous temperature of Johnson and Cook: T* = (T - T_room)/(T_melt - T_room), cut to 0 .. 1.
#pragma once
#include "lanes.hpp"

namespace pockmark {

template <class T>
struct HomologousTemperature {
  T t_room, t_melt;

  HomologousTemperature() = default;
  HomologousTemperature(T t_room_, T t_melt_)
      : t_room(t_room_), t_melt(t_melt_), per_kelvin_(T(1) / (t_melt_ - t_room_)) {}

  template <class V>
  PM_HD V operator()(V temperature) const {
    return min(max((temperature - t_room) * per_kelvin_, V(0)), V(1));
  }

 private:
  T per_kelvin_;  // kept: the division would be done for every pack
};

}  // namespace pockmark
