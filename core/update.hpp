// What the points of a block take from the grid: stress, velocity, position. V is a number or a pack.
#pragma once
#include "constitutive.hpp"
#include "transfer.hpp"

namespace pockmark {

// f(range of points, material) over the points of a block, in order: one range, unless bodies meet in the
// block.
template <class T, class F>
PM_HD void for_each_material(const Particles<T>& points, const std::vector<Material<T>>& materials,
                             const Block& block, F&& f) {
  struct Range {
    std::size_t begin, end;
  };
  for (std::size_t begin = block.begin; begin < block.end;) {
    std::size_t end = block.one_body ? block.end : begin + 1;
    while (end < block.end && points.body[end] == points.body[begin]) ++end;
    f(Range{begin, end}, materials[points.body[begin]]);
    begin = end;
  }
}

template <class T>
struct StressStep {
  T dt;                    // duration of the strain
  T step;                  // of the whole step
  T old_share, new_share;  // see StressUpdate
};

// Some of a block's packs.
struct PackList {
  struct Entry {
    std::size_t p;
    int n;
  };
  Entry entries[Block::most];
  int count = 0;

  void add(std::size_t p, int n) { entries[count++] = {p, n}; }
  template <class F>
  PM_HD void for_each(F&& f) const {
    for (int i = 0; i < count; ++i) f(entries[i].p, entries[i].n);
  }
};

// Stress, damage, heat (3) from the velocity gradient at the points, and what they then push their nodes
// with.
template <class V, class T = number_t<V>>
void update_stress(Particles<T>& points, const std::vector<Material<T>>& materials, T cell,
                   const Block& block, const Columns<T, 9>& gradient, const StressStep<T>& step, Audit& audit,
                   Columns<T, 6>& push) {
  Columns<T, 1> plastic;
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    const StressUpdate<V> update{material, cell, step.dt, step.step, step.old_share, step.new_share};
    auto tally = audit.tally<V>();
    PackList may_yield, yield;
    const auto reference_volume = [&](std::size_t p, int n) PM_INLINE {
      return points.template load<V>(Field::mass, p, n) * material.specific_volume;
    };
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      points.prefetch(p + Block::most);
      auto point = points.template state<V>(p, n);
      const auto L = velocity_gradient<V>(gradient, p - block.begin);
      const bool yields = any(update.strain(point, L, first_lanes<V>(n), tally));
      points.store_strained(p, point, n);
      if (yields) may_yield.add(p, n);
    });
    may_yield.for_each([&](std::size_t p, int n) PM_INLINE {
      auto point = points.template state<V>(p, n);
      const V increment = update.return_to_yield(point, reference_volume(p, n), first_lanes<V>(n), tally);
      if (!any(V(0) < increment)) return;
      points.store_returned(p, point, n);
      plastic.store(0, p - block.begin, increment, n);
      yield.add(p, n);
    });
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      auto point = points.template state<V>(p, n);
      const auto L = velocity_gradient<V>(gradient, p - block.begin);
      const V volume = reference_volume(p, n);
      const V c2 = update.press(point, L.strain_rate, volume, first_lanes<V>(n), tally);
      const auto v = points.template vector<V>(Field::velocity, p, n);
      tally.note_speed(first_lanes<V>(n), c2, dot(v, v));
      points.store_pressed(p, point, n);
      store_push(push, p - block.begin, point, volume, n);
    });
    yield.for_each([&](std::size_t p, int n) PM_INLINE {
      auto point = points.template state<V>(p, n);
      const auto L = velocity_gradient<V>(gradient, p - block.begin);
      const V increment = plastic.template load<V>(0, p - block.begin);
      update.damage(point, increment, L.strain_rate, first_lanes<V>(n), tally);
      points.store(p, point, n);
      store_push(push, p - block.begin, point, reference_volume(p, n), n);
    });
    audit.absorb(tally);
  });
}

// What the points push their nodes with, where their stress stays as it is.
template <class V, class T = number_t<V>>
void push_of_stress(const Particles<T>& points, const std::vector<Material<T>>& materials, const Block& block,
                    Columns<T, 6>& push) {
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      const V volume = points.template load<V>(Field::mass, p, n) * material.specific_volume;
      store_push(push, p - block.begin, points.template state<V>(p, n), volume, n);
    });
  });
}

