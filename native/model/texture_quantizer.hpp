// Which of two quantisers a symbol of texture is of (docs/format.md, "Values of texture").
#pragma once
#include <array>
#include <cstdint>
#include <cstdlib>

namespace sgi {

constexpr int kQuantizerStates = 8;  // four gain less (docs/notes/2026-11-luma-space.md)

// The state of a block before a symbol: a function of the parities of the symbols before it, 0 before the first. The
// even quantiser has the multiples of a step, the odd one 0 and the odd multiples of half a step.
class QuantizerState {
 public:
  QuantizerState() = default;
  explicit QuantizerState(int index) : index_(uint8_t(index)) {}

  int index() const { return index_; }
  bool odd() const { return index_ & 1; }
  QuantizerState after(int symbol) const { return QuantizerState(kNext[index_][symbol & 1]); }
  // What a symbol that is not 0 stands for, in steps.
  float magnitude(int symbol) const { return float(std::abs(symbol)) - (odd() ? 0.5f : 0.0f); }

 private:
  // Ungerboeck's trellis of eight states, as in JPEG 2000, part 2.
  static constexpr std::array<std::array<uint8_t, 2>, kQuantizerStates> kNext{
      {{0, 1}, {3, 2}, {5, 4}, {6, 7}, {1, 0}, {2, 3}, {4, 5}, {7, 6}}};

  uint8_t index_ = 0;
};

}  // namespace sgi
