#include "read_symbols.hpp"

#include <cstddef>
#include <vector>

#include "grouping.hpp"

namespace sgi {

bool read_categorical(RangeDecoder &decoder, const Alphabets &alphabets, const int16_t *keys, int64_t n, int32_t *symbols,
                      double &bits) {
  const int64_t rows = alphabets.models->size();
  std::vector<int32_t> order(static_cast<std::size_t>(n)), indices(order.size());
  std::vector<int64_t> start(std::size_t(rows) + 1);
  group_by_key(keys, n, int(rows), order.data(), start.data());
  if (!decoder.decode(*alphabets.models, start.data(), rows, indices.data())) return false;
  bits += ungroup_categorical(indices.data(), order.data(), keys, n, alphabets.symbol, alphabets.bits, alphabets.size,
                              symbols);
  return true;
}

}  // namespace sgi
