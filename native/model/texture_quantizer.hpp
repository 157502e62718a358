// Which of two quantisers a symbol of texture is of (docs/format.md, "Values of texture").
#pragma once
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
  QuantizerState after(int symbol) const { return QuantizerState(int(kNext >> (8 * index_ + 4 * (symbol & 1)) & 7)); }
  // What a symbol that is not 0 stands for, in steps.
  float magnitude(int symbol) const { return float(std::abs(symbol)) - (odd() ? 0.5f : 0.0f); }

 private:
  // Ungerboeck's trellis of eight states, as in JPEG 2000, part 2: by state and parity, packed in a word, since a shift
  // is faster than a look at memory.
  static constexpr uint64_t kNext = [] {
    constexpr uint8_t kStates[][2] = {{0, 1}, {3, 2}, {5, 4}, {6, 7}, {1, 0}, {2, 3}, {4, 5}, {7, 6}};
    uint64_t packed = 0;
    for (int i = 0; i < 2 * kQuantizerStates; ++i) packed |= uint64_t(kStates[i / 2][i % 2]) << 4 * i;
    return packed;
  }();

  uint8_t index_ = 0;
};

}  // namespace sgi
