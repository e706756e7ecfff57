// Named timers: the profile is the list of the step's phases.
#pragma once
#include <chrono>
#include <map>
#include <string>

namespace pockmark {

class Timers {
 public:
  template <class F>
  void time(const char* phase, F&& f) {
    const auto start = std::chrono::steady_clock::now();
    f();
    seconds_[phase] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  std::map<std::string, double> seconds_;
};

}  // namespace pockmark
