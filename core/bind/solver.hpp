// A solver for Python: how it is made and stepped. The other files bind what is asked of it.
#pragma once
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <limits>

#include "accounts.hpp"
#include "checkpoint.hpp"
#include "points.hpp"

namespace pockmark::bind {

template <class D>
void set_contact(PySolver<D>& s, const std::vector<std::uint8_t>& in_second, double friction) {
  if (s.solver.points().count > 0) throw std::invalid_argument("set_contact: comes before the points");
  s.solver.set_contact(in_second, friction);
}

template <class D>
void bind_steps(SolverClass<D>& solver) {
  using S = PySolver<D>;
  solver
      .def(
          "initialize", [](S& s) { s.solver.initialize(); },
          "Prepare the first step, once all points are there.")
      .def(
          "advance",
          [](S& s, std::int64_t max_steps, double end, double pause) {
            return s.solver.advance(max_steps, end, pause);
          },
          "max_steps"_a, "end_time"_a, "pause"_a = std::numeric_limits<double>::infinity(),
          nb::call_guard<nb::gil_scoped_release>(),
          "Step to `end_time`, landing on it, unless `max_steps` or the first step at or beyond `pause` "
          "comes "
          "before, and return the steps done.")
      .def_prop_ro(
          "time", [](const S& s) { return s.solver.state().time; }, "Simulated time, s.")
      .def_prop_ro(
          "dt", [](const S& s) { return s.solver.state().dt; }, "Length of the last step, s.")
      .def_prop_ro("cycle", [](const S& s) { return s.solver.state().cycle; }, "Steps done.");
}

template <class D>
void bind_solver(nb::module_& m, const char* name) {
  using S = PySolver<D>;
  SolverClass<D> solver(m, name);
  solver
      .def(nb::init<std::array<double, 3>, double, std::array<int, 3>, const std::vector<Face>&,
                    std::vector<MaterialSpec>, const Options&, int, bool>(),
           "lower"_a, "cell"_a, "cells"_a, "faces"_a, "materials"_a, "options"_a, "threads"_a,
           "axisymmetric"_a = false)
      .def("set_contact", &set_contact<D>, "in_second"_a, "friction"_a,
           "Give the bodies for which `in_second` a velocity field of their own, before any point is added.")
      .def(
          "let_fly", [](S& s, const std::vector<std::uint8_t>& flies) { s.solver.let_fly(flies); }, "flies"_a,
          "Name the bodies that transmitting faces let pass, before `initialize`.")
      .def_prop_ro(
          "cells",
          [](const S& s) {
            const auto& c = s.solver.model().grid.cells;
            return std::int64_t(c[0]) * c[1] * c[2];
          },
          "Cells of the grid.");
  bind_points(solver);
  bind_steps(solver);
  bind_accounts(solver);
  bind_checkpoint(solver);
}

}  // namespace pockmark::bind
