// Host and device: the only file that knows which compiler it is.
#pragma once
#include <type_traits>

// The laws are called once a point a step: always inlined, so that a point's state stays in registers.
#ifdef __CUDACC__
#define PM_HD __host__ __device__ __forceinline__
#define PM_INLINE
#define PM_NOINLINE __noinline__
#else
#define PM_HD inline __attribute__((always_inline))
#define PM_INLINE __attribute__((always_inline))  // for the body of a loop that is written as a lambda
#define PM_NOINLINE __attribute__((noinline))     // for what few points need
#endif

namespace pockmark {

// Returns what there is, as if it were new: in a loop over packs V its numbers then come from memory in each
// turn, where they fill all lanes at no cost. A compiler would fill registers with them ahead of the loop,
// more than there are, for a loop of one or two turns. A loop over the points one by one has more turns.
template <class V, class T>
PM_HD const T& anew(const T& what) {
#ifndef __CUDACC__
  if constexpr (!std::is_arithmetic_v<V>) {
    const T* at = &what;
    asm volatile("" : "+r"(at) : "m"(what));
    return *at;
  }
#endif
  return what;
}

// Four numbers that are added and scaled as one.
#ifdef __CUDACC__
template <class T>
struct Four {
  T n[4];
  PM_HD T& operator[](int i) { return n[i]; }
  PM_HD T operator[](int i) const { return n[i]; }
  PM_HD Four& operator+=(const Four& b) {
    for (int i = 0; i < 4; ++i) n[i] += b.n[i];
    return *this;
  }
  PM_HD friend Four operator+(Four a, const Four& b) { return a += b; }
  PM_HD friend Four operator-(Four a, const Four& b) {
    for (int i = 0; i < 4; ++i) a.n[i] -= b.n[i];
    return a;
  }
  PM_HD friend Four operator*(T f, Four a) {
    for (int i = 0; i < 4; ++i) a.n[i] *= f;
    return a;
  }
  PM_HD friend Four operator*(Four a, const Four& b) {
    for (int i = 0; i < 4; ++i) a.n[i] *= b.n[i];
    return a;
  }
};
#else
template <class T>
struct FourOf {
  typedef T type __attribute__((vector_size(4 * sizeof(T))));
};
template <class T>
using Four = typename FourOf<T>::type;
#endif

}  // namespace pockmark
