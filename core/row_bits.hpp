// A bit for each node of the grid, or for the cell that begins there: 64 along z are looked at as one.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

#include "block.hpp"
#include "boundary.hpp"

namespace pockmark {

using Bits = std::uint64_t;

// A row of nodes: which of them points touch, and where its bits are. Each row begins with a word of its own:
// two threads never write to the same one.
struct Row {
  std::size_t first;  // the node at k = 0
  std::size_t word;   // the first one, of a column of bits
  int i, j;           // of its nodes
  int begin, end;     // k, of the nodes that points touch
  bool begins_cells;  // it is not the last row of its plane, nor in the last plane
  bool is_inside;     // it has a row on each side
};

// How a column of bits lies in memory: row after row, one bit a node.
template <class T>
class RowBits {
 public:
  explicit RowBits(const GridGeometry<T>& grid)
      : grid_(grid),
        per_row_((std::size_t(grid.nodes(2)) + 63) / 64),
        y_(per_row_),
        x_(per_row_ * std::size_t(grid.nodes(1))) {}

  // Words of a column, and of those in front of its first row, which stay zero: so each row has others before
  // it.
  std::size_t words() const { return grid_.field_count * of_a_field(); }
  std::size_t margin() const { return x_ + y_; }

  // Returns the row of a line of nodes.
  Row row(std::size_t begin, std::size_t end) const {
    int at[3];
    grid_.split(begin, at);
    const auto [i, j, k] = at;
    const bool begins_cells = i + 1 < grid_.nodes(0) && j + 1 < grid_.nodes(1);
    return {begin - std::size_t(k),        word(begin, i, j), i, j, k, k + int(end - begin), begins_cells,
            begins_cells && i > 0 && j > 0};
  }
  // Returns whether the cell of a bundle has its bit.
  bool has(const Bits* column, const Bundle& bundle) const {
    const auto [i, j, k] = bundle.base;
    return column[word(bundle.node, i, j) + std::size_t(k) / 64] >> (k % 64) & 1;
  }

  // Returns the word of the other of two velocity fields for the same nodes.
  std::size_t in_other_field(const Row& row, std::size_t w) const {
    return grid_.field_of(row.first) == 0 ? w + of_a_field() : w - of_a_field();
  }

  // Calls f(w) for each word of a row.
  template <class F>
  void for_each_word(const Row& row, F&& f) const {
    for (std::size_t w = row.word; w < row.word + per_row_; ++w) f(w);
  }
  // Calls f(node) for each bit that is set in a row: bits(w) are those of a word.
  template <class Of, class F>
  void for_each_set(const Row& row, Of&& bits, F&& f) const {
    std::size_t first = row.first;
    for (std::size_t w = row.word; w < row.word + per_row_; ++w, first += 64)
      for (Bits left = bits(w); left != 0; left &= left - 1) f(first + std::size_t(std::countr_zero(left)));
  }
  template <class F>
  void for_each(const Bits* column, const Row& row, F&& f) const {
    for_each_set(row, [&](std::size_t w) { return column[w]; }, f);
  }
  // Calls f(first node, end) for bits that are set side by side in a word.
  template <class F>
  void for_each_run(const Bits* column, const Row& row, F&& f) const {
    std::size_t first = row.first;
    for (std::size_t w = row.word; w < row.word + per_row_; ++w, first += 64)
      for (Bits left = column[w]; left != 0;) {
        const int begin = std::countr_zero(left), end = begin + std::countr_one(left >> begin);
        f(first + std::size_t(begin), first + std::size_t(end));
        left = end == 64 ? 0 : left >> end << end;
      }
  }
  // Takes out the bits of the nodes that keep(node) does not want.
  template <class F>
  void keep(Bits* column, const Row& row, F&& keep) const {
    std::size_t first = row.first;
    for (std::size_t w = row.word; w < row.word + per_row_; ++w, first += 64)
      for (Bits left = column[w]; left != 0; left &= left - 1)
        if (!keep(first + std::size_t(std::countr_zero(left)))) column[w] &= ~(left & -left);
  }

