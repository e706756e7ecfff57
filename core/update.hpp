// What the points of a block take from the grid: stress, velocity, position. V is a number or a pack.
#pragma once
#include "constitutive.hpp"
#include "transfer.hpp"

namespace pockmark {

// f(range of points, material) over the points of a block, in order: one range, unless bodies meet in the
// block.
template <class T, class F>
PM_HD void for_each_material(const Points<T>& points, const Material<T>* materials, const Block& block,
                             F&& f) {
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
  // two(entry, entry), and one(first point, number of points) for a last one without a partner.
  template <class F, class G>
  PM_HD void for_each_two(F&& two, G&& one) const {
    int i = 0;
    for (; i + 1 < count; i += 2) two(entries[i], entries[i + 1]);
    if (i < count) one(entries[i].p, entries[i].n);
  }
};

template <class V, class T>
PM_HD V reference_volume(const Points<T>& points, const Material<T>& material, std::size_t p, int n) {
  return points.template load<V>(Field::mass, p, n) * material.specific_volume;
}

// The second stage: of the packs that may yield, those that do, with the increments of their plastic strain.
template <class V, class T>
PM_HD PackList return_to_yield(const Points<T>& points, const Block& block, const StressUpdate<V>& update,
                               const PackList& may_yield, Columns<T, 1>& plastic, Tally<V>& tally) {
  PackList yield;
  const auto take_back = [&](std::size_t p, int n, PointState<V>& point, V trial,
                             const PlasticReturn<V>& back) {
    const V volume = reference_volume<V>(points, update.material, p, n);
    const V increment = update.yield(point, trial, back, volume, first_lanes<V>(n), tally);
    if (!any(V(0) < increment)) return;
    points.store_returned(p, point, n);
    plastic.store(0, p - block.begin, increment, n);
    yield.add(p, n);
  };
  const auto one = [&](std::size_t p, int n) PM_INLINE {
    auto point = points.template state<V>(p, n);
    const V trial = effective(point.deviator);
    take_back(p, n, point, trial,
              update.material.return_map(trial, point.plastic_strain, conditions_of(point), update.step));
  };
  const auto two = [&](PackList::Entry first, PackList::Entry second) PM_INLINE {
    auto a = points.template state<V>(first.p, first.n), b = points.template state<V>(second.p, second.n);
    const Twice<V> trial{effective(a.deviator), effective(b.deviator)};
    const auto [increment, converged] = update.material.return_map(
        trial, Twice<V>{a.plastic_strain, b.plastic_strain}, conditions_of(a, b), update.step);
    take_back(first.p, first.n, a, trial.a, {increment.a, converged.a});
    take_back(second.p, second.n, b, trial.b, {increment.b, converged.b});
  };
  // The reference takes its points one by one; packs go in pairs.
  if constexpr (Pack<V>::width == 1)
    may_yield.for_each(one);
  else
    may_yield.for_each_two(two, one);
  return yield;
}

// Stress, damage, heat (3) from the strain of the points, and what they then push their nodes with.
template <class V, class Hints, class T = number_t<V>>
void update_stress(const Points<T>& points, const Material<T>* materials, T cell, const Block& block,
                   const StrainColumns<T>& strains, const StressStep<T>& step, Audit& audit,
                   Columns<T, 6>& push) {
  Columns<T, 1> plastic;
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    const StressUpdate<V> update{material, cell, step.dt, step.step, step.old_share, step.new_share};
    auto tally = audit.tally<V>();
    PackList may_yield;
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      Hints::template before<Pass::strain>(points, p);
      auto point = points.template state<V>(p, n);
      const auto strain = load_strain<V>(strains, p - block.begin);
      const bool yields = any(update.strain(point, strain, first_lanes<V>(n), tally));
      points.store_strained(p, point, n);
      if (yields) may_yield.add(p, n);
    });
    const auto yield = return_to_yield(points, block, update, may_yield, plastic, tally);
    // Those that the failure law looks at: where it needs no plastic flow, also others than those that yield.
    const bool without_flow = material.fails_without_flow();
    PackList loaded;
    int next = 0;
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      Hints::template before<Pass::pressure>(points, p);
      auto point = points.template state<V>(p, n);
      const auto strain = load_strain<V>(strains, p - block.begin);
      const V volume = reference_volume<V>(points, material, p, n);
      const V c2 = update.press(point, strain.small, volume, first_lanes<V>(n), tally);
      const auto v = points.template vector<V>(Field::velocity, p, n);
      tally.note_speed(first_lanes<V>(n), c2, dot(v, v));
      points.store_pressed(p, point, n);
      store_push(push, p - block.begin, point, volume, n);
      if (!without_flow) return;
      const bool yields = next < yield.count && yield.entries[next].p == p;
      next += yields;
      if (!yields) plastic.store(0, p - block.begin, V(0), n);
      if (yields || any(update.breaks(point, first_lanes<V>(n)))) loaded.add(p, n);
    });
    (without_flow ? loaded : yield).for_each([&](std::size_t p, int n) PM_INLINE {
      auto point = points.template state<V>(p, n);
      const auto strain = load_strain<V>(strains, p - block.begin);
      const V increment = plastic.template load<V>(0, p - block.begin);
      update.damage(point, increment, strain.small, first_lanes<V>(n), tally);
      points.store(p, point, n);
      store_push(push, p - block.begin, point, reference_volume<V>(points, material, p, n), n);
    });
    audit.absorb(tally);
  });
}

