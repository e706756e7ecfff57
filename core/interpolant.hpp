// A nodal field between the nodes of a stencil.
#pragma once
#include "block.hpp"
#include "grid.hpp"
#include "shape.hpp"

namespace pockmark {

// The values of a nodal array under a stencil: S^3 nodes.
template <class Shape, class T>
struct Patch {
  static constexpr int S = Shape::support;
  Quad<T> at[S][S][S]{};

  template <class F>
  PM_HD static void for_each(F&& f) {
    for (int i = 0; i < S; ++i)
      for (int j = 0; j < S; ++j)
        for (int k = 0; k < S; ++k) f(i, j, k);
  }
  template <Nodal quantity>
  PM_HD void load(const GridGeometry<T>& grid, const Bundle& bundle, NodeField<T, quantity> nodes) {
    const Quad<T>* first = nodes.data + bundle.node;
    for_each([&](int i, int j, int k) { at[i][j][k] = first[grid.index(i, j, k)]; });
  }
  PM_HD void scale(T factor) {
    for_each([&](int i, int j, int k) { at[i][j][k].v = factor * at[i][j][k].v; });
  }
  PM_HD void subtract(const Patch& other) {
    for_each([&](int i, int j, int k) { at[i][j][k].v -= other.at[i][j][k].v; });
  }
  template <Nodal quantity>
  PM_HD void add_to(const GridGeometry<T>& grid, const Bundle& bundle, NodeField<T, quantity> nodes) const {
    Quad<T>* first = nodes.data + bundle.node;
    for_each([&](int i, int j, int k) { first[grid.index(i, j, k)] += at[i][j][k]; });
  }
};

// A nodal vector quantity as a function of the place within one stencil. Its patch must outlive it, and is
// scaled with it.
template <class Shape, class T>
class Interpolant {
 public:
  PM_HD explicit Interpolant(Patch<Shape, T>& patch) : nodes_(patch) {}
  PM_HD void scale(T factor) { nodes_.scale(factor); }

  template <class V>
  PM_HD Vec3<V> value(const Vec3<V>& f) const {
    const Stencil<Shape, V> n(f, T(1));
    Vec3<V> sum{V(0), V(0), V(0)};
    nodes_.for_each([&](int i, int j, int k) {
      const V w = n.weight(i, j, k);
      for (int c = 0; c < 3; ++c) sum[c] += w * nodes_.at[i][j][k].v[c];
    });
    return sum;
  }
  // Finds derivative[c][a] = d v_c / d f_a (Eq. 13), summed axis by axis.
  template <class V>
  PM_HD void slopes(const Vec3<V>& f, V (&derivative)[3][3]) const {
    constexpr int S = Shape::support;
    const Stencil<Shape, V> n(f, T(1));
    for (int c = 0; c < 3; ++c) {
      V dx = V(0), dy = V(0), dz = V(0);
      for (int i = 0; i < S; ++i) {
        V plane = V(0), plane_y = V(0), plane_z = V(0);
        for (int j = 0; j < S; ++j) {
          V line = V(0), line_z = V(0);
          for (int k = 0; k < S; ++k) {
            line += n.w[2][k] * nodes_.at[i][j][k].v[c];
            line_z += n.g[2][k] * nodes_.at[i][j][k].v[c];
          }
          plane += n.w[1][j] * line;
          plane_y += n.g[1][j] * line;
          plane_z += n.w[1][j] * line_z;
        }
        dx += n.g[0][i] * plane;
        dy += n.w[0][i] * plane_y;
        dz += n.w[0][i] * plane_z;
      }
      derivative[c][0] = dx;
      derivative[c][1] = dy;
      derivative[c][2] = dz;
    }
  }

 private:
  Patch<Shape, T>& nodes_;
};

// Trilinear: the polynomial 1, x, y, z, xy, yz, zx, xyz in the cell's own coordinates, 0 to 1.
template <class T>
class Interpolant<Linear<T>, T> {
 public:
  PM_HD explicit Interpolant(const Patch<Linear<T>, T>& patch) {
    const auto& n = patch.at;
    const auto x0 = n[1][0][0].v - n[0][0][0].v, x1 = n[1][1][0].v - n[0][1][0].v;
    const auto x2 = n[1][0][1].v - n[0][0][1].v, x3 = n[1][1][1].v - n[0][1][1].v;
    const auto y0 = n[0][1][0].v - n[0][0][0].v, y2 = n[0][1][1].v - n[0][0][1].v;
    const auto z0 = n[0][0][1].v - n[0][0][0].v;
    one_.v = n[0][0][0].v;
    x_.v = x0;
    y_.v = y0;
    z_.v = z0;
    xy_.v = x1 - x0;
    yz_.v = y2 - y0;
    zx_.v = x2 - x0;
    xyz_.v = (x3 - x2) - (x1 - x0);
  }
  // Scales the differences of the nodes: where these move alike they are 0, and stay so.
  PM_HD void scale(T factor) {
    for (auto* part : {&one_, &x_, &y_, &z_, &xy_, &yz_, &zx_, &xyz_}) part->v = factor * part->v;
  }

  template <class V>
  PM_HD Vec3<V> value(const Vec3<V>& f) const {
    const auto& [one, x, y, z, xy, yz, zx, xyz] = anew<V>(*this);
    Vec3<V> out;
    for (int c = 0; c < 3; ++c)
      out[c] = (one.v[c] + f.z * z.v[c]) + f.y * (y.v[c] + f.z * yz.v[c]) +
               f.x * ((x.v[c] + f.z * zx.v[c]) + f.y * (xy.v[c] + f.z * xyz.v[c]));
    return out;
  }
  template <class V>
  PM_HD void slopes(const Vec3<V>& f, V (&derivative)[3][3]) const {
    const auto& [one, x, y, z, xy, yz, zx, xyz] = anew<V>(*this);
    for (int c = 0; c < 3; ++c) {
      const V across = yz.v[c] + f.x * xyz.v[c];
      derivative[c][0] = (x.v[c] + f.z * zx.v[c]) + f.y * (xy.v[c] + f.z * xyz.v[c]);
      derivative[c][1] = (y.v[c] + f.x * xy.v[c]) + f.z * across;
      derivative[c][2] = (z.v[c] + f.x * zx.v[c]) + f.y * across;
    }
  }

 private:
  Quad<T> one_, x_, y_, z_, xy_, yz_, zx_, xyz_;
};

}  // namespace pockmark
