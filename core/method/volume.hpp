// Where the points take their volumetric strain from, and where their mean stress goes: their own gradient,
// or cells.
#pragma once
#include "../transfer.hpp"
#include "machine.hpp"

namespace pockmark {

template <class Driver, class Shape>
class Volume {
  using T = typename Driver::Number;
  using V = typename Driver::Values;
  using Hints = typename Driver::Hints;

 public:
  explicit Volume(Machine<Driver>& m)
      : driver_(m.driver),
        grid_(m.model.grid),
        faces_(m.model.faces),
        cells_(m.cells()),
        by_cells_(m.model.by_cells()) {}

  // Finds which cells are whole, and what find() does. To be called first in a step.
  void begin(Velocity<T> velocity) {
    if (!by_cells_) return;
    find(velocity,
         [&](std::size_t begin, std::size_t end) { find_whole(grid_, velocity, cells_, begin, end); });
    if (!CellsAround<Shape, T>::whole_only) return;
    driver_.for_each_line(
        false, [&](int, std::size_t begin, std::size_t end) { find_surrounded(grid_, cells_, begin, end); });
  }
  // Finds the divergence of a nodal velocity in the cells; what pushed them before is gone.
  void find(Velocity<T> velocity) {
    if (by_cells_) find(velocity, [](std::size_t, std::size_t) {});
  }
  // Finds how a nodal velocity, of which find() knows, strains the points of a block in a time dt.
  void gather(const Block& block, Velocity<T> velocity, T dt, StrainColumns<T>& strains) const {
    gather_with(block, velocity, dt, strains, [](std::size_t, const auto&, const auto&) PM_INLINE {});
  }
  // Finds besides how far the points move in dt/2, in cells.
  void gather(const Block& block, Velocity<T> velocity, T dt, StrainColumns<T>& strains,
              Columns<T, 3>& motion) const {
    gather_with(block, velocity, dt, strains,
                [&](std::size_t i, const auto& f, const auto& displacement) PM_INLINE {
                  const auto half = displacement.value(f);
                  for (int c = 0; c < 3; ++c) motion.store(c, i, half[c]);
                });
  }
  // Takes the mean stress out of what a block pushes with, and pushes the cells with it.
  void take_mean_stress(const Block& block, Columns<T, 6>& push) const {
    if (by_cells_) move_mean_to_cells<Shape, V>(driver_.points(), grid_, block, push, cells_);
  }
  // Adds the forces of the pushed cells.
  void add_to(Force<T> force) {
    if (!by_cells_) return;
    for_each_mirrored_cell(driver_, grid_, faces_, [&](std::size_t image, std::size_t cell) {
      cells_.push[cell] += cells_.push[image];
      cells_.push[image] = T(0);
    });
    driver_.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      add_cell_forces<Shape>(grid_, cells_, force, begin, end);
    });
  }

 private:
  template <class Also>
  void gather_with(const Block& block, Velocity<T> velocity, T dt, StrainColumns<T>& strains,
                   Also&& also) const {
    const auto with = [&](const auto& volume) {
      gather_strain<Shape, V, Hints>(driver_.points(), grid_, block, velocity, dt, volume, strains, also);
    };
    if (by_cells_)
      with(CellVolume<Shape, T>(grid_, cells_, dt));
    else
      with(OwnVolume{});
  }
  // Calls first(begin, end) for each line of cells while its nodes are in the cache.
  template <class First>
  void find(Velocity<T> velocity, First&& first) {
    driver_.for_each_line(false, [&](int, std::size_t begin, std::size_t end) {
      first(begin, end);
      find_divergence<Shape>(grid_, velocity, cells_, begin, end);
    });
    for_each_mirrored_cell(driver_, grid_, faces_,
                           [&](std::size_t image, std::size_t cell) { cells_.mirror(image, cell); });
  }

  Driver& driver_;
  const GridGeometry<T>& grid_;
  const Faces& faces_;
  Cells<T> cells_;
  bool by_cells_;
};

}  // namespace pockmark
