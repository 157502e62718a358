// Small alphabets with stated frequencies: what categorical symbols are read under.
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/read_symbols.hpp"

namespace sgi {

constexpr int64_t kTotalFrequency = int64_t(1) << 24;

class Alphabets {
 public:
  // frequencies [rows, size]: each row sums to 2^24; a symbol of frequency 0 cannot occur.
  Alphabets(const std::vector<int64_t> &frequencies, int64_t size);

  AlphabetsView view() const { return {&models_, symbol_.data(), size_}; }

 private:
  int64_t size_;
  SymbolModels models_;
  std::vector<int32_t> symbol_;
};

}  // namespace sgi
