// Which velocity the nodes strain and move the points with: the mean of their points', or that carried from
// the mass centre of these to the node (levers.hpp).
#pragma once
#include "../levers.hpp"
#include "lines.hpp"
#include "machine.hpp"

namespace pockmark {

template <class Driver>
class NodeVelocity {
  using T = typename Driver::Number;

 public:
  explicit NodeVelocity(Machine<Driver>& m)
      : driver_(m.driver),
        grid_(m.model.grid),
        faces_(m.model.faces),
        mirrors_(m.model.faces),
        levers_(m.levers()),
        carried_(m.carried()),
        is_linear_(m.model.is_linear()) {
    // A body is the same behind a fixed face as behind a plane of symmetry.
    for (Face& face : mirrors_)
      if (face == Face::fixed) face = Face::symmetry;
  }

  bool is_linear() const { return is_linear_; }

  // Forgets where the last step has carried velocities.
  void clear() {
    if (!is_linear_) return;
    driver_.for_each_line(true,
                          [&](int, std::size_t begin, std::size_t end) { levers_.marks.clear(begin, end); });
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
    walk([](const auto& line) { line.clear(); });
    driver_.scatter([&](int, const Block& block) {
      for_each_bundle(block, [&](const Bundle& bundle) {
        if (levers_.marks.cells[3][bundle.node]) add_moments(driver_.points(), grid_, bundle, mass, levers_);
      });
    });
    driver_.exchange(levers_.at);
    fold(driver_, grid_, mirrors_, levers_.at, Mirrored::vector);
    walk([](const auto& line) { line.find_levers(); });
    constrain(driver_, grid_, mirrors_, levers_.at);
    for_each_mirrored_cell(driver_, grid_, mirrors_, [&](std::size_t image, std::size_t cell) {
      levers_.set_mass(image, levers_.mass(cell));
    });
    walk([](const auto& line) { line.find_spans(); });
    walk([](const auto& line) { line.look_around(); });
    widen(mirrors_);
    for_each_line([&](const Line<T>& line) {
      LeverLine<T>(levers_, line).divide_by_spans(ring_shift(grid_, line.first[0]));
    });
    constrain(driver_, grid_, mirrors_, levers_.at);
    forget_outside();
  }
  // Returns the velocity at the nodes, for which there is one array: that of the last call is lost.
  Velocity<T> of(Velocity<T> mean) {
    if (!is_linear_) return mean;
    walk([&](const auto& line) { line.find_gradients(mean); });
    widen(faces_);
    walk([&](const auto& line) { line.carry(mean, carried_); });
    constrain(driver_, grid_, faces_, carried_);
    return carried_;
  }
  // Returns the velocity that of() has found last, or `mean` where it is that.
  Velocity<T> latest(Velocity<T> mean) const { return is_linear_ ? carried_ : mean; }
  // Takes forces on the nodes to the mass centres, where they do the same work.
  void take_back(Force<T> force) {
    if (!is_linear_) return;
    constrain(driver_, grid_, faces_, force);
    walk([&](const auto& line) { line.find_moments(force); });
    fold_cells();
    walk([](const auto& line) { line.spread(); });
    walk([](const auto& line) { line.gather(2); });
    fold_cells();
    walk([&](const auto& line) { line.carry_back(force); });
  }

 private:
  template <class F>
  void for_each_line(F&& f) const {
    driver_.for_each_line(false,
                          [&](int, std::size_t begin, std::size_t end) { f(Line<T>(grid_, begin, end)); });
  }
  template <class F>
  void walk(F&& f) const {
    for_each_line([&](const Line<T>& line) { f(LeverLine<T>(levers_, line)); });
  }
  void mark(Velocity<T> mean) const {
    const auto& marks = levers_.marks;
    for_each_line([&](const Line<T>& line) { find_filling(grid_, mean, marks, line); });
    for_each_line([&](const Line<T>& line) { mark_surface(grid_, marks, line); });
    for_each_mirrored_cell(driver_, grid_, faces_, [&](std::size_t image, std::size_t cell) {
      marks.is_whole[image] = marks.is_whole[cell];
    });
    for (int ring = 0; ring < LeverMarks<T>::rings; ++ring) {
      if (ring > 0) for_each_line([&](const Line<T>& line) { mark_nodes(grid_, marks, ring, line); });
      for_each_line([&](const Line<T>& line) { mark_cells(marks, ring, line); });
    }
  }
  // Calls f(image, cell, mirrored) where an image is marked, and with it the cell: mirrored(i, r) is row r of
  // cell i in the mirror.
  template <class F>
  void for_each_mirrored(const Faces& faces, F&& f) const {
    for (int face = 0; face < 6; ++face) {
      Faces one{};
      one[face] = faces[face];
      const auto mirrored = [&, face](std::size_t i, int r) {
        return mirrored_row(faces[face], face / 2, r, levers_.cells.row(i, r));
      };
      for_each_mirrored_cell(driver_, grid_, one, [&](std::size_t image, std::size_t cell) {
        if (levers_.marks.cells[2][image]) f(image, cell, mirrored);
      });
    }
  }
  // Adds up what cells have over those around, two away; the last sum, over the cells of a node, is left to
  // do. The fourth number of the first row goes along.
  void widen(const Faces& faces) const {
    const auto copy = [&] {
      for_each_mirrored(faces, [&](std::size_t image, std::size_t cell, const auto& mirrored) {
        for (int r = 0; r < 3; ++r) levers_.cells.set(image, r, mirrored(cell, r));
        levers_.cells.at[0][image].v[3] = levers_.cells.at[0][cell].v[3];
      });
    };
    copy();
    walk([](const auto& line) { line.spread(); });
    walk([](const auto& line) { line.gather(1); });
    copy();
  }
  // Takes the levers from the nodes behind mirrors: their images speak for them.
  void forget_outside() const {
    for (int face = 0; face < 6; ++face) {
      if (!is_mirror(faces_[face])) continue;
      for_each_face_node(driver_, grid_, face,
                         [&](const FaceNode& at) { levers_.at[at.outside].set_vector({}); });
    }
  }
  // Gives what the cells behind a mirror have to their images: the transpose of the copy.
  void fold_cells() const {
    for_each_mirrored(faces_, [&](std::size_t image, std::size_t cell, const auto& mirrored) {
      for (int r = 0; r < 3; ++r) {
        levers_.cells.set(cell, r, levers_.cells.row(cell, r) + mirrored(image, r));
        levers_.cells.set(image, r, {});
      }
    });
  }

  Driver& driver_;
  const GridGeometry<T>& grid_;
  const Faces& faces_;
  Faces mirrors_;
  Levers<T> levers_;
  Velocity<T> carried_;
  bool is_linear_;
};

}  // namespace pockmark