// What the points push their nodes with, where their stress stays as it is.
template <class V, class T = number_t<V>>
void push_of_stress(const Points<T>& points, const Material<T>* materials, const Block& block,
                    Columns<T, 6>& push) {
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      store_push(push, p - block.begin, points.template state<V>(p, n),
                 reference_volume<V>(points, material, p, n), n);
    });
  });
}

// FLIP with a share of PIC: v += sum N (v_after - v_before) (6). Returns the kinetic energy that PIC took
// (J).
template <class Shape, class V, class Hints, class T = number_t<V>>
double update_velocities(const Points<T>& points, const GridGeometry<T>& grid, const Block& block,
                         Velocity<T> before, Velocity<T> after, T pic) {
  Columns<T, 3> change, now;
  gather_values<Shape, V>(points, block, change, [&](Patch<Shape, T>& patch, const Run& run) {
    Patch<Shape, T> old;
    patch.load(grid, run, after);
    old.load(grid, run, before);
    patch.subtract(old);
  });
  if (pic > T(0))
    gather_values<Shape, V>(points, block, now,
                            [&](Patch<Shape, T>& patch, const Run& run) { patch.load(grid, run, after); });
  V taken = V(0);
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    Hints::template before<Pass::velocity>(points, p);
    const auto flip =
        points.template vector<V>(Field::velocity, p, n) + change.template vector<V>(p - block.begin);
    if (!(pic > T(0))) return points.set_vector(Field::velocity, p, flip, n);
    const auto v = V(T(1) - pic) * flip + V(pic) * now.template vector<V>(p - block.begin);
    const V lost = T(0.5) * points.template load<V>(Field::mass, p, n) * (dot(flip, flip) - dot(v, v));
    taken += select(first_lanes<V>(n), lost, V(0));
    points.set_vector(Field::velocity, p, v, n);
  });
  return sum_of(taken);
}

// Moves the stress of the points through a strain (see follow_strain).
template <class V, class Hints, class T = number_t<V>>
void strain_points(const Points<T>& points, const Material<T>* materials, const Block& block,
                   const StrainColumns<T>& strains) {
  for_each_material(points, materials, block, [&](const auto& range, const Material<T>& material) {
    for_each_pack<V>(range, [&](std::size_t p, int n) PM_INLINE {
      Hints::template before<Pass::last_strain>(points, p);
      auto point = points.template state<V>(p, n);
      const auto strain = load_strain<V>(strains, p - block.begin);
      follow_strain(material, point, strain);
      points.store_strained(p, point, n);
    });
  });
}

// The face behind which a point lies, or -1: `f` cells from its first node `base`. Not-a-number counts as
// outside.
template <class T>
PM_HD int face_crossed(const GridGeometry<T>& grid, const int (&base)[3], const Vec3<T>& f) {
  for (int a = 0; a < 3; ++a) {
    const T xi = T(base[a]) + f[a];
    if (!(xi >= T(grid.pad))) return 2 * a;
    if (!(xi < T(grid.pad + grid.cells[a]))) return 2 * a + 1;
  }
  return -1;
}

