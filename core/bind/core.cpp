// The Python extension: names and conversions only, a file a domain. Defaults live in Python.
#include "../cpu/driver.hpp"
#include "../plain/driver.hpp"
#include "build.hpp"
#include "materials.hpp"
#include "options.hpp"
#include "solver.hpp"

using namespace pockmark;

NB_MODULE(POCKMARK_MODULE, m) {
  bind::bind_options(m);
  bind::bind_materials(m);
  bind::bind_solver<cpu::Driver<double, WidestPack<double>>>(m, "Solver");
  bind::bind_solver<cpu::Driver<float, WidestPack<float>>>(m, "SolverSingle");
  bind::bind_solver<plain::Driver<double>>(m, "PlainSolver");
  bind::bind_solver<plain::Driver<float>>(m, "PlainSolverSingle");
  m.def("fields", &bind::fields, "Return the fields of the points: name, components, unit, description.");
  bind::bind_build(m);
}
