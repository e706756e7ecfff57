// Kernels by themselves, for the tests alone (pockmark._kernels_ISA): each is held against an independent
// reference.
#include <nanobind/stl/string.h>

#include "../lanes.hpp"
#include "../stress.hpp"
#include "arrays.hpp"

namespace pockmark::bind {

// The stress update alone, as the step does it, of rows of states: volume, energy, pressure, viscosity,
// plastic strain, temperature, damage, deviator (6). A row of gradients is D (6) and the axial vector of the
// spin (3).
struct StressByRows {
  static constexpr int in = 13, out = 14;
  static constexpr Field fields[7]{Field::dilation,  Field::energy,         Field::pressure,
                                   Field::viscosity, Field::plastic_strain, Field::temperature,
                                   Field::damage};

  template <class V>
  static std::vector<double> run(const MaterialSpec& spec, Doubles states, Doubles gradients, double mass,
                                 double cell, double dt) {
    const std::vector<Material<double>> materials{spec.as<double>()};
    const double reference_volume = mass * materials[0].specific_volume;
    const std::size_t n = states.size() / in;
    PointStore<double> store;
    store.resize(n);
    const auto points = store.view();
    std::vector<double> rows(out * n);
    const auto component = [&](int c, std::size_t p) -> double& {
      return c < 7 ? points.at(fields[c])[p] : points.at(Field::deviator, c - 7)[p];
    };
    for (std::size_t p = 0; p < n; ++p) {
      points.at(Field::mass)[p] = mass;
      for (int c = 0; c < in; ++c) component(c, p) = states.data()[p * in + c];
      component(0, p) = component(0, p) / reference_volume - 1;
    }
    const auto update = [&](const Points<double>& of, std::size_t begin, std::size_t end) {
      const Block block{begin, end, true, 0, nullptr};
      StrainColumns<double> strains;
      for (std::size_t p = begin; p < end; ++p) {
        const double* d = gradients.data() + 9 * p;
        store_strain(strains, p - begin,
                     Strain<double>(dt * Sym3<double>{d[0], d[1], d[2], d[3], d[4], d[5]},
                                    dt / 2 * Vec3<double>{d[6], d[7], d[8]}));
      }
      Audit audit;
      Columns<double, 6> push;
      update_stress<V, NoHints>(of, materials.data(), cell, block, strains, {dt, dt, 0.5, 0.5}, audit, push);
      return audit.wave_speed;
    };
    auto copy = store;
    const auto alone = copy.view();  // at rest and one by one, the fastest wave is the sound speed
    for (std::size_t p = 0; p < n; ++p) rows[p * out + in] = update(alone, p, p + 1);
    for (std::size_t begin = 0; begin < n; begin += Block::most)
      update(points, begin, std::min(begin + Block::most, n));
    for (std::size_t p = 0; p < n; ++p) {
      component(0, p) = (1 + component(0, p)) * reference_volume;
      for (int c = 0; c < in; ++c) rows[p * out + c] = component(c, p);
    }
    return rows;
  }
};

// Returns the states after one update, and with each the sound speed.
inline NumPy<double> stress_by_rows(const MaterialSpec& spec, Doubles states, Doubles gradients, double mass,
                                    double cell, double dt, bool lanes) {
  const std::size_t n = states.size() / StressByRows::in;
  if (gradients.size() != 9 * n) throw std::invalid_argument("gradients: nine numbers a state are needed");
  const auto run = lanes ? &StressByRows::run<WidestPack<double>> : &StressByRows::run<double>;
  return to_array(run(spec, states, gradients, mass, cell, dt), n, StressByRows::out);
}

template <class V>
V elementary_of(const std::string& name, V x, double n) {
  if (name == "log") return fast_log(x);
  if (name == "rough_log") return rough_log(x);
  if (name == "exp") return fast_exp(x);
  if (name == "pow") return fast_pow(x, n);
  throw std::invalid_argument("no function is named '" + name + "'");
}
template <class V>
std::vector<double> elementary_of_each(const std::string& name, Doubles x, double n) {
  constexpr int width = Pack<V>::width;
  std::vector<double> in(x.data(), x.data() + x.size()), out(x.size() + width);
  in.resize(x.size() + width, 1.0);  // the last pack may reach beyond the numbers
  for (std::size_t i = 0; i < x.size(); i += width)
    Pack<V>::store(out.data() + i, elementary_of(name, Pack<V>::load(in.data() + i), n));
  out.resize(x.size());
  return out;
}
inline NumPy<double> elementary(const std::string& name, Doubles x, double n, bool lanes) {
  const auto run = lanes ? &elementary_of_each<WidestPack<double>> : &elementary_of_each<double>;
  return to_array(run(name, x, n), x.size(), 1);
}

inline NumPy<double> failure_at(const MaterialSpec& spec, Rows rows) {
  const auto material = spec.as<double>();
  return by_rows<7, 3>(rows, [&](const double* in, double* out) {
    const Loading<double> loading{in[0], in[1], in[2], in[3], in[4], in[5], in[6]};
    const auto damage = material.failure.visit([&](const auto& law) { return law.step(loading); });
    out[0] = damage.increment;
    out[1] = damage.treated;
    out[2] = material.may_fail(in[2]);
  });
}

}  // namespace pockmark::bind

// A material is one of the core's of the same instruction set, which must be imported first.
NB_MODULE(POCKMARK_MODULE, m) {
  using namespace pockmark::bind;
  m.def("update_stress", &stress_by_rows, "material"_a, "states"_a, "gradients"_a, "mass"_a, "cell"_a, "dt"_a,
        "lanes"_a, "Return rows of states after one stress update, and the sound speed.");
  m.def("elementary", &elementary, "name"_a, "x"_a, "n"_a, "lanes"_a,
        "Return log x, a rough log x, exp x or x^n of each number.");
  m.def("failure_at", &failure_at, "material"_a, "rows"_a,
        "Return rows of damage increment, whether a treatment changed the law, whether the point may fail "
        "without "
        "plastic strain, for rows of plastic strain increment, its rate, mean and effective stress, "
        "temperature, "
        "damage, and cell.");
}
