// Materials and laws for Python: what each law declares, a material made by names, and its laws row by row.
#pragma once
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <limits>
#include <variant>

#include "../material.hpp"
#include "arrays.hpp"

namespace pockmark::bind {

using LawTable = std::map<std::string, std::variant<double, std::string>>;  // `model` and its constants
using Table = nb::typed<nb::dict, std::string, nb::any>;

inline Table as_table(const Constant& c) {
  nb::dict d;
  d["name"] = c.name;
  d["unit"] = c.unit;
  d["doc"] = c.doc;
  d["above"] = c.above;
  d["least"] = c.least;
  d["most"] = c.most;
  d["choices"] = nb::str(c.choices).attr("split")();
  d["default"] = std::isnan(c.fallback) ? nb::none() : nb::cast(c.fallback);
  return d;
}

// Returns what the laws of a list declare, and the properties that only some kinds of law have.
template <class Laws>
nb::list declarations() {
  nb::list out;
  Laws::for_each([&]<class Law>() {
    const Declaration& law = Law::declaration;
    nb::list constants;
    for (const auto& c : law.constants) constants.append(as_table(c));
    nb::dict d;
    d["name"] = law.name;
    d["doc"] = law.doc;
    d["equation"] = law.equation;
    d["source"] = law.source;
    d["constants"] = constants;
    if constexpr (StrengthLaw<Law, double>) d["yields"] = YieldingLaw<Law, double>;
    if constexpr (FailureLaw<Law, double>) {
      d["needs_flow"] = Law::needs_flow;
      d["may_fail"] = Law::may_fail;
    }
    out.append(d);
  });
  return out;
}
inline nb::typed<nb::dict, std::string, nb::typed<nb::list, Table>> laws() {
  nb::dict d;
  d["eos"] = declarations<Eos<double>>();
  d["strength"] = declarations<Strength<double>>();
  d["failure"] = declarations<Failure<double>>();
  return d;
}

// Returns a law as it is written in Python, choices by their names.
template <class Laws>
MaterialSpec::Law law_of(const LawTable& table) {
  MaterialSpec::Law out;
  if (const auto model = table.find("model"); model != table.end())
    if (const auto* name = std::get_if<std::string>(&model->second)) out.model = *name;
  const auto choice = [&](const std::string& name, const std::string& chosen) {
    int place = -1;
    Laws::for_each([&]<class Law>() {
      for (const auto& c : Law::declaration.constants)
        if (out.model == Law::declaration.name && name == c.name) place = place_among(c.choices, chosen);
    });
    if (place < 0) throw std::invalid_argument(out.model + "." + name + ": found '" + chosen + "'");
    return double(place);
  };
  for (const auto& [name, value] : table)
    if (name != "model") {
      const auto* number = std::get_if<double>(&value);
      out.constants.set(name.c_str(), number ? *number : choice(name, std::get<std::string>(value)));
    }
  return out;
}

inline NumPy<double> eos_at(const MaterialSpec& spec, Rows rows) {
  const auto material = spec.as<double>();
  return by_rows<2, 6>(rows, [&](const double* in, double* out) {
    const auto change = Compression<double>::of(-in[0] / (1 + in[0]));
    material.eos.visit([&](const auto& law) {
      const auto point = law.at(change, in[1]);
      out[0] = point.pressure;
      out[1] = point.by_mu;
      out[2] = point.by_energy;
      out[3] = point.capped;
      out[4] = out[5] = std::numeric_limits<double>::quiet_NaN();
      if constexpr (requires { law.temperature(change, in[1]); }) out[4] = law.temperature(change, in[1]);
      if constexpr (requires { law.phase(change, in[1]); }) out[5] = law.phase(change, in[1]);
    });
  });
}

inline NumPy<double> strength_at(const MaterialSpec& spec, Rows rows) {
  const auto material = spec.as<double>();
  return by_rows<6, 7>(rows, [&](const double* in, double* out) {
    const Conditions<double> conditions{in[2], in[3], in[4], in[5]};
    std::fill(out, out + 7, 0.0);
    out[0] = out[5] = std::numeric_limits<double>::infinity();
    out[6] = material.shear(conditions);
    material.strength.visit([&]<class Law>(const Law& law) {
      if constexpr (YieldingLaw<Law, double>) {
        const auto yield_surface = law.yield_surface(conditions);
        const auto flow = yield_surface.at(in[0], fast_log(max(in[1], 1e-300)));
        out[0] = flow.stress;
        out[1] = flow.by_strain;
        out[2] = flow.by_strain2;
        out[3] = flow.by_rate;
        out[4] = flow.by_both;
        out[5] = law.least(conditions);
        if constexpr (requires { yield_surface.ceiling(); }) {
          if (out[0] > yield_surface.ceiling()) {
            out[0] = yield_surface.ceiling();
            out[1] = out[2] = 0;
          }
        }
      }
    });
  });
}

// Returns what a failure law says of its own constants: what `say` returns of it.
template <class Say>
std::string said(const LawTable& table, Say&& say) {
  const auto written = law_of<Failure<double>>(table);
  std::string out;
  Failure<double>::for_each([&]<class Law>() {
    if (written.model != Law::declaration.name) return;
    auto constants = completed(Law::declaration, written.constants);
    constants.set("room_temperature", 0);
    constants.set("melt_temperature", 1);
    constants.set("density", 1);
    out = say(Law(constants));
  });
  return out;
}
inline std::string failure_fault(const LawTable& table) {
  return said(table, [](const auto& law) {
    if constexpr (requires { law.fault(); })
      return law.fault();
    else
      return std::string();
  });
}
inline std::string failure_caution(const LawTable& table) {
  return said(table, [](const auto& law) {
    if constexpr (requires { law.caution(); })
      return law.caution();
    else
      return std::string();
  });
}

inline void make_material(MaterialSpec* self, const LawTable& eos, const LawTable& strength,
                          const LawTable& failure, double density, double specific_heat,
                          double taylor_quinney, double room_temperature, double melt_temperature,
                          double q_quadratic, double q_linear) {
  if (!(melt_temperature > room_temperature))
    throw std::invalid_argument("melt_temperature must exceed room_temperature");
  MaterialSpec spec{law_of<Eos<double>>(eos),
                    law_of<Strength<double>>(strength),
                    law_of<Failure<double>>(failure),
                    density,
                    specific_heat,
                    taylor_quinney,
                    room_temperature,
                    melt_temperature,
                    q_quadratic,
                    q_linear};
  spec.as<double>();  // throws where a law's constants are wrong, and says which
  new (self) MaterialSpec(std::move(spec));
}

inline void bind_materials(nb::module_& m) {
  nb::class_<MaterialSpec>(m, "Material", "A material as it is written, SI.")
      .def("__init__", &make_material, nb::kw_only(), "eos"_a, "strength"_a, "failure"_a, "density"_a,
           "specific_heat"_a, "taylor_quinney"_a, "room_temperature"_a, "melt_temperature"_a, "q_quadratic"_a,
           "q_linear"_a)
      .def_prop_ro(
          "bulk_modulus", [](const MaterialSpec& s) { return s.as<double>().bulk_modulus; },
          "Bulk modulus at rest, Pa.")
      .def_prop_ro(
          "shear_modulus", [](const MaterialSpec& s) { return s.as<double>().shear_modulus; },
          "Shear modulus at rest, Pa.")
      .def("eos_at", &eos_at, "rows"_a,
           "Return rows of pressure, its slopes by mu and E, whether the compression is capped, temperature, "
           "phase, "
           "for rows of mu, E.\n\nTemperature and phase are nan where the law knows neither.")
      .def("strength_at", &strength_at, "rows"_a,
           "Return rows of flow stress, its four slopes, least flow stress, shear modulus, for rows of "
           "plastic "
           "strain, rate, temperature, pressure, V/V0, damage.\n\nThe slopes are those of `Flow` "
           "(core/strength/strength.hpp). A law that does not yield has an infinite flow stress.");
  m.def("laws", &laws, "Return what each law declares of itself, by kind: eos, strength, failure.");
  m.def("failure_fault", &failure_fault, "law"_a, "Say why a failure law never acts; nothing where it does.");
  m.def("failure_caution", &failure_caution, "law"_a,
        "Say what is to be known of a failure law's constants; nothing where nothing is.");
}

}  // namespace pockmark::bind
