// The slopes of a vector in space, which levers.hpp adds up over cells.
#pragma once
#include "boundary.hpp"

namespace pockmark {

// The slopes of a vector along x, y and z, at a node or of a cell: a quad each, so that no number changes its
// lane.
template <class T>
struct Slopes {
  Quad<T> along[3];

  PM_HD Slopes& operator+=(const Slopes& b) {
    for (int a = 0; a < 3; ++a) along[a] += b.along[a];
    return *this;
  }
  PM_HD friend Slopes operator+(const Slopes& a, const Slopes& b) {
    Slopes sum = a;
    return sum += b;
  }
  PM_HD friend Slopes operator*(const Quad<T>& f, const Slopes& a) {
    Slopes product;
    for (int i = 0; i < 3; ++i) product.along[i].v = f.v * a.along[i].v;
    return product;
  }
};

// Returns what a mirror does to slopes; fourth numbers stay. `face` is the mirror, across `face_axis`.
template <class T>
Slopes<T> mirrored(Face face, int face_axis, const Slopes<T>& slopes) {
  Slopes<T> out;
  for (int a = 0; a < 3; ++a) {
    const auto sign = [&](int component) {
      return T(mirror_sign(face, face_axis, component) * (a == face_axis ? -1 : 1));
    };
    out.along[a].v = Four<T>{sign(0), sign(1), sign(2), T(1)} * slopes.along[a].v;
  }
  return out;
}

// A matrix.
template <class T>
struct Three {
  T at[3][3];

  PM_HD T cofactor(int r, int a) const {
    const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, a1 = (a + 1) % 3, a2 = (a + 2) % 3;
    return at[r1][a1] * at[r2][a2] - at[r1][a2] * at[r2][a1];
  }
  PM_HD T determinant() const {
    return at[0][0] * cofactor(0, 0) + at[0][1] * cofactor(0, 1) + at[0][2] * cofactor(0, 2);
  }
  // Returns the solution x of A x = b.
  PM_HD Vec3<T> solve(const Vec3<T>& b) const {
    Vec3<T> x{};
    const T per_determinant = T(1) / determinant();
    for (int r = 0; r < 3; ++r)
      for (int a = 0; a < 3; ++a) x[a] += per_determinant * cofactor(r, a) * b[r];
    return x;
  }
};

}  // namespace pockmark
