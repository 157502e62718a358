// What the Python bindings of every part share: arrays as arguments, and what is required of them.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sgi {

// An array of numpy or torch in main memory, D dimensions, contiguous; `const T` where it is only read.
template <class T, int D>
using Array = nanobind::ndarray<T, nanobind::ndim<D>, nanobind::c_contig, nanobind::device::cpu>;

// Raises ValueError in Python.
inline void require(bool ok, const char *what) {
  if (!ok) throw std::invalid_argument(what);
}

template <class A>
bool has_shape(const A &array, size_t rows, size_t columns) {
  return array.shape(0) == rows && array.shape(1) == columns;
}

// A numpy array that owns what it holds; Shown is T or what numpy calls it.
template <class T, class Shown = T, size_t D>
auto as_array(std::vector<T> values, const std::array<size_t, D> &shape) {
  auto *owned = new std::vector<T>(std::move(values));
  nanobind::capsule owner(owned, [](void *held) noexcept { delete static_cast<std::vector<T> *>(held); });
  return nanobind::ndarray<nanobind::numpy, Shown, nanobind::ndim<D>>(reinterpret_cast<Shown *>(owned->data()), D,
                                                                      shape.data(), owner);
}
// The same of values that no vector holds.
template <class T, size_t D>
auto values_as_array(std::unique_ptr<T[]> values, const std::array<size_t, D> &shape) {
  T *owned = values.release();
  nanobind::capsule owner(owned, [](void *held) noexcept { delete[] static_cast<T *>(held); });
  return nanobind::ndarray<nanobind::numpy, T, nanobind::ndim<D>>(owned, D, shape.data(), owner);
}

}  // namespace sgi
