// Which velocity the nodes strain and move the points with: the mean of their points', or that carried from
// the mass centre of these to the node (levers.hpp).
#pragma once
#include <algorithm>
#include <vector>

#include "../levers.hpp"
#include "lines.hpp"
#include "machine.hpp"

namespace pockmark {

template <class Driver>
class NodeVelocity {
  using T = typename Driver::Number;
  using V = typename Driver::Values;
  using Hints = typename Driver::Hints;

 public:
  explicit NodeVelocity(Machine<Driver>& m)
      : driver_(m.driver),
        grid_(m.model.grid),
        faces_(m.model.faces),
        mirrors_(m.model.faces),
        rows_(m.model.grid),
        levers_(m.levers()),
        spare_(m.carried()),
        is_linear_(m.model.is_linear()) {
    // A body is the same behind a fixed face as behind a plane of symmetry.
    for (Face& face : mirrors_)
      if (face == Face::fixed) face = Face::symmetry;
  }

  bool is_linear() const { return is_linear_; }

  // Forgets where the last step has carried velocities.
  void clear() {
    if (!is_linear_) return;
    driver_.for_each_line(true, [&](int, std::size_t begin, std::size_t end) {
      rows_.for_each_word(rows_.row(begin, end), [&](std::size_t w) { levers_.marks.clear(w); });
      std::fill(levers_.filling + begin, levers_.filling + end, T(0));
    });
  }
  // Finds where to carry, by the masses of the nodes, and the levers: of all points, or of what mass(p)
  // leaves of them.
  void find(Velocity<T> mean) {
    find(mean, [&](std::size_t p) { return driver_.points().at(Field::mass)[p]; });
  }
  template <class Mass>
  void find(Velocity<T> mean, Mass&& mass) {
    if (!is_linear_) return;
    mark(mean);
    find_mirrored();
    driver_.scatter([&](int, const Block& block) {
      for_each_marked(block, [&](const Bundle& bundle) { Hints::moments(driver_.points(), bundle); });
      for_each_marked(block, [&](const Bundle& bundle) {
        levers_.mass[bundle.node] += driver_.add_moments(bundle, mass, levers_.at);
      });
    });
    driver_.exchange(levers_.at);
    fold(on_faces_, mirrors_, levers_.at);
    walk([](const auto& row) { row.find_levers(); });
    constrain(on_faces_, mirrors_, levers_.at);
    for (const Image& one : images_) levers_.mass[one.image] = levers_.mass[one.cell];
    walk([](const auto& row) { row.find_spans(); });
    widen(mirrors_);
    walk([&](const auto& row) { row.divide_by_spans(grid_); });
    constrain(on_faces_, mirrors_, levers_.at);
    forget_outside();
  }
  // Carries a velocity, which is constrained, to the nodes. The means may be put back.
  void carry(Velocity<T> mean) {
    latest_ = mean;
    if (!is_linear_) return;
    carry_on(mean);
  }
  // Does the same with a copy of it, for which there is one array.
  Velocity<T> carried(Velocity<T> mean) {
    if (!is_linear_) return mean;
    driver_.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      std::copy(mean.data + begin, mean.data + end, spare_.data + begin);
    });
    carry_on(spare_);
    return spare_;
  }
  // Puts the means back where carry() has carried a velocity last.
  void put_back() {
    if (!is_linear_) return;
    walk([&](const auto& row) { row.put_back(spare_, latest_); });
    constrain(on_faces_, faces_, latest_);
  }
  // Returns the velocity that carry() has carried last, or `mean` where it is that.
  Velocity<T> latest(Velocity<T> mean) const { return is_linear_ ? latest_ : mean; }
  // Takes forces on the nodes to the mass centres, where they do the same work.
  void take_back(Force<T> force) {
    if (!is_linear_) return;
    constrain(on_faces_, faces_, force);
    walk([&](const auto& row) { row.find_moments(force); });
    fold_cells(levers_.own);
    walk([](const auto& row) { row.widen_moments(); });
    fold_cells(levers_.wide);
    walk([&](const auto& row) { row.carry_back(force); });
  }

 private:
  struct Image : MirroredCell {
    int face;  // the mirror
  };

  // Calls f for the bundles of a block whose cells are marked.
  template <class F>
  void for_each_marked(const Block& block, F&& f) const {
    for_each_bundle(block, [&](const Bundle& bundle) {
      if (rows_.has(levers_.marks.cells[3], bundle)) f(bundle);
    });
  }
  template <class F>
  void for_each_row(F&& f) const {
    driver_.for_each_slot([&](int slot) {
      for (const Row& row : of_slots_[slot]) f(row);
    });
  }
  template <class F>
  void walk(F&& f) const {
    for_each_row([&](const Row& row) { f(LeverRow<T>(grid_, rows_, levers_, row)); });
  }
  // Finds the rows that points touch, and marks what is to be carried in them. No moment is left there.
  void mark(Velocity<T> mean) {
    const auto& marks = levers_.marks;
    of_slots_.resize(std::size_t(driver_.slots()));
    for (auto& rows : of_slots_) rows.clear();
    driver_.for_each_line(false, [&](int slot, std::size_t begin, std::size_t end) {
      const Row& row = of_slots_[slot].emplace_back(rows_.row(begin, end));
      find_filling(grid_, mean, levers_.filling, row);
      mark_mass(mean, marks.has_mass, row);
    });
    for_each_row([&](const Row& row) {
      mark_whole(rows_, marks.has_mass, marks.is_whole, row);
      mark_surface<V>(grid_, levers_.filling, marks, row);
    });
    rows_.mirror(faces_, marks.is_whole);
    for (int ring = 0; ring < LeverMarks::rings; ++ring) {
      for_each_row([&](const Row& row) {
        if (ring > 0) mark_nodes(rows_, marks, ring, row);
        if (ring <= 1) take_out_shared(grid_, rows_, marks, ring, row);
      });
      for_each_row([&](const Row& row) { mark_cells(rows_, marks, ring, row); });
    }
    walk([](const auto& row) { row.clear(); });
  }
  // Finds what is marked on faces, and in the cells behind mirrors.
  void find_mirrored() {
    images_.clear();
    for (int face = 0; face < 6; ++face) {
      on_faces_[face].clear();
      if (!is_mirror(faces_[face])) continue;
      rows_.for_each_face_node(
          face, levers_.marks.nodes[3],
          [](Bits on, Bits inside, Bits outside) { return on | inside | outside; },
          [&](const FaceNode& at) { on_faces_[face].push_back(at); });
      rows_.for_each_face_node(
          face, levers_.marks.cells[2], [&](Bits on, Bits, Bits outside) { return face % 2 ? on : outside; },
          [&](const FaceNode& at) { images_.push_back({mirrored_cell(face, at), face}); });
    }
  }
  void carry_on(Velocity<T> mean) const {
    walk([&](const auto& row) { row.find_gradients(mean); });
    widen(faces_);
    walk([&](const auto& row) { row.carry(mean, spare_); });
    constrain(on_faces_, faces_, mean);
  }
  // Adds up what cells have over those around; the last sum, over the cells of a node, is left to do.
  void widen(const Faces& faces) const {
    const auto copy = [&](Slopes<T>* cells) {
      for (const Image& one : images_) cells[one.image] = seen_in(faces, one, cells[one.cell]);
    };
    copy(levers_.own);
    walk([](const auto& row) { row.widen(); });
    copy(levers_.wide);
  }
  // Takes the levers from the nodes behind mirrors: their images speak for them.
  void forget_outside() const {
    for (const auto& nodes : on_faces_)
      for (const FaceNode& at : nodes) levers_.at[at.outside] = {};
  }
  // Gives what the cells behind a mirror have to their images: the transpose of the copy.
  void fold_cells(Slopes<T>* cells) const {
    for (const Image& one : images_) {
      cells[one.cell] += seen_in(faces_, one, cells[one.image]);
      cells[one.image] = {};
    }
  }
  static Slopes<T> seen_in(const Faces& faces, const Image& one, const Slopes<T>& slopes) {
    return mirrored(faces[one.face], one.face / 2, slopes);
  }

  Driver& driver_;
  const GridGeometry<T>& grid_;
  const Faces& faces_;
  Faces mirrors_;
  RowBits<T> rows_;
  Levers<T> levers_;
  Velocity<T> spare_, latest_{};
  bool is_linear_;
  std::vector<std::vector<Row>> of_slots_;  // that points touch
  FaceNodes on_faces_;                      // where something is marked
  std::vector<Image> images_;               // that are marked
};

}  // namespace pockmark
