// What a run must account for, for Python: energies, counters, impossible points, time and memory.
#pragma once
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "py_solver.hpp"

namespace pockmark::bind {

using Numbers = nb::typed<nb::dict, std::string, double>;
using Counts = nb::typed<nb::dict, std::string, int>;
using Impossible =
    nb::typed<nb::dict, std::string,
              nb::typed<nb::tuple, int, nb::typed<nb::list, double>, nb::typed<nb::list, double>>>;

template <class D>
Numbers get_ledger(const PySolver<D>& s) {
  const Ledger l = s.solver.ledger();
  const Departed& departed = s.solver.state().departed;
  nb::dict d;
  d["time"] = s.solver.state().time;
  d["kinetic"] = l.kinetic;
  d["internal"] = l.internal;
  d["absorbed"] = l.absorbed;
  d["left_kinetic"] = l.left_kinetic;
  d["left_internal"] = l.left_internal;
  d["left_energy"] = l.left_kinetic + l.left_internal;
  d["pic"] = l.pic;
  d["contact"] = l.contact;
  d["filtered"] = l.filtered;
  d["viscous"] = l.viscous;
  d["plastic"] = l.plastic;
  d["initial"] = l.initial;
  d["error"] = l.error();
  d["momentum_x"] = l.momentum.x;
  d["momentum_y"] = l.momentum.y;
  d["momentum_z"] = l.momentum.z;
  d["mass"] = l.mass;
  d["left_mass"] = departed.mass;
  d["left_momentum_x"] = departed.momentum.x;
  d["left_momentum_y"] = departed.momentum.y;
  d["left_momentum_z"] = departed.momentum.z;
  return d;
}

template <class D>
Counts get_counters(const PySolver<D>& s) {
  nb::dict d;
  for (std::size_t i = 0; i < counter_names.size(); ++i)
    d[counter_names[i]] = s.solver.state().audit.counts[i];
  return d;
}

template <class D>
Impossible get_impossible(const PySolver<D>& s) {
  nb::dict d;
  for (const auto& [counter, where] : impossible(s.solver.model(), s.solver.points()))
    d[counter_names[std::size_t(counter)]] = nb::make_tuple(where.points, where.lower, where.upper);
  return d;
}

template <class D>
Counts get_memory(const PySolver<D>& s) {
  nb::dict d;
  d["points"] = s.solver.driver().point_bytes();
  d["grid"] = s.solver.node_bytes();
  return d;
}

template <class D>
void bind_accounts(SolverClass<D>& solver) {
  using S = PySolver<D>;
  solver
      .def("ledger", &get_ledger<D>,
           "Return where energy (J), momentum (kg m/s) and mass (kg) are, and where they went.")
      .def("counters", &get_counters<D>, "Return how often each clamp, floor and loss happened.")
      .def("impossible", &get_impossible<D>,
           "Return the points that are in an impossible state now, by the counter of it: how many, and the "
           "corners "
           "of a box around them, m.")
      .def(
          "max_compression", [](const S& s) { return s.solver.state().audit.compression; },
          "Return the largest rho/rho0 of any point so far.")
      .def_prop_ro(
          "sorts", [](const S& s) { return s.solver.driver().sorts(); },
          "How often the points were sorted by cell.")
      .def_prop_ro(
          "sleeping_points", [](const S& s) { return s.solver.driver().sleeping_points(); },
          "Points that steps pass over, for they and all around them are at rest.")
      .def(
          "timers", [](const S& s) { return s.solver.timers().seconds(); },
          "Return the seconds that each phase of the steps took.")
      .def("memory_bytes", &get_memory<D>, "Return the bytes of points and of the grid.");
}

}  // namespace pockmark::bind
