// What a solver is told before it has points: faces, scheme, shape functions, numbers.
#pragma once
#include "../boundary.hpp"
#include "../method/model.hpp"
#include "arrays.hpp"

namespace pockmark::bind {

inline void bind_options(nb::module_& m) {
  nb::enum_<Face>(m, "Face")
      .value("free", Face::free)
      .value("symmetry", Face::symmetry)
      .value("fixed", Face::fixed)
      .value("transmitting", Face::transmitting);
  nb::enum_<Scheme>(m, "Scheme")
      .value("usf", Scheme::usf)
      .value("musl", Scheme::musl)
      .value("usl", Scheme::usl)
      .value("usavg", Scheme::usavg);
  nb::enum_<ShapeFunction>(m, "ShapeFunction")
      .value("trilinear", ShapeFunction::trilinear)
      .value("quadratic", ShapeFunction::quadratic);
  nb::enum_<VolumetricStrain>(m, "VolumetricStrain")
      .value("points", VolumetricStrain::points)
      .value("cells", VolumetricStrain::cells);
  nb::enum_<AtNodes>(m, "AtNodes").value("mean", AtNodes::mean).value("linear", AtNodes::linear);
  nb::class_<Options>(m, "Options")
      .def(
          "__init__",
          [](Options* self, Scheme scheme, ShapeFunction shape, VolumetricStrain volumetric_strain,
             AtNodes node_velocity, double cfl, double strain_limit, double pic_fraction, double mass_cutoff,
             bool sleep, int filter_interval, int filter_order, double pressure_filter) {
            new (self) Options{scheme, shape,           volumetric_strain, node_velocity,
                               cfl,    strain_limit,    pic_fraction,      mass_cutoff,
                               sleep,  filter_interval, filter_order,      pressure_filter};
          },
          "scheme"_a, "shape"_a, "volumetric_strain"_a, "node_velocity"_a, "cfl"_a, "strain_limit"_a,
          "pic_fraction"_a, "mass_cutoff"_a, "sleep"_a, "filter_interval"_a = 0, "filter_order"_a = 0,
          "pressure_filter"_a = 0.0);
}

}  // namespace pockmark::bind
