// Shape functions: which nodes a point touches, their weights and slopes.
#pragma once
#include <cmath>

#include "tensor.hpp"

namespace pockmark {

// Trilinear finite-element functions, the paper's (its Eq. 5).
template <class T>
struct Linear {
  static constexpr int support = 2;
  PM_HD static int base(T xi) { return int(std::floor(xi)); }
  template <class V>
  PM_HD static void weights(V xi, int base, V* w, V* slope) {
    const V f = xi - T(base);
    w[0] = T(1) - f, w[1] = f;
    slope[0] = V(-1), slope[1] = V(1);
  }
};

// Quadratic B-splines (Steffen, Kirby and Berzins 2008): a continuous gradient at cell faces.
template <class T>
struct Quadratic {
  static constexpr int support = 3;
  PM_HD static int base(T xi) { return int(std::floor(xi - T(0.5))); }
  template <class V>
  PM_HD static void weights(V xi, int base, V* w, V* slope) {
    const V f = xi - T(base);
    const V a = T(1.5) - f, b = f - T(1), c = f - T(0.5);
    w[0] = T(0.5) * a * a, w[1] = T(0.75) - b * b, w[2] = T(0.5) * c * c;
    slope[0] = -a, slope[1] = T(-2) * b, slope[2] = c;
  }
};

// The weights along each axis at a point, or at a pack of points with the same nodes. Slopes are per metre.
template <class Shape, class V>
struct Stencil {
  static constexpr int S = Shape::support;
  V w[3][S], g[3][S];

  template <class Geometry>
  PM_HD Stencil(const Geometry& grid, const Vec3<V>& x, const int (&base)[3]) {
    for (int a = 0; a < 3; ++a) {
      Shape::weights(grid.local(x[a], a), base[a], w[a], g[a]);
      for (int i = 0; i < S; ++i) g[a][i] *= grid.per_metre;
    }
  }
  PM_HD V weight(int i, int j, int k) const { return w[0][i] * w[1][j] * w[2][k]; }
};

}  // namespace pockmark
