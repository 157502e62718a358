#include "bitstream/alphabets.hpp"

namespace sgi {
namespace {

SymbolModels models_of(const std::vector<int64_t> &frequencies, int64_t size) {
  std::vector<int64_t> start;
  for (int64_t at = 0; at <= int64_t(frequencies.size()); at += size) start.push_back(at);
  return {frequencies.data(), start.data(), int64_t(start.size()) - 1};
}

}  // namespace

Alphabets::Alphabets(const std::vector<int64_t> &frequencies, int64_t size)
    : size_(size), models_(models_of(frequencies, size)), symbol_(frequencies.size()) {
  for (size_t row = 0; row < frequencies.size(); row += size_t(size)) {
    size_t next = row;  // those that can occur come first
    for (const bool possible : {true, false})
      for (size_t s = row; s < row + size_t(size); ++s)
        if ((frequencies[s] > 0) == possible) symbol_[next++] = int32_t(s - row);
  }
}

}  // namespace sgi
