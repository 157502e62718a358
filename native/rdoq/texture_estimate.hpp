// What symbols of texture cost about, coded one by one.
#pragma once
#include <algorithm>
#include <cstdint>

#include "base/scalar.hpp"

namespace sgi {

// log2 of a positive value, within 0.05.
inline float about_log2(float value) { return float(int32_t(bits_of(value))) * 0x1p-23f - 126.96f; }

// Squared error that is left plus lambda times bits, in squared steps.
class SymbolEstimate {
 public:
  explicit SymbolEstimate(float lambda) : least_(kLeft + lambda * kSymbolBits), growth_(lambda * kOctaveBits) {}

  // Of an amplitude whose square is this.
  float of(float square) const { return std::min(square, least_ + growth_ * std::max(about_log2(square), -2.0f)); }

 private:
  // The squared error of a symbol, its bits where the amplitude is a step, and their growth for each octave of the
  // squared amplitude (docs/notes/2026-11-encode-speed.md).
  static constexpr float kLeft = 0.05f, kSymbolBits = 2.7f, kOctaveBits = 0.68f;

  float least_, growth_;
};

}  // namespace sgi