  // Returns for each cell of a word what op makes of the bits of its eight nodes.
  template <class Op>
  Bits of_nodes(const Bits* column, const Row& row, std::size_t w, Op&& op) const {
    if (!row.begins_cells) return 0;
    const auto across = [&](std::size_t at) {
      return op(op(column[at], column[at + y_]), op(column[at + x_], column[at + x_ + y_]));
    };
    const Bits lower = across(w), next = w + 1 < row.word + per_row_ ? across(w + 1) : 0;
    return op(lower, lower >> 1 | next << 63);
  }
  // Returns for each node of a word whether one of the eight cells around it has its bit.
  Bits of_cells(const Bits* column, const Row& row, std::size_t w) const {
    const auto across = [&](std::size_t at) {
      const Bits* const own = column + at;
      return *own | *(own - y_) | *(own - x_) | *(own - x_ - y_);
    };
    const Bits upper = across(w), before = w > row.word ? across(w - 1) : 0;
    return upper | upper << 1 | before >> 63;
  }

  // Gives the cells behind mirrors the bits of their images.
  void mirror(const Faces& faces, Bits* column) const {
    for (int face = 0; face < 6; ++face) {
      if (!is_mirror(faces[face])) continue;
      const bool upper = face % 2;
      if (face < 4) {
        for_each_row_on(face, [&](Start on, Start inside, Start outside) {
          std::copy_n(column + (upper ? inside : on).word, per_row_, column + (upper ? on : outside).word);
        });
      } else {
        const FaceNode k = along_z(face);
        for_each_row([&](Start row) {
          const std::size_t behind = upper ? k.on : k.outside;
          Bits& word = column[row.word + behind / 64];
          word &= ~(Bits(1) << behind % 64);
          word |= get(column, row, upper ? k.inside : k.on) << behind % 64;
        });
      }
    }
  }
  // Calls f(face node) where has(its bits: on the face, inside, outside), a question for many at once.
  template <class Has, class F>
  void for_each_face_node(int face, const Bits* column, Has&& has, F&& f) const {
    if (face < 4)
      return for_each_row_on(face, [&](Start on, Start inside, Start outside) {
        for (std::size_t w = 0; w < per_row_; ++w) {
          Bits left = has(column[on.word + w], column[inside.word + w], column[outside.word + w]);
          for (; left != 0; left &= left - 1) {
            const std::size_t k = 64 * w + std::size_t(std::countr_zero(left));
            f(FaceNode{on.node + k, inside.node + k, outside.node + k});
          }
        }
      });
    const FaceNode k = along_z(face);
    for_each_row([&](Start row) {
      if (has(get(column, row, k.on), get(column, row, k.inside), get(column, row, k.outside)))
        f(FaceNode{row.node + k.on, row.node + k.inside, row.node + k.outside});
    });
  }

 private:
  // Where a row begins: its first node and word.
  struct Start {
    std::size_t node, word;
  };
  Start start(std::size_t field, int i, int j) const {
    const std::size_t first = field * grid_.node_count();
    return {first + grid_.index(i, j, 0), word(first, i, j)};
  }
  // Returns how many words of a column are of one velocity field.
  std::size_t of_a_field() const { return std::size_t(grid_.nodes(0)) * x_; }
  std::size_t word(std::size_t node, int i, int j) const {
    const std::size_t field = grid_.field_of(node) == 0 ? 0 : of_a_field();
    return field + std::size_t(i) * x_ + std::size_t(j) * y_;
  }
  static Bits get(const Bits* column, Start row, std::size_t k) {
    return column[row.word + k / 64] >> k % 64 & 1;
  }
  // Returns the k of the nodes on and beside a face across z.
  FaceNode along_z(int face) const { return face_node(grid_, face, 0, 0, 0); }
  template <class F>
  void for_each_row(F&& f) const {
    for (std::size_t field = 0; field < grid_.field_count; ++field)
      for (int i = 0; i < grid_.nodes(0); ++i)
        for (int j = 0; j < grid_.nodes(1); ++j) f(start(field, i, j));
  }
  // Calls f(on, inside, outside) for the rows on a face across x or y, and those beside them.
  template <class F>
  void for_each_row_on(int face, F&& f) const {
    const int axis = face / 2, plane = face % 2 ? grid_.pad + grid_.cells[axis] : grid_.pad;
    const int inward = face % 2 ? -1 : 1;
    for (std::size_t field = 0; field < grid_.field_count; ++field)
      for (int b = 0; b < grid_.nodes(1 - axis); ++b) {
        const auto at = [&](int a) { return axis == 0 ? start(field, a, b) : start(field, b, a); };
        f(at(plane), at(plane + inward), at(plane - inward));
      }
  }

  const GridGeometry<T>& grid_;
  std::size_t per_row_, y_, x_;
};

}  // namespace pockmark
