// A pack of W numbers in a register of the processor (GCC, Clang).
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "pack.hpp"
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace pockmark {

#if defined(__AVX2__) && !defined(__CUDACC__)
#define POCKMARK_LANES 1
#ifdef __AVX512F__
inline constexpr int lane_bytes = 64;
#else
inline constexpr int lane_bytes = 32;
#endif

template <class T>
struct LaneMask;
template <class T, int bytes>
struct LaneVector {
  typedef T type __attribute__((vector_size(bytes)));
  typedef T in_memory __attribute__((vector_size(bytes), aligned(alignof(T))));
};

// Only packs of the full width have masks: a comparison of narrower ones does not compile.
template <class T, int bytes = lane_bytes>
struct Lanes {
  static constexpr int width = bytes / int(sizeof(T));
  using Raw = typename LaneVector<T, bytes>::type;
  Raw v;

  Lanes() = default;
  PM_HD Lanes(T s) : v(s - Raw{}) {}
  PM_HD explicit Lanes(Raw raw) : v(raw) {}
  PM_HD friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  PM_HD friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  PM_HD friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  PM_HD friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  PM_HD friend Lanes operator-(Lanes a) { return Lanes(-a.v); }
  PM_HD Lanes& operator+=(Lanes b) {
    v += b.v;
    return *this;
  }
  PM_HD Lanes& operator-=(Lanes b) {
    v -= b.v;
    return *this;
  }
  PM_HD Lanes& operator*=(Lanes b) {
    v *= b.v;
    return *this;
  }
  PM_HD friend LaneMask<T> operator<(Lanes a, Lanes b) { return LaneMask<T>::less(a, b); }
  PM_HD friend LaneMask<T> operator<=(Lanes a, Lanes b) { return LaneMask<T>::less_equal(a, b); }
  PM_HD friend LaneMask<T> operator>(Lanes a, Lanes b) { return b < a; }
  PM_HD friend LaneMask<T> operator>=(Lanes a, Lanes b) { return b <= a; }
};

#ifdef __AVX512F__

PM_HD __mmask8 compare_less(__m512d a, __m512d b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
PM_HD __mmask16 compare_less(__m512 a, __m512 b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
PM_HD __mmask8 compare_less_equal(__m512d a, __m512d b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
PM_HD __mmask16 compare_less_equal(__m512 a, __m512 b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
PM_HD __m512d blend(unsigned m, __m512d yes, __m512d no) {
  return _mm512_mask_blend_pd(__mmask8(m), no, yes);
}
PM_HD __m512 blend(unsigned m, __m512 yes, __m512 no) { return _mm512_mask_blend_ps(__mmask16(m), no, yes); }
PM_HD __m512d vector_root(__m512d x) { return _mm512_maskz_sqrt_pd(0xff, x); }
PM_HD __m512 vector_root(__m512 x) { return _mm512_maskz_sqrt_ps(0xffff, x); }
// The last argument says by its type how wide a pack is.
PM_HD __m512d masked_load(unsigned m, const double* at, __m512d) {
  return _mm512_maskz_loadu_pd(__mmask8(m), at);
}
PM_HD __m512 masked_load(unsigned m, const float* at, __m512) {
  return _mm512_maskz_loadu_ps(__mmask16(m), at);
}
PM_HD __m256 masked_load(unsigned m, const float* at, __m256) {
  return _mm256_maskz_loadu_ps(__mmask8(m), at);
}
PM_HD void masked_store(unsigned m, double* at, __m512d v) { _mm512_mask_storeu_pd(at, __mmask8(m), v); }
PM_HD void masked_store(unsigned m, float* at, __m512 v) { _mm512_mask_storeu_ps(at, __mmask16(m), v); }
PM_HD void masked_store(unsigned m, float* at, __m256 v) { _mm256_mask_storeu_ps(at, __mmask8(m), v); }

template <class T>
struct LaneMask {
  static constexpr unsigned full = (1u << Lanes<T>::width) - 1;
  unsigned m;  // a bit a lane

  PM_HD static LaneMask of(bool b) { return {b ? full : 0u}; }
  PM_HD static LaneMask first(int n) { return {(1u << n) - 1}; }
  PM_HD static LaneMask less(Lanes<T> a, Lanes<T> b) { return {compare_less(a.v, b.v)}; }
  PM_HD static LaneMask less_equal(Lanes<T> a, Lanes<T> b) { return {compare_less_equal(a.v, b.v)}; }
  PM_HD friend LaneMask operator&&(LaneMask a, LaneMask b) { return {a.m & b.m}; }
  PM_HD friend LaneMask operator||(LaneMask a, LaneMask b) { return {a.m | b.m}; }
  PM_HD friend LaneMask operator!(LaneMask a) { return {~a.m & full}; }
  PM_HD unsigned bits() const { return m; }
  PM_HD Lanes<T> choose(Lanes<T> yes, Lanes<T> no) const { return Lanes<T>(blend(m, yes.v, no.v)); }
};

#else  // AVX2

PM_HD __m256d vector_root(__m256d x) { return _mm256_sqrt_pd(x); }
PM_HD __m256 vector_root(__m256 x) { return _mm256_sqrt_ps(x); }
PM_HD unsigned lane_bits(__m256d m) { return unsigned(_mm256_movemask_pd(m)); }
PM_HD unsigned lane_bits(__m256 m) { return unsigned(_mm256_movemask_ps(m)); }
PM_HD __m256d masked_load(__m256i m, const double* at, __m256d) { return _mm256_maskload_pd(at, m); }
PM_HD __m256 masked_load(__m256i m, const float* at, __m256) { return _mm256_maskload_ps(at, m); }
PM_HD void masked_store(__m256i m, double* at, __m256d v) { _mm256_maskstore_pd(at, m, v); }
PM_HD void masked_store(__m256i m, float* at, __m256 v) { _mm256_maskstore_ps(at, m, v); }

// All bits set in the first half: read from the middle minus n for a mask of the first n lanes.
inline constexpr std::int32_t lane_mask_table[16]{-1, -1, -1, -1, -1, -1, -1, -1};

template <class T>
struct LaneMask {
  using Raw = typename Lanes<T>::Raw;
  using Int = decltype(Raw{} < Raw{});
  Int m;  // all bits of a lane set or none

  PM_HD static LaneMask of(bool b) { return {b ? ~Int{} : Int{}}; }
  PM_HD static LaneMask first(int n) {
    LaneMask out;
    std::memcpy(&out.m, lane_mask_table + 8 - n * int(sizeof(T) / 4), sizeof(Int));
    return out;
  }
  PM_HD static LaneMask less(Lanes<T> a, Lanes<T> b) { return {a.v < b.v}; }
  PM_HD static LaneMask less_equal(Lanes<T> a, Lanes<T> b) { return {a.v <= b.v}; }
  PM_HD friend LaneMask operator&&(LaneMask a, LaneMask b) { return {a.m & b.m}; }
  PM_HD friend LaneMask operator||(LaneMask a, LaneMask b) { return {a.m | b.m}; }
  PM_HD friend LaneMask operator!(LaneMask a) { return {~a.m}; }
  PM_HD unsigned bits() const { return lane_bits(std::bit_cast<Raw>(m)); }
  PM_HD Lanes<T> choose(Lanes<T> yes, Lanes<T> no) const { return Lanes<T>(m ? yes.v : no.v); }
};

#endif

template <class T>
PM_HD Lanes<T> select(LaneMask<T> m, const Lanes<T>& yes, const Lanes<T>& no) {
  return m.choose(yes, no);
}
template <class T>
PM_HD bool any(LaneMask<T> m) {
  return m.bits() != 0;
}
template <class T>
PM_HD int count(LaneMask<T> m) {
  return std::popcount(m.bits());
}
template <class T>
PM_HD unsigned bits_of(LaneMask<T> m) {
  return m.bits();
}
// Also of narrower packs, which have no masks.
template <class T, int bytes>
PM_HD Lanes<T, bytes> positive_part(Lanes<T, bytes> a) {
  const typename Lanes<T, bytes>::Raw zero{};
  return Lanes<T, bytes>(a.v > zero ? a.v : zero);
}
template <class T>
PM_HD Lanes<T> root(Lanes<T> x) {
  return Lanes<T>(typename Lanes<T>::Raw(vector_root(x.v)));
}
template <class T>
PM_HD typename Lanes<T>::Raw raw(Lanes<T> x) {
  return x.v;
}

template <class T, int bytes>
struct Pack<Lanes<T, bytes>> {
  using V = Lanes<T, bytes>;
  using Number = T;
  using Mask = LaneMask<T>;
  using UInt = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  using Bits = typename LaneVector<UInt, bytes>::type;
  using InMemory = typename LaneVector<T, bytes>::in_memory;  // aliases plain numbers, as GCC's vectors do
  static constexpr int width = V::width;
  PM_HD static Mask mask(bool b) { return Mask::of(b); }
  PM_HD static Mask first(int n) { return Mask::first(n); }
  PM_HD static V load(const T* at) { return V(typename V::Raw(*reinterpret_cast<const InMemory*>(at))); }
  PM_HD static V load(const T* at, int n) {
    return n == width ? load(at) : V(typename V::Raw(masked_load(lanes(n), at, typename V::Raw{})));
  }
  PM_HD static void store(T* at, V v) { *reinterpret_cast<InMemory*>(at) = v.v; }
  PM_HD static void store(T* at, V v, int n) {
    if (n == width)
      store(at, v);
    else
      masked_store(lanes(n), at, v.v);
  }

 private:
#ifdef __AVX512F__
  PM_HD static unsigned lanes(int n) { return Mask::first(n).m; }
#else
  PM_HD static __m256i lanes(int n) { return std::bit_cast<__m256i>(Mask::first(n).m); }
#endif
};

// A pack for the points of a bundle. A bundle seldom has more than eight points, which fill half of the
// widest pack of floats.
template <>
struct BundlePack<Lanes<float>> {
  using type = Lanes<float, 32>;
};

// The pack that the CPU's driver computes with.
inline constexpr bool has_lanes = true;
template <class T>
using WidestPack = Lanes<T>;

#else

inline constexpr bool has_lanes = false;
template <class T>
using WidestPack = T;

#endif

}  // namespace pockmark