// Puts a point that has crossed a plane of symmetry where its image has come from: what leaves the half that
// is computed enters it from the other. `base` and `f`: its place, as for face_crossed.
template <class Shape, class T>
PM_HD void reflect(const Points<T>& points, const GridGeometry<T>& grid, std::size_t p, int (&base)[3],
                   Vec3<T>& f) {
  for (int face = 0; face < 6; ++face) {
    if (!grid.is_symmetric[face]) continue;
    const int a = face / 2, plane = face % 2 ? grid.pad + grid.cells[a] : grid.pad;
    const T beyond = (T(base[a] - plane) + f[a]) * (face % 2 ? T(1) : T(-1));  // cells
    // The upper plane itself is outside.
    if (!(beyond > T(0) || (face % 2 && beyond == T(0))) || !(beyond < T(grid.cells[a]))) continue;
    const T inside = face % 2 ? -max(beyond, std::numeric_limits<T>::epsilon()) : beyond;  // from the plane
    const T shift = std::floor(inside - T(Shape::offset));
    base[a] = plane + int(shift);
    f[a] = inside - shift;
    T* v = points.at(Field::velocity, a);
    v[p] = -v[p];
    // xy, yz, zx: two of them have the axis.
    for (int c = 3; c < 6; ++c)
      if (c - 3 == a || (c - 2) % 3 == a) points.at(Field::deviator, c)[p] *= T(-1);
  }
}

// Gives a point that moved out of its stencil's reach a new one, or has it leave the grid: leave(point,
// face). Returns whether it changed its cell.
template <class Shape, class T, class Leave>
PM_NOINLINE bool relocate(const Points<T>& points, const GridGeometry<T>& grid, std::size_t p,
                          Leave&& leave) {
  int base[3];
  grid.split(points.cell[p], base);
  auto f = points.vector(Field::place, p);
  for (int a = 0; a < 3; ++a) {
    const T shift = std::floor(f[a] - T(Shape::offset));
    if (!(std::abs(shift) < T(1e6))) continue;  // it has left
    base[a] += int(shift);
    f[a] -= shift;
  }
  reflect<Shape>(points, grid, p, base, f);
  const int face = face_crossed(grid, base, f);
  if (face >= 0) leave(p, face);
  const std::size_t node = grid.field_of(points.cell[p]) + grid.index(base[0], base[1], base[2]);
  const std::uint32_t cell = face >= 0 ? gone : std::uint32_t(node);
  const bool changed = cell != points.cell[p];
  points.cell[p] = cell;
  points.set_vector(Field::place, p, f);
  return changed;
}

// x += dt sum N v_after (6). Calls leave(point, face) for a point that leaves the grid. Returns whether a
// point changed its cell.
template <class Shape, class V, class T, class Leave>
bool move_points(const Points<T>& points, const GridGeometry<T>& grid, const Block& block, Velocity<T> after,
                 T dt, Leave&& leave) {
  bool changed = false;
  Columns<T, 3> velocity;
  gather_values<Shape, V>(points, block, velocity,
                          [&](Patch<Shape, T>& patch, const Run& run) { patch.load(grid, run, after); });
  const T cells_per_speed = dt * grid.per_metre;
  const V low = V(T(Shape::offset)), high = V(T(Shape::offset) + T(1));
  const auto inside = [&](V f) PM_INLINE { return low <= f && f < high; };
  for_each_pack<V>(block, [&](std::size_t p, int n) PM_INLINE {
    const auto f = points.template vector<V>(Field::place, p, n) +
                   V(cells_per_speed) * velocity.template vector<V>(p - block.begin);
    points.set_vector(Field::place, p, f, n);
    if (any(!(inside(f.x) && inside(f.y) && inside(f.z)) && first_lanes<V>(n)))
      for (int i = 0; i < n; ++i) changed |= relocate<Shape>(points, grid, p + i, leave);
  });
  if (Shape::offset == 0) return changed;
  // These functions reach beyond the faces: a point can leave the grid and keep its stencil.
  for_each_run(block, [&](const Run& run) {
    bool rim = false;
    for (int a = 0; a < 3; ++a)
      rim = rim || run.base[a] < grid.pad || run.base[a] >= grid.pad + grid.cells[a] - 1;
    if (!rim) return;
    for (std::size_t p = run.begin; p < run.end; ++p)
      if (points.cell[p] == run.node && face_crossed(grid, run.base, points.vector(Field::place, p)) >= 0)
        changed |= relocate<Shape>(points, grid, p, leave);
  });
  return changed;
}

// Whether a step without motion would leave the points of a block as they are.
template <class T>
PM_HD bool rests(const Points<T>& points, const Block& block) {
  for (std::size_t p = block.begin; p < block.end; ++p) {
    const auto point = points.state(p);
    const auto v = points.vector(Field::velocity, p);
    if (!(v.x == T(0) && v.y == T(0) && v.z == T(0) && effective(point.deviator) == T(0) &&
          point.dilation == T(0) && point.energy == T(0) && point.pressure == T(0) &&
          point.viscosity == T(0)))
      return false;
  }
  return true;
}

}  // namespace pockmark
