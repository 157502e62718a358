#include "bitstream/frequency_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "bitstream/shipped.hpp"

namespace sgi {
namespace {

constexpr int kEscapeExponents = 21;
constexpr int kPrecision = 24;

uint32_t little_endian(const uint8_t *bytes, int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) value |= uint32_t(bytes[i]) << (8 * i);
  return value;
}

// Exponent e behind an escape has 2^-(e + 1); the last one is as likely as the last but one.
SymbolModels escape_models() {
  std::vector<int64_t> frequencies(kEscapeExponents);
  for (int e = 0; e < kEscapeExponents; ++e)
    frequencies[size_t(e)] = (int64_t(1) << kPrecision) >> std::min(e + 1, kEscapeExponents - 1);
  const int64_t start[2] = {0, kEscapeExponents};
  return {frequencies.data(), start, 1};
}

FrequencyTables read_tables() {
  const Bytes file = shipped_tables();
  std::vector<int32_t> supports;
  std::vector<int64_t> frequency, start{0};
  const uint8_t *half = file.data + 2 * kTables;  // f(0), f(1), ..., f(S), f(escape) of each table
  for (int table = 0; table < kTables; ++table) {
    const auto support = int32_t(little_endian(file.data + 2 * table, 2));
    supports.push_back(support);
    for (int32_t n = -support; n <= support + 1; ++n) frequency.push_back(little_endian(half + 4 * std::abs(n), 4));
    start.push_back(int64_t(frequency.size()));
    half += 4 * (support + 2);
  }
  return {std::move(supports), {frequency.data(), start.data(), kTables}, escape_models()};
}

SymbolCosts costs_of(const SymbolModels &models) {
  SymbolCosts costs;
  for (int table = 0; table < kTables; ++table) {
    const uint32_t *const sums = models.sums(table);
    std::vector<double> bits;
    for (int64_t i = 0; i < models.symbols(table); ++i)
      bits.push_back(kPrecision - std::log2(double(sums[i + 1] - sums[i])));
    costs.known.push_back(std::move(bits));
  }
  return costs;
}

}  // namespace

double SymbolCosts::bits(int64_t symbol, int table) const {
  const std::vector<double> &costs = known[size_t(table)];
  const auto within = int64_t(costs.size()) / 2 - 1;  // from -within to within, and the escape
  const int64_t beyond = std::abs(symbol) - within;
  if (beyond <= 0) return costs[size_t(within + symbol)];
  const int exponent = 63 - __builtin_clzll(static_cast<unsigned long long>(beyond));
  return costs.back() + std::min(exponent + 1, kEscapeExponents - 1) + exponent + 1;
}

int SymbolCosts::best(const std::vector<int32_t> &symbols) const {
  std::map<int32_t, double> counts;
  for (const int32_t symbol : symbols) ++counts[symbol];
  std::array<double, kTables> cost{};
  for (int table = 0; table < kTables; ++table)
    for (const auto &[symbol, count] : counts) cost[size_t(table)] += count * bits(symbol, table);
  return int(std::min_element(cost.begin(), cost.end()) - cost.begin());
}

const FrequencyTables &frequency_tables() {
  static const FrequencyTables tables = read_tables();
  return tables;
}

const SymbolCosts &symbol_costs() {
  static const SymbolCosts costs = costs_of(frequency_tables().models);
  return costs;
}

}  // namespace sgi
