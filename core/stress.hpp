// The stress of the points of a block, from their strain. V is a number or a pack.
#pragma once
#include "constitutive.hpp"
#include "transfer.hpp"

namespace pockmark {

// Calls f(range of points, material) over the points of a block, in order: one range, unless bodies meet in
// the block.
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

// How a scheme pays the work of a strain: the duration of the strain (s), and the weights of the stress
// before and after it in the energy paid.
struct Pay {
  double dt, old_share, new_share;
};

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
  // Calls two(entry, entry) for packs in pairs, and one(first point, number of points) for a last one without
  // a partner.
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

// The second stage: takes packs back to the yield surface. Returns those of `may_yield` that do yield, and
// leaves the increments of their plastic strain in `plastic`.
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
  // The plain driver has its points one by one; packs go in pairs.
  if constexpr (Pack<V>::width == 1)
    may_yield.for_each(one);
  else
    may_yield.for_each_two(two, one);
  return yield;
}

// Updates stress, damage and heat (3) from the strain of the points. Leaves in `push` what they then push
// their nodes with.
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
    // The packs that the failure law looks at. One that needs no plastic flow looks at more than those that
    // yield.
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

// Finds what the points push their nodes with, where their stress stays as it is.
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

// Takes the stress of the points through a strain (see follow_strain).
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

}  // namespace pockmark
