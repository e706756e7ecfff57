// Tillotson: solids and metals from rest to vapour. Tillotson 1962, GA-3216; the form and the low-density cut
// of Melosh 1989. With e = E/rho0 (J/kg), h = rho/rho0, w = 1 + e/(E0 h^2), nu = 1/h - 1:
//   p1 = (a + b/w) h E + A mu + B mu^2                                   compressed, or e <= E_iv
//   p2 = a h E + (b h E/w + A mu exp(-beta nu)) exp(-alpha nu^2)         expanded, and e >= E_cv
// and linear in e between. Below eta_min a condensed material tears: p1 falls to nothing at eta_zero.
#pragma once
#include <array>

#include "../elementary.hpp"
#include "eos.hpp"

namespace pockmark {

inline constexpr std::array tillotson_constants{
    Constant{"a", "", 0, 5, "Grueneisen's gamma of the vapour, less 1"},
    Constant{"b", "", 0, 20, "what rest adds to it"},
    Constant{"A", "Pa", 1, 1e13, "bulk modulus"},
    Constant{"B", "Pa", 0, 1e13, "its growth with compression"},
    Constant{"E0", "J/kg", 1e3, 1e10, "energy at which b counts half"},
    Constant{"E_iv", "J/kg", 1e3, 1e9, "energy of incipient vaporisation"},
    Constant{"E_cv", "J/kg", 1e3, 1e9, "energy of complete vaporisation", required, "E_iv"},
    Constant{"alpha", "", 0, 100, "how soon the vapour becomes an ideal gas"},
    Constant{"beta", "", 0, 100, "how soon its cold pressure vanishes"},
    Constant{"eta_min", "", 0, 1, "rho/rho0 below which the cold material tears", 0},
    Constant{"eta_zero", "", 0, 1, "rho/rho0 at which nothing holds it any more", 0},
};

template <class T>
struct Tillotson {
  static constexpr Declaration declaration{
      "tillotson", "from rest to vapour, without a table",
      "p = (a + b/(1 + e/(E0 h^2))) h E + A mu + B mu^2, and an ideal gas far away",
      "Tillotson 1962; Melosh 1989", tillotson_constants};
  static constexpr bool linear_in_energy = false;
  T a, b, A, B, E0, E_iv, E_cv, alpha, beta, eta_min, eta_zero;  // energies per m^3 of initial volume

  Tillotson() = default;
  explicit Tillotson(const Constants& given)
      : a(T(given["a"])),
        b(T(given["b"])),
        A(T(given["A"])),
        B(T(given["B"])),
        E0(T(given["density"] * given["E0"])),
        E_iv(T(given["density"] * given["E_iv"])),
        E_cv(T(given["density"] * given["E_cv"])),
        alpha(T(given["alpha"])),
        beta(T(given["beta"])),
        eta_min(T(given["eta_min"])),
        eta_zero(T(given["eta_zero"])) {}

  template <class V>
  PM_HD EosPoint<V> at(const Compression<V>& c, V energy) const {
    const auto vapour = vapourises(c, energy);
    const auto solid = torn(c, condensed(c, energy));
    if (!any(vapour)) return solid;
    return select(vapour, mixed(energy, solid, gas(c, energy)), solid);
  }
  template <class V>
  PM_HD V phase(const Compression<V>& c, V energy) const {
    return select(vapourises(c, energy), select(energy < V(E_cv), V(1), V(2)), V(0));
  }

 private:
  template <class V>
  PM_HD mask_t<V> vapourises(const Compression<V>& c, V energy) const {
    return c.mu < V(0) && V(E_iv) < energy;
  }

  // Returns what the energy adds near rest: b h E/w, and its slopes. Below rest w stays one.
  template <class V>
  PM_HD EosPoint<V> bound(const Compression<V>& c, V energy) const {
    const V h = V(1) + c.mu, heat = max(energy, V(0)) * c.ratio * c.ratio * (T(1) / E0);
    const V share = b / (V(1) + heat), part = share / (V(1) + heat);
    return {share * h * energy, (share + T(2) * part * heat) * energy, part * h};
  }
  template <class V>
  PM_HD EosPoint<V> condensed(const Compression<V>& c, V energy) const {
    const auto near = bound(c, energy);
    return {near.pressure + a * (V(1) + c.mu) * energy + c.mu * (A + B * c.mu),
            near.by_mu + a * energy + A + T(2) * B * c.mu, near.by_energy + a * (V(1) + c.mu)};
  }
  template <class V>
  PM_HD EosPoint<V> gas(const Compression<V>& c, V energy) const {
    const V nu = -c.eta, by_h = c.ratio * c.ratio;  // -d nu/dh
    const V fading = fast_exp(-alpha * nu * nu), cold = A * c.mu * fast_exp(-beta * nu);
    const auto near = bound(c, energy);
    const V bonds = near.pressure + cold;
    const V bonds_slope = near.by_mu + A * fast_exp(-beta * nu) + cold * beta * by_h;
    return {a * (V(1) + c.mu) * energy + bonds * fading,
            a * energy + (bonds_slope + bonds * (T(2) * alpha) * nu * by_h) * fading,
            a * (V(1) + c.mu) + near.by_energy * fading};
  }
  // Returns the pressure between the energies of incipient and of complete vaporisation, and beyond.
  template <class V>
  PM_HD EosPoint<V> mixed(V energy, const EosPoint<V>& solid, const EosPoint<V>& gas) const {
    const T per_energy = T(1) / (E_cv - E_iv);
    const V share = (energy - E_iv) * per_energy;
    const auto between = [&](V from, V to) { return from + share * (to - from); };
    const EosPoint<V> both{
        between(solid.pressure, gas.pressure), between(solid.by_mu, gas.by_mu),
        between(solid.by_energy, gas.by_energy) + per_energy * (gas.pressure - solid.pressure)};
    return select(V(E_cv) <= energy, gas, both);
  }
  template <class V>
  PM_HD EosPoint<V> torn(const Compression<V>& c, const EosPoint<V>& solid) const {
    const V h = V(1) + c.mu;
    const auto tears = h < V(eta_min);
    if (!any(tears)) return solid;
    const T width = max(eta_min - eta_zero, T(1e-6)), per_width = T(1) / width;
    const V left = min(max((h - eta_zero) * per_width, V(0)), V(1));
    const V slope = select(V(eta_zero) < h, per_width * solid.pressure, V(0));
    return select(
        tears, EosPoint<V>{left * solid.pressure, left * solid.by_mu + slope, left * solid.by_energy}, solid);
  }
};

}  // namespace pockmark
