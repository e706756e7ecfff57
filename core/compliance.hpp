// How much a point opens or closes in a wave that changes its pressure.
#pragma once
#include "constitutive.hpp"

namespace pockmark {

// Returns by how much V/V0 grows in a wave in which the pressure falls, 1/Pa; 0 where no wave goes. One
// that raises it finds the material ever stiffer: by about four times the rise at its end, and half of it
// in the mean. Without this the points in front of a shock at 12 km/s are crushed to where the law ends. No
// material under pressure is softer than a gas that keeps its temperature, J p: where a law's own slope tends
// to nothing, between solid and vapour, points would open without end.
template <class V, class T = number_t<V>>
PM_HD V compliance(const Material<T>& material, const PointState<V>& point, V fall) {
  const V ratio = point.ratio();
  const auto change = Compression<V>::of(point.dilation);
  const auto now =
      material.eos.visit([&](const auto& eos) PM_INLINE { return eos.at(change, point.energy); });
  const V shear = V(T(4.0 / 3.0)) * material.shear(conditions_of(point));
  const V bulk = max(now.stiffness(point.pressure, ratio), V(0));
  const V stiffness = max(bulk + shear, ratio * point.pressure) + V(T(2)) * ratio * max(-fall, V(0));
  const auto goes = V(0) < stiffness;
  return select(goes, ratio * ratio / select(goes, stiffness, V(1)), V(0));
}

}  // namespace pockmark
