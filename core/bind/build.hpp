// What this build is, and what this processor can do.
#pragma once
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "../bandwidth.hpp"
#include "../lanes.hpp"
#include "arrays.hpp"

namespace pockmark::bind {

inline nb::typed<nb::dict, std::string, nb::any> build_info() {
  nb::dict d;
  d["compiler"] = __VERSION__;
  d["flags"] = POCKMARK_FLAGS;
  d["isa"] = POCKMARK_ISA;
  d["lanes"] = has_lanes;
#ifdef _OPENMP
  d["openmp"] = true;
#else
  d["openmp"] = false;
#endif
  return d;
}

// Return whether the processor has these levels of x86-64. Clang before 18 knows their parts by name, not the
// levels.
#ifdef __x86_64__
#if defined(__clang__) && __clang_major__ < 18
inline bool has_x86_64_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
inline bool has_x86_64_v4() {
  return has_x86_64_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
#else
inline bool has_x86_64_v3() { return __builtin_cpu_supports("x86-64-v3"); }
inline bool has_x86_64_v4() { return __builtin_cpu_supports("x86-64-v4"); }
#endif
#endif

inline std::vector<std::string> supported_isas() {
  std::vector<std::string> isas;
#ifdef __x86_64__
  if (has_x86_64_v4()) isas.push_back("avx512");
  if (has_x86_64_v3()) isas.push_back("avx2");
#endif
  isas.push_back("scalar");
  return isas;
}

inline void bind_build(nb::module_& m) {
  m.def("build_info", &build_info,
        "Return the compiler, its flags, the instruction set, and what they allow.");
  m.def("supported_isas", &supported_isas,
        "Return the instruction sets that pockmark is built for and this processor has, the best first.");
  m.def("copy_bandwidth", &copy_bandwidth, "threads"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Return the bytes read and written a second by copies of long arrays.");
}

}  // namespace pockmark::bind
