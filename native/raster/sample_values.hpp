// From values to samples, of numbers or vectors of them. On a GPU, too.
#pragma once

namespace sgi {
namespace {

template <class Row>
inline Row clipped(Row value, float most) {
  value = value > 0.0f ? value : Row{};  // also not-a-number
  return value < most ? value : Row{} + most;
}

// The nearest integer, ties to even, of a value up to 2^22 either way.
template <class Row>
inline Row rounded(Row value) {
  constexpr float kMagic = 12582912.0f;  // 1.5 * 2^23: adding it leaves no fraction
  return (value + kMagic) - kMagic;
}

template <class T>
constexpr bool kIsFloat = T(0.5f) != 0;

// The sample that stands for a value.
template <class Row>
inline Row mapped(Row value, float low, float span) {
  return clipped(value, 1.0f) * span + low;
}

// It in type T: rounded to the range of an integer, as it is for a float.
template <class T>
inline T stored(float sample) {
  return T(kIsFloat<T> ? sample : rounded(clipped(sample, float(T(-1)))));
}

}  // namespace
}  // namespace sgi
