// Contact during a run: the nodes where two bodies meet, and what happens there.
#pragma once
#include "../contact.hpp"
#include "model.hpp"

namespace pockmark {

// The current volume (m^3) of a point.
template <class T>
struct VolumeOf {
  const Model<T>* model;
  Points<T> points;
  T operator()(std::size_t p) const { return T(model->volume(points, p)); }
};
// The current width (m) of a point: the side of a cube, or of a ring's square section.
template <class T>
struct WidthOf {
  VolumeOf<T> volume;
  T operator()(std::size_t p) const {
    const auto& grid = volume.model->grid;
    if (!grid.is_axisymmetric) return std::cbrt(volume(p));
    return std::sqrt(volume(p) / T(circumference(grid, volume.points, p)));
  }
};

template <class T>
class Contact {
 public:
  Contact(const GridGeometry<T>& grid, const Faces& faces, T friction)
      : second_(grid.node_count()), friction_(friction), mirrors_(faces), meeting_of_(second_, none) {
    // A body is the same behind a fixed face as behind a plane of symmetry.
    for (Face& face : mirrors_)
      if (face == Face::fixed) face = Face::symmetry;
  }

  // Finds where the bodies meet, and how far apart they are there, at the start of a step of `dt` (s).
  // `surface`: an array of zeros, which are zeros again in the end.
  template <class Shape, class Driver>
  void find(const Model<T>& model, const Driver& driver, Velocity<T> before, Surface<T> surface, T dt) {
    find_meetings(driver, before);
    if (meetings_.empty()) return;
    const VolumeOf<T> volume{&model, driver.points()};
    orient<Shape>(model.grid, driver, surface, volume);
    const std::size_t count = meetings_.size();
    if (Shape::support > 2) add_images(model.grid);
    driver.scatter([&](int, const Block& block) {
      for_each_bundle(block, [&](const Bundle& bundle) {
        add_reach<Shape>(
            driver.points(), model.grid, bundle, [&](std::size_t node) { return at(node); },
            WidthOf<T>{volume});
      });
    });
    take_back_images(count);
    for (Meeting<T>& m : meetings_) {
      m.allow_closing(dt);
      m.approach = dot(relative(m, before), m.normal);
    }
  }

  // Takes the approach of touching bodies out of a nodal velocity. The points keep theirs.
  void fit(Velocity<T> velocity) {
    for (Meeting<T>& m : meetings_) {
      const T approach = dot(relative(m, velocity), m.normal);
      m.twice_fitted += stop(m, velocity, m.beyond_closing(approach), T(0));
    }
  }

  // Changes the velocities after the forces acted: no approach, and friction.
  void stop_approach(Velocity<T> after) {
    for (Meeting<T>& m : meetings_) {
      const T approach = dot(relative(m, after), m.normal), beyond = m.beyond_closing(approach);
      m.impulse = {};
      if (beyond > T(0)) m.impulse = stop(m, after, m.share_in_contact(approach) * beyond, friction_);
    }
  }

  // Returns the kinetic energy (J / Model::mass_unit) that the last step took from the points and paid no
  // stress with: `final` is the points' velocity now, at the nodes (docs/theory.md, Eqs. 6 and 21).
  double taken(Velocity<T> before_forces, Velocity<T> after, Velocity<T> final) const {
    double sum = 0;
    for (const Meeting<T>& m : meetings_) {
      const auto before = relative(m, before_forces), change = relative(m, after) - before;
      sum += 0.5 * double(dot(m.impulse, before + relative(m, final)) - dot(m.twice_fitted, change));
    }
    return sum;
  }
  std::size_t bytes() const { return meeting_of_.size() * sizeof(meeting_of_[0]); }

 private:
  static constexpr std::uint32_t none = UINT32_MAX;

  Meeting<T>* at(std::size_t node) {
    return meeting_of_[node] == none ? nullptr : &meetings_[meeting_of_[node]];
  }

  template <class Driver>
  void find_meetings(const Driver& driver, Velocity<T> velocity) {
    for (const Meeting<T>& m : meetings_) meeting_of_[m.node] = none;
    meetings_.clear();
    found_.assign(driver.slots(), {});
    driver.for_each_line(false, [&](int slot, std::size_t begin, std::size_t end) {
      if (begin >= second_) return;
      for (std::size_t node = begin; node < end; ++node)
        if (has_mass(velocity, node) && has_mass(velocity, second_ + node)) found_[slot].push_back(node);
    });
    for (const auto& nodes : found_)
      for (const std::size_t node : nodes) {
        meeting_of_[node] = std::uint32_t(meetings_.size());
        meetings_.push_back({.node = node, .mass = {velocity[node].v[3], velocity[second_ + node].v[3]}});
      }
  }

