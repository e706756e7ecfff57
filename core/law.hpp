// What a law says of itself, once: its name, its equation and source, and each constant that a scene gives
// it. Bindings, ranges, error sentences and docs are made from it.
#pragma once
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pockmark {

inline constexpr double required = std::numeric_limits<double>::quiet_NaN();

// A constant of a law, in SI.
struct Constant {
  const char* name;
  const char* unit;    // "" for a plain number
  double least, most;  // what a scene may write
  const char* doc;
  double fallback = required;
  const char* above = "";    // the constant of the same law that it must exceed
  const char* choices = "";  // names, apart by spaces: it is one of them, and kept as its place among them
};

struct Declaration {
  const char* name;  // `model` in a scene
  const char* doc;
  const char* equation;
  const char* source;
  std::span<const Constant> constants;
};

// Constants by name. A law's constructor reads its own there, and those that all laws of a material share:
// density, room_temperature, melt_temperature.
class Constants {
 public:
  Constants() = default;
  Constants(std::map<std::string, double, std::less<>> values) : values_(std::move(values)) {}

  bool has(std::string_view name) const { return values_.contains(name); }
  void set(const char* name, double value) { values_[name] = value; }
  double operator[](std::string_view name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw std::invalid_argument("no constant '" + std::string(name) + "'");
    return found->second;
  }
  const auto& values() const { return values_; }

 private:
  std::map<std::string, double, std::less<>> values_;
};

// Returns a text with numbers in it.
template <class... Values>
std::string text(const char* format, Values... values) {
  char out[300];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

// Returns the place of a name among a constant's choices, or -1.
inline int place_among(std::string_view choices, std::string_view name) {
  for (int place = 0; !choices.empty(); ++place) {
    const auto end = std::min(choices.find(' '), choices.size());
    if (choices.substr(0, end) == name) return place;
    choices.remove_prefix(std::min(end + 1, choices.size()));
  }
  return -1;
}

// Returns a law's constants with its defaults. Throws std::invalid_argument where one is unknown, missing,
// not finite, or negative where none may be; the ranges are for who writes scenes, and checked there.
inline Constants completed(const Declaration& law, Constants given) {
  const auto fault = [&](const std::string& what) {
    throw std::invalid_argument(std::string(law.name) + "." + what);
  };
  std::size_t known = 0;
  for (const auto& c : law.constants) {
    if (!given.has(c.name)) {
      if (std::isnan(c.fallback)) fault(std::string(c.name) + ": is missing");
      given.set(c.name, c.fallback);
    }
    ++known;
    const double value = given[c.name];
    if (!std::isfinite(value) || (c.least >= 0 && value < 0)) fault(c.name + text(": found %g", value));
  }
  if (known != given.values().size()) fault("an unknown constant");
  for (const auto& c : law.constants)
    if (*c.above && !(given[c.name] > given[c.above]))
      fault(c.name + text(": found %g, %s must exceed %s", given[c.name], c.name, c.above));
  return given;
}

}  // namespace pockmark
