// Arrays between Python and the core.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <stdexcept>
#include <vector>

namespace pockmark::bind {

namespace nb = nanobind;
using namespace nb::literals;

using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class V>
using NumPy = nb::ndarray<nb::numpy, V>;

template <class V>
NumPy<V> to_array(std::vector<V> values, std::size_t dimensions, const std::size_t* shape) {
  auto* owned = new std::vector<V>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<V>*>(p); });
  return NumPy<V>(owned->data(), dimensions, shape, owner);
}
// Returns an array of rows, or of numbers where a row is one.
template <class V>
NumPy<V> to_array(std::vector<V> values, std::size_t rows, std::size_t columns) {
  const std::size_t shape[2] = {rows, columns};
  return to_array(std::move(values), columns == 1 ? 1 : 2, shape);
}

// Calls f(row in, row out) for each row, and returns the rows out.
template <int in, int out, class F>
NumPy<double> by_rows(Rows rows, F&& f) {
  if (rows.shape(1) != in) throw std::invalid_argument("rows: not as many columns as are needed");
  std::vector<double> values(out * rows.shape(0));
  for (std::size_t i = 0; i < rows.shape(0); ++i) f(rows.data() + in * i, values.data() + out * i);
  const std::size_t shape[2] = {rows.shape(0), out};
  return to_array(std::move(values), 2, shape);
}

}  // namespace pockmark::bind
