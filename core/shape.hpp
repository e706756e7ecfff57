// Shape functions: which nodes a point touches, their weights and slopes. A point at xi, in cells from the
// first node of an axis, touches `support` nodes from floor(xi - offset) on; f is its distance from the first
// of them.
#pragma once

#include "tensor.hpp"

namespace pockmark {

// Trilinear finite-element functions, the paper's (its Eq. 5).
template <class T>
struct Linear {
  static constexpr int support = 2;
  static constexpr T offset = 0;
  template <class V>
  PM_HD static void weights(V f, V* w, V* slope) {
    w[0] = T(1) - f;
    w[1] = f;
    slope[0] = V(-1);
    slope[1] = V(1);
  }
};

// Quadratic B-splines (Steffen, Kirby and Berzins 2008): a continuous gradient at cell faces.
template <class T>
struct Quadratic {
  static constexpr int support = 3;
  static constexpr T offset = 0.5;
  template <class V>
  PM_HD static void weights(V f, V* w, V* slope) {
    const V a = T(1.5) - f, b = f - T(1), c = f - T(0.5);
    w[0] = T(0.5) * a * a;
    w[1] = T(0.75) - b * b;
    w[2] = T(0.5) * c * c;
    slope[0] = -a;
    slope[1] = T(-2) * b;
    slope[2] = c;
  }
};

// The weights along each axis at a point, or at a pack of points, at f from the first of their nodes. Slopes
// are per metre.
template <class Shape, class V>
struct Stencil {
  static constexpr int S = Shape::support;
  V w[3][S], g[3][S];

  PM_HD Stencil(const Vec3<V>& f, number_t<V> per_metre) {
    for (int a = 0; a < 3; ++a) {
      Shape::weights(f[a], w[a], g[a]);
      for (int i = 0; i < S; ++i) g[a][i] *= per_metre;
    }
  }
  PM_HD V weight(int i, int j, int k) const { return w[0][i] * w[1][j] * w[2][k]; }
};

}  // namespace pockmark
