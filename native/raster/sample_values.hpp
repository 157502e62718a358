// From values to samples, of numbers or vectors of them. On a GPU, too.
#pragma once

namespace sgi {
namespace {

template <class Row>
inline Row clipped(Row value, float most) {
  value = value > 0.0f ? value : Row{};  // also not-a-number
  return value < most ? value : Row{} + most;
}

// The nearest integer of 0 ... most, ties to even.
template <class Row>
inline Row rounded(Row value, float most) {
  constexpr float kMagic = 12582912.0f;  // 1.5 * 2^23: adding it leaves no fraction
  return clipped((value + kMagic) - kMagic, most);
}

// The sample that stands for a value.
template <class Row>
inline Row mapped(Row value, float low, float span) {
  return clipped(value, 1.0f) * span + low;
}

}  // namespace
}  // namespace sgi
