// The arrays of points and nodes: on cache lines of their own, in huge pages where the system has them.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pockmark {

// Gives each array a start of its own within a page. A pass reads twenty arrays side by side: if all began at
// the same place of a page, as the system hands them out, they would compete for the same few lines of the
// cache. Each array in small pages also takes an entry of its own in the processor's translation buffer, so
// long arrays begin in a huge page.
template <class T>
struct ArrayAllocator {
  using value_type = T;
  static constexpr std::size_t line = 64, page = 4096, huge = 2 << 20;

  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) {}

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    if (bytes < staggered) return static_cast<T*>(::operator new(bytes, std::align_val_t{line}));
    const std::size_t start = boundary(bytes);
    char* at = static_cast<char*>(::operator new(bytes + page, std::align_val_t{start}));
#ifdef __linux__
    // The system may refuse: no result depends on it.
    if (start == huge) madvise(at, (bytes + page) / huge * huge, MADV_HUGEPAGE);
#endif
    static std::atomic<std::size_t> arrays{0};
    return reinterpret_cast<T*>(at + arrays++ * 5 * line % page);
  }
  void deallocate(T* at, std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    if (bytes < staggered) return ::operator delete(at, std::align_val_t{line});
    const auto address = reinterpret_cast<std::uintptr_t>(at);
    ::operator delete(reinterpret_cast<void*>(address - address % page), std::align_val_t{boundary(bytes)});
  }
  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) { return true; }

 private:
  static constexpr std::size_t staggered = 16 * page;
  static std::size_t boundary(std::size_t bytes) { return bytes < huge ? page : huge; }
};
template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

}  // namespace pockmark
