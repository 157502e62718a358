// What the Python bindings of every part share: arrays as arguments, and what is required of them.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

// An array of numpy or torch in main memory, D dimensions, contiguous; `const T` where it is only read.
template <class T, int D>
using Array = nanobind::ndarray<T, nanobind::ndim<D>, nanobind::c_contig, nanobind::device::cpu>;

// Raises ValueError in Python.
inline void require(bool ok, const char *what) {
  if (!ok) throw std::invalid_argument(what);
}

// What an argument holds, as long as it lives.
inline Bytes bytes_of(const nanobind::bytes &given) {
  return {static_cast<const uint8_t *>(given.data()), given.size()};
}

inline nanobind::bytes as_bytes(const std::vector<uint8_t> &bytes) {
  return nanobind::bytes(bytes.data(), bytes.size());
}

template <class A>
bool has_shape(const A &array, size_t rows, size_t columns) {
  return array.shape(0) == rows && array.shape(1) == columns;
}

// A numpy array of what begins at `first` and lives in `values`, a container whose values stay where they are when it
// is moved; Shown is T or what numpy calls it.
template <class Shown, class T, class Values, size_t D>
auto array_in(Values values, T *first, const std::array<size_t, D> &shape) {
  auto *owned = new Values(std::move(values));
  nanobind::capsule owner(owned, [](void *held) noexcept { delete static_cast<Values *>(held); });
  return nanobind::ndarray<nanobind::numpy, Shown, nanobind::ndim<D>>(reinterpret_cast<Shown *>(first), D, shape.data(),
                                                                      owner);
}

// A numpy array that owns what it holds.
template <class T, class Shown = T, size_t D>
auto as_array(std::vector<T> values, const std::array<size_t, D> &shape) {
  T *first = values.data();
  return array_in<Shown>(std::move(values), first, shape);
}
template <class T>
auto as_array(std::vector<T> values) {
  const std::array shape{values.size()};
  return as_array(std::move(values), shape);
}

}  // namespace sgi
