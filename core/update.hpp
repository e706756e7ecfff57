// What the points of a block take from the grid: stress, velocity, position. V is a number or a pack.
#pragma once
#include "constitutive.hpp"
#include "transfer.hpp"

namespace pockmark {

// The body of each point of a pack, as numbers to compare.
template <class V, class T>
PM_HD mask_t<V> of_body(const Particles<T>& points, std::size_t p, int n, std::uint8_t body) {
  if constexpr (Pack<V>::width == 1) {
    return points.body[p] == body;
  } else {
    T is[Pack<V>::width]{};
    for (int i = 0; i < n; ++i) is[i] = points.body[p + i] == body ? T(1) : T(0);
    return V(0) < Pack<V>::load(is);
  }
}

// f(body, mask of its points) for each body of a pack: nearly always one.
template <class V, class T, class F>
PM_HD void for_each_body(const Particles<T>& points, std::size_t p, int n, F&& f) {
  const std::uint8_t first = points.body[p];
  bool one = true;
  for (int i = 1; i < n; ++i) one = one && points.body[p + i] == first;
  if (one) return f(first, Pack<V>::mask(true), true);
  for (int i = 0; i < n; ++i) {
    const std::uint8_t body = points.body[p + i];
    bool seen = false;
    for (int k = 0; k < i; ++k) seen = seen || points.body[p + k] == body;
    if (!seen) f(body, of_body<V>(points, p, n, body), false);
  }
}

template <class T>
struct StressStep {
  T dt;                    // duration of the strain
  T step;                  // of the whole step
  T old_share, new_share;  // see StressUpdate
};

// Strain increment, stress, damage, heat (3).
template <class Shape, class V, class T = number_t<V>>
void update_stress(Particles<T>& points, const GridGeometry<T>& grid,
                   const std::vector<Material<T>>& materials, const Block& block,
                   const std::vector<Quad<T>>& velocity, const StressStep<T>& step, Audit& audit) {
  Gradients<T> gradients;
  gradients.template gather<Shape, V>(points, grid, block, velocity);
  Tally<V> tally;
  for_each_pack<V>(block, [&](std::size_t p, int n) {
    const auto L = gradients.template at<V>(p - block.begin);
    const V mass = points.template load<V>(Field::mass, p, n);
    const auto v = points.template vector<V>(Field::velocity, p, n);
    const V speed = root(dot(v, v));
    auto point = points.template state<V>(p, n);
    for_each_body<V>(points, p, n, [&](std::uint8_t body, mask_t<V> mine, bool all) {
      const auto active = mine && first_lanes<V>(n);
      const StressUpdate<V> update{materials[body], grid.cell,      step.dt,
                                   step.step,       step.old_share, step.new_share};
      auto updated = point;
      const V c = update(updated, L, mass, active, tally);
      point = all ? updated : select(mine, updated, point);
      tally.wave_speed = select(active, max(tally.wave_speed, c + speed), tally.wave_speed);
    });
    points.store(p, point, n);
  });
  audit.absorb(tally);
}

// FLIP with a share of PIC: v += sum N (v_after - v_before) (6). Returns the kinetic energy that PIC took
// (J).
template <class Shape, class V, class T = number_t<V>>
double update_velocities(Particles<T>& points, const Grid<T>& grid, const Block& block, T pic) {
  Values<T> change, after;
  change.template gather<Shape, V>(points, grid.geometry, block, grid.after, &grid.before);
  if (pic > T(0)) after.template gather<Shape, V>(points, grid.geometry, block, grid.after);
  V taken = V(0);
  for_each_pack<V>(block, [&](std::size_t p, int n) {
    const auto flip =
        points.template vector<V>(Field::velocity, p, n) + change.template at<V>(p - block.begin);
    if (!(pic > T(0))) return points.set_vector(Field::velocity, p, flip, n);
    const auto v = V(T(1) - pic) * flip + V(pic) * after.template at<V>(p - block.begin);
    const V lost = T(0.5) * points.template load<V>(Field::mass, p, n) * (dot(flip, flip) - dot(v, v));
    taken += select(first_lanes<V>(n), lost, V(0));
    points.set_vector(Field::velocity, p, v, n);
  });
  return sum_of(taken);
}

// x += dt sum N v_after (6). With a velocity mapped back (USAVG), the second half of the strain goes first.
template <class Shape, class V, class T = number_t<V>>
void move(Particles<T>& points, const Grid<T>& grid, const std::vector<Material<T>>& materials,
          const Block& block, const std::vector<Quad<T>>* remapped, T dt) {
  Values<T> velocity;
  velocity.template gather<Shape, V>(points, grid.geometry, block, grid.after);
  Gradients<T> gradients;
  if (remapped) gradients.template gather<Shape, V>(points, grid.geometry, block, *remapped);
  for_each_pack<V>(block, [&](std::size_t p, int n) {
    if (remapped) {
      const auto L = gradients.template at<V>(p - block.begin);
      const V mass = points.template load<V>(Field::mass, p, n);
      auto point = points.template state<V>(p, n);
      for_each_body<V>(points, p, n, [&](std::uint8_t body, mask_t<V> mine, bool all) {
        auto strained = point;
        strain_elastically(materials[body], strained, L, mass, T(0.5) * dt);
        point = all ? strained : select(mine, strained, point);
      });
      points.store_strained(p, point, n);
    }
    const auto x = points.template vector<V>(Field::position, p, n);
    points.set_vector(Field::position, p, x + V(dt) * velocity.template at<V>(p - block.begin), n);
  });
}

}  // namespace pockmark