  // Whether a block touches a node where the bodies meet.
  template <class Shape>
  bool meets(const GridGeometry<T>& grid, const Block& block) const {
    bool any = false;
    for_each_bundle(block, [&](const Bundle& bundle) {
      const std::size_t node = bundle.node - grid.field_of(bundle.node);
      Patch<Shape, T>::for_each(
          [&](int i, int j, int k) { any = any || meeting_of_[node + grid.index(i, j, k)] != none; });
    });
    return any;
  }

  // Finds the normals.
  template <class Shape, class Driver, class Volume>
  void orient(const GridGeometry<T>& grid, const Driver& driver, Surface<T> surface, Volume&& volume) {
    driver.scatter([&](int, const Block& block) {
      if (!meets<Shape>(grid, block)) return;
      for_each_bundle(block, [&](const Bundle& bundle) {
        add_surface<Shape>(driver.points(), grid, bundle, surface, volume);
      });
    });
    driver.exchange(surface);
    fold(driver, grid, mirrors_, surface, Mirrored::vector);
    constrain(driver, grid, mirrors_, surface);
    for (Meeting<T>& m : meetings_) m.normal = contact_normal(surface[m.node], surface[second_ + m.node]);
    driver.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      std::fill(surface.data + begin, surface.data + end, Quad<T>{});
    });
  }

  // Adds the images of meetings one node inside a mirror: what reaches an image is the image of what reaches
  // the node. Where mirrors cross an image may have an image, too.
  void add_images(const GridGeometry<T>& grid) {
    const std::size_t stride[3] = {grid.index(1, 0, 0), grid.index(0, 1, 0), 1};
    for (int face = 0; face < 6; ++face) {
      if (!is_mirror(mirrors_[face])) continue;
      const int axis = face / 2, inside = face % 2 ? grid.pad + grid.cells[axis] - 1 : grid.pad + 1;
      const std::size_t count = meetings_.size();
      for (std::size_t i = 0; i < count; ++i) {
        Meeting<T> image{.node = meetings_[i].node, .normal = meetings_[i].normal};
        int ijk[3];
        grid.split(image.node, ijk);
        if (ijk[axis] != inside) continue;
        if (face % 2)
          image.node += 2 * stride[axis];
        else
          image.node -= 2 * stride[axis];
        image.normal[axis] = -image.normal[axis];
        meeting_of_[image.node] = std::uint32_t(meetings_.size());
        meetings_.push_back(image);
        image_of_.push_back(i);
      }
    }
  }
  // Folds what reaches the images, those after the first `count` meetings, and forgets them.
  void take_back_images(std::size_t count) {
    for (; meetings_.size() > count; meetings_.pop_back(), image_of_.pop_back()) {
      const Meeting<T>& image = meetings_.back();
      Meeting<T>& original = meetings_[image_of_.back()];
      for (int side = 0; side < 2; ++side)
        original.reach[side] = max(original.reach[side], image.reach[side]);
      meeting_of_[image.node] = none;
    }
  }

  // Returns the first body's velocity less the second's.
  Vec3<T> relative(const Meeting<T>& m, Velocity<T> velocity) const {
    return velocity[m.node].vector() - velocity[second_ + m.node].vector();
  }

  // Takes `speed` (m/s) from the approach. Returns the impulse of the first body on the second.
  Vec3<T> stop(const Meeting<T>& m, Velocity<T> velocity, T speed, T friction) const {
    if (!(speed > T(0))) return {};
    const auto impulse =
        contact_impulse(relative(m, velocity), m.mass[0], m.mass[1], m.normal, speed, friction);
    Quad<T>&first = velocity[m.node], &second = velocity[second_ + m.node];
    first.set_vector(first.vector() - (T(1) / m.mass[0]) * impulse);
    second.set_vector(second.vector() + (T(1) / m.mass[1]) * impulse);
    return impulse;
  }

  std::size_t second_;  // first node of the second field
  T friction_;
  Faces mirrors_;
  std::vector<Meeting<T>> meetings_;
  std::vector<std::size_t> image_of_;      // of each image at the end of meetings_, while there are some
  std::vector<std::uint32_t> meeting_of_;  // of each node, where meetings_ has it
  std::vector<std::vector<std::size_t>> found_;  // of each slot
};

}  // namespace pockmark
