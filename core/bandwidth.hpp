// The computer's copy bandwidth, measured now: the limit that a step's rate is compared with.
#pragma once
#include <algorithm>
#include <chrono>
#include <vector>

namespace pockmark {

// Returns the bytes read and written a second by the best of five copies of 64 MiB.
inline double copy_bandwidth(int threads) {
  const std::int64_t n = 8 << 20;
  std::vector<double> a(n, 1.0), b(n, 2.0);
  double best = 1e30;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::int64_t i = 0; i < n; ++i) b[i] = a[i] + double(repeat);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 2.0 * double(n) * sizeof(double) / best;
}

}  // namespace pockmark
