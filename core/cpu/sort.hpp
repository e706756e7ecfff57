// Counting sort of the points by cell; every array of the field table follows.
#pragma once
#include <cstdint>
#include <vector>

#include "../points.hpp"

namespace pockmark::cpu {

// Sorts the points, and drops those that are gone.
template <class T>
class Sorter {
 public:
  void operator()(PointStore<T>& points, std::size_t node_count, int threads) {
    const std::size_t n = points.size();
    first_.assign(node_count + 1, 0);
    bool sorted = true;
    for (std::size_t p = 0; p < n; ++p) {
      if (points.cell[p] == gone)
        sorted = false;
      else
        ++first_[points.cell[p] + 1];
      if (p > 0 && points.cell[p] < points.cell[p - 1]) sorted = false;
    }
    if (sorted) return;
    for (std::size_t c = 0; c < node_count; ++c) first_[c + 1] += first_[c];
    const std::size_t kept = first_[node_count];
    from_.resize(kept);
    for (std::size_t p = 0; p < n; ++p)
      if (points.cell[p] != gone) from_[first_[points.cell[p]]++] = std::uint32_t(p);

    for (auto& component : points.components) reorder(component, scratch_, threads);
    reorder(points.body, byte_scratch_, threads);
    reorder(points.id, index_scratch_, threads);
    reorder(points.cell, index_scratch_, threads);
  }

 private:
  template <class V>
  void reorder(V& values, V& scratch, int threads) {
    const std::int64_t kept = std::int64_t(from_.size());
    scratch.resize(from_.size());
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::int64_t p = 0; p < kept; ++p) scratch[p] = values[from_[p]];
    values.swap(scratch);
  }

  std::vector<std::uint32_t> first_, from_;
  Array<T> scratch_;
  std::vector<std::uint8_t> byte_scratch_;
  std::vector<std::uint32_t> index_scratch_;
};

}  // namespace pockmark::cpu
