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

// A pass reads twenty arrays side by side: in small pages each is another entry in the translation buffers,
// and starting at the same place of a page they would compete for the same few lines of the cache. So large
// arrays begin in a huge page, each a little farther into it than the last.
template <class T>
struct ArrayAllocator {
  using value_type = T;
  static constexpr std::size_t line = 64, page = 4096, huge = 2 << 20;

  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) {}

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    if (!is_large(n)) return static_cast<T*>(::operator new(bytes, std::align_val_t{line}));
    char* at = static_cast<char*>(::operator new(bytes + page, std::align_val_t{huge}));
#ifdef __linux__
    madvise(at, (bytes + page) / huge * huge, MADV_HUGEPAGE);  // a wish: what comes of it does not matter
#endif
    static std::atomic<std::size_t> arrays{0};
    return reinterpret_cast<T*>(at + arrays++ * 5 * line % page);
  }
  void deallocate(T* at, std::size_t n) {
    if (!is_large(n)) return ::operator delete(at, std::align_val_t{line});
    const auto address = reinterpret_cast<std::uintptr_t>(at);
    ::operator delete(reinterpret_cast<void*>(address - address % huge), std::align_val_t{huge});
  }
  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) { return true; }

 private:
  static bool is_large(std::size_t n) { return n * sizeof(T) >= 2 * huge; }
};
template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

}  // namespace pockmark
