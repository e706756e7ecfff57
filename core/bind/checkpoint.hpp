// All that a step reads of the steps before it, as a dictionary for Python; and back.
#pragma once
#include <nanobind/stl/string.h>

#include "py_solver.hpp"

namespace pockmark::bind {

// Makes a dictionary of the parts of a solver: numbers, and arrays of which long ones are views that keep
// `owner`.
struct Saver {
  static constexpr bool restores = false;
  nb::dict& out;
  nb::handle owner;

  template <class V>
  void operator()(const std::string& name, const V& number) {
    out[name.c_str()] = number;
  }
  template <class V, class A>
  void operator()(const std::string& name, const std::vector<V, A>& values) {
    const std::size_t shape[1] = {values.size()};
    if constexpr (std::is_same_v<A, std::allocator<V>>)
      out[name.c_str()] = nb::cast(to_array(values, 1, shape));
    else
      out[name.c_str()] = nb::ndarray<nb::numpy, const V>(values.data(), 1, shape, owner);
  }
};

// Takes the parts of a solver out of such a dictionary, or of another mapping, one at a time. Throws
// std::invalid_argument where one is missing.
struct Restorer {
  static constexpr bool restores = true;
  const nb::object& in;

  nb::object at(const std::string& name) const {
    nb::object found = in.attr("get")(name);
    if (found.is_none()) throw std::invalid_argument(name + ": is missing");
    return found;
  }
  template <class V>
  void operator()(const std::string& name, V& number) const {
    if (!nb::try_cast(at(name), number)) throw std::invalid_argument(name + ": is no such number");
  }
  template <class V, class A>
  void operator()(const std::string& name, std::vector<V, A>& values) const {
    nb::ndarray<const V, nb::ndim<1>, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(at(name), given, false)) throw std::invalid_argument(name + ": is no such array");
    values.assign(given.data(), given.data() + given.size());
  }
};

template <class D>
void bind_checkpoint(SolverClass<D>& solver) {
  using S = PySolver<D>;
  solver
      .def(
          "save",
          [](nb::handle self) -> nb::typed<nb::dict, std::string, nb::any> {
            nb::dict out;
            nb::cast<S&>(self).solver.for_each_part(Saver{out, self});
            return out;
          },
          nb::sig("def save(self) -> dict[str, typing.Any]"),
          "Return all that a step reads of the steps before it, by name; long arrays are views of the "
          "solver's "
          "memory.")
      .def(
          "restore", [](S& s, const nb::object& parts) { s.solver.for_each_part(Restorer{parts}); },
          "parts"_a, nb::sig("def restore(self, parts: collections.abc.Mapping[str, typing.Any]) -> None"),
          "Take back what `save` returned, in a solver that never had points.");
}

}  // namespace pockmark::bind
