// Vectors and symmetric tensors of three dimensions.
#pragma once
#include "lanes.hpp"

namespace pockmark {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  PM_HD T& operator[](int axis) {
    if (axis == 0) return x;
    return axis == 1 ? y : z;
  }
  PM_HD T operator[](int axis) const {
    if (axis == 0) return x;
    return axis == 1 ? y : z;
  }
  PM_HD Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
};

template <class T>
PM_HD Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
PM_HD Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
PM_HD Vec3<T> operator*(T s, const Vec3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
PM_HD T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// What a node holds: a vector and a scalar (the mass, where there is one), padded to one SIMD register.
template <class T>
struct Quad {
  Four<T> v{};

  PM_HD Vec3<T> vector() const { return {v[0], v[1], v[2]}; }
  PM_HD void set_vector(const Vec3<T>& a) {
    v[0] = a.x;
    v[1] = a.y;
    v[2] = a.z;
  }
  PM_HD Quad& operator+=(const Quad& b) {
    v += b.v;
    return *this;
  }
};

// Adds f b to a: the one operation of every transfer.
template <class T>
PM_HD void add_scaled(Quad<T>& a, T f, const Quad<T>& b) {
  a.v += f * b.v;
}

// Components in the order xx, yy, zz, xy, yz, zx, everywhere.
template <class T>
struct Sym3 {
  T xx{}, yy{}, zz{}, xy{}, yz{}, zx{};
};

template <class T>
PM_HD Sym3<T> operator+(const Sym3<T>& a, const Sym3<T>& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
template <class T>
PM_HD Sym3<T> operator*(T f, const Sym3<T>& a) {
  return {f * a.xx, f * a.yy, f * a.zz, f * a.xy, f * a.yz, f * a.zx};
}
template <class T>
PM_HD T trace(const Sym3<T>& a) {
  return a.xx + a.yy + a.zz;
}
template <class T>
PM_HD Sym3<T> deviator(const Sym3<T>& a) {
  const T mean = T(1.0 / 3.0) * trace(a);
  return {a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.zx};
}
template <class T>
PM_HD T double_dot(const Sym3<T>& a, const Sym3<T>& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + T(2) * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}
// Return the von Mises effective stress of a deviator, sqrt(3/2 s:s), and its square.
template <class T>
PM_HD T effective_squared(const Sym3<T>& s) {
  return T(1.5) * double_dot(s, s);
}
template <class T>
PM_HD T effective(const Sym3<T>& s) {
  return root(effective_squared(s));
}

// What a velocity gradient does to a point in a time dt. What takes a division is found here, while the next
// point's gradient is on its way, and not where stresses would wait for it.
template <class T>
struct Strain {
  Sym3<T> small;      // D dt
  Vec3<T> half_turn;  // half of the axial vector w of the spin (W x = w cross x) times dt
  T growth;           // V1/V - 1: V1 = V (1 + a/2)/(1 - a/2), a = tr D dt, then (V + V1)/2 a = V1 - V exactly
  T turn;             // 2/(1 + |half_turn|^2), see rotate

  Strain() = default;
  PM_HD Strain(const Sym3<T>& small_, const Vec3<T>& half_turn_) : small(small_), half_turn(half_turn_) {
    const T opened = trace(small), shrunk = T(1) - T(0.5) * opened;
    const T turned = T(1) + dot(half_turn, half_turn);
    const T share = T(1) / (turned * shrunk);  // one division for two
    growth = opened * (share * turned);
    turn = T(2) * (share * shrunk);
  }
};

template <class M, class T>
PM_HD Sym3<T> select(M m, const Sym3<T>& a, const Sym3<T>& b) {
  return {select(m, a.xx, b.xx), select(m, a.yy, b.yy), select(m, a.zz, b.zz),
          select(m, a.xy, b.xy), select(m, a.yz, b.yz), select(m, a.zx, b.zx)};
}

// Returns R s R^T, R the Cayley (Hughes-Winget) rotation of the spin increment: exactly orthogonal, so a
// rigid rotation never changes the norm of the stress. `half` is half of the angle, `f` 2/(1 + half^2).
template <class T>
PM_HD Sym3<T> rotate(const Sym3<T>& s, const Vec3<T>& half, T f) {
  const T a = half.x, b = half.y, c = half.z, fa = f * a, fb = f * b, fc = f * c;
  const T aa = fa * a, bb = fb * b, cc = fc * c;
  const T r[3][3] = {{T(1) - (bb + cc), fa * b - fc, fa * c + fb},
                     {fa * b + fc, T(1) - (aa + cc), fb * c - fa},
                     {fa * c - fb, fb * c + fa, T(1) - (aa + bb)}};
  const T m[3][3] = {{s.xx, s.xy, s.zx}, {s.xy, s.yy, s.yz}, {s.zx, s.yz, s.zz}};
  T rm[2][3];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j) rm[i][j] = r[i][0] * m[0][j] + r[i][1] * m[1][j] + r[i][2] * m[2][j];
  const auto entry = [&](int i, int j) {
    return rm[i][0] * r[j][0] + rm[i][1] * r[j][1] + rm[i][2] * r[j][2];
  };
  const T xx = entry(0, 0), yy = entry(1, 1);  // zz follows from the trace, which stays
  return {xx, yy, trace(s) - xx - yy, entry(0, 1), entry(1, 2), entry(0, 2)};
}

}  // namespace pockmark
