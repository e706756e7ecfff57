// A closed list of laws: which one a material uses is chosen at run time by its name, the call is direct.
#pragma once
#include <string_view>

#include "law.hpp"
#include "portable.hpp"

namespace pockmark {

template <class First, class... Rest>
class OneOf {
 public:
  // Takes the law of that name, made from its constants. Returns false where none has it.
  bool choose(std::string_view name, const Constants& constants) {
    is_first_ = name == First::declaration.name;
    if (is_first_) first_ = First(constants);
    if constexpr (sizeof...(Rest) > 0)
      return is_first_ || rest_.choose(name, constants);
    else
      return is_first_;
  }

  template <class F>
  PM_HD auto visit(F&& f) const {
    if constexpr (sizeof...(Rest) > 0)
      return is_first_ ? f(first_) : rest_.visit(f);
    else
      return f(first_);
  }

  // Calls f.template operator()<Law>() for each law of the list.
  template <class F>
  static void for_each(F&& f) {
    f.template operator()<First>();
    (f.template operator()<Rest>(), ...);
  }

 private:
  struct None {};
  template <class... Others>
  struct Tail {
    using type = OneOf<Others...>;
  };
  template <class... Others>
    requires(sizeof...(Others) == 0)
  struct Tail<Others...> {
    using type = None;
  };

  bool is_first_ = true;
  First first_{};
  [[no_unique_address]] typename Tail<Rest...>::type rest_{};
};

}  // namespace pockmark
