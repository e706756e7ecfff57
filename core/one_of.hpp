// A closed list of models: which one a material uses is chosen at run time, the call is direct.
#pragma once
#include "portable.hpp"

namespace pockmark {

template <class First, class... Rest>
class OneOf {
 public:
  OneOf() = default;
  OneOf(const First& model) : first_(model) {}
  template <class Model>
  OneOf(const Model& model) : is_first_(false), rest_(model) {}

  template <class F>
  PM_HD auto visit(F&& f) const {
    return is_first_ ? f(first_) : rest_.visit(f);
  }

 private:
  bool is_first_ = true;
  First first_{};
  OneOf<Rest...> rest_{};
};

template <class First>
class OneOf<First> {
 public:
  OneOf() = default;
  OneOf(const First& model) : first_(model) {}
  template <class F>
  PM_HD auto visit(F&& f) const {
    return f(first_);
  }

 private:
  First first_{};
};

}  // namespace pockmark