// FLIP with a share of PIC: v += sum N (v_after - v_before) (6). Returns the kinetic energy that PIC took
// (J).
template <class Shape, class V, class T = number_t<V>>
double update_velocities(Particles<T>& points, const Grid<T>& grid, const Block& block,
                         const Columns<T, 3>& places, T pic) {
  Columns<T, 3> change, after;
  gather_values<Shape, V>(block, places, change, [&](Patch<Shape, T>& patch, const Run& run) {
    Patch<Shape, T> before;
    patch.load(grid.geometry, run, grid.after);
    before.load(grid.geometry, run, grid.before);
    patch.subtract(before);
  });
  if (pic > T(0))
    gather_values<Shape, V>(block, places, after, [&](Patch<Shape, T>& patch, const Run& run) {
      patch.load(grid.geometry, run, grid.after);
    });
  V taken = V(0);
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const auto flip =
        points.template vector<V>(Field::velocity, p, n) + change.template vector<V>(p - block.begin);
    if (!(pic > T(0))) return points.set_vector(Field::velocity, p, flip, n);
    const auto v = V(T(1) - pic) * flip + V(pic) * after.template vector<V>(p - block.begin);
    const V lost = T(0.5) * points.template load<V>(Field::mass, p, n) * (dot(flip, flip) - dot(v, v));
    taken += select(first_lanes<V>(n), lost, V(0));
    points.set_vector(Field::velocity, p, v, n);
  });
  return sum_of(taken);
}

// Moves the stress of the points through a strain of duration dt (see strain_elastically).
template <class V, class T = number_t<V>>
void strain_points(Particles<T>& points, const std::vector<Material<T>>& materials, const Block& block,
                   const Columns<T, 9>& gradient, T dt) {
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      points.prefetch(p + Block::most);
      auto point = points.template state<V>(p, n);
      const auto L = velocity_gradient<V>(gradient, p - block.begin);
      strain_elastically(material, point, L, dt);
      points.store_strained(p, point, n);
    });
  });
}

// x += dt sum N v_after (6).
template <class Shape, class V, class T = number_t<V>>
void move_points(Particles<T>& points, const Grid<T>& grid, const Block& block, const Columns<T, 3>& places,
                 T dt) {
  Columns<T, 3> velocity;
  gather_values<Shape, V>(block, places, velocity, [&](Patch<Shape, T>& patch, const Run& run) {
    patch.load(grid.geometry, run, grid.after);
  });
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const auto x = points.template vector<V>(Field::position, p, n);
    points.set_vector(Field::position, p, x + V(dt) * velocity.template vector<V>(p - block.begin), n);
  });
}

struct Relocated {
  bool changed = false, outside = false;  // whether a point changed its cell; whether one left the grid

  void absorb(const Relocated& other) {
    changed = changed || other.changed;
    outside = outside || other.outside;
  }
};

// The cells of a range of points after they moved.
template <class Shape, class V, class Range, class T = number_t<V>>
Relocated relocate(Particles<T>& points, const GridGeometry<T>& grid, const Range& range) {
  const std::uint32_t plane = grid.index(1, 0, 0), row = grid.index(0, 1, 0);
  Relocated out;
  std::uint32_t differs = 0;
  for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
    const auto x = points.template vector<V>(Field::position, p, n);
    V base[3];
    auto inside = Pack<V>::mask(true);
    for (int a = 0; a < 3; ++a) {
      const V xi = grid.local(x[a], a);
      inside = inside && V(T(grid.pad)) <= xi && xi < V(T(grid.pad + grid.cells[a]));
      base[a] = xi - V(T(Shape::offset));
    }
    std::uint32_t node[Pack<V>::width];
    Pack<V>::nodes(node, base[0], base[1], base[2], plane, row);
    if (any(!inside && first_lanes<V>(n))) {
      out.outside = true;
      T is_inside[Pack<V>::width];
      Pack<V>::store(is_inside, select(inside, V(T(1)), V(T(0))));
      for (int i = 0; i < n; ++i) node[i] = is_inside[i] > T(0) ? node[i] : gone;
    }
    for (int i = 0; i < n; ++i) {
      differs |= points.cell[p + i] ^ node[i];
      points.cell[p + i] = node[i];
    }
  });
  out.changed = differs != 0;
  return out;
}

}  // namespace pockmark
