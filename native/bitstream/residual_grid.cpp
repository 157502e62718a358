#include "bitstream/residual_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace sgi {

namespace {

// Numbers floats in the order of their size, one by one.
int64_t rank_of(float sample) {
  int32_t bits;
  std::memcpy(&bits, &sample, sizeof bits);
  return bits >= 0 ? bits : -int64_t(bits & 0x7fffffff) - 1;
}

float of_rank(int64_t rank) {
  const uint32_t bits = rank >= 0 ? uint32_t(rank) : uint32_t(-rank - 1) | 0x80000000u;
  float sample;
  std::memcpy(&sample, &bits, sizeof sample);
  return sample;
}

int32_t nearest(const ResidualGrid &grid, float sample) {
  const std::vector<float> &table = grid.table;
  if (table.empty()) {
    const double value = (double(sample) - grid.base) / grid.step + 0.5;
    return value > 0 ? value < grid.most ? int32_t(value) : grid.most : 0;
  }
  const auto is_less = [](float a, float b) { return rank_of(a) < rank_of(b); };
  const auto value = int32_t(std::lower_bound(table.begin(), table.end(), sample, is_less) - table.begin());
  if (value == 0 || value > grid.most) return value ? grid.most : 0;
  if (rank_of(table[size_t(value)]) == rank_of(sample)) return value;
  return double(sample) - table[size_t(value - 1)] <= table[size_t(value)] - double(sample) ? value - 1 : value;
}

bool is_nodata(const Header &header, int channel, float sample) {
  return header.masked == Masked::nodata && channel != header.alpha() && double(sample) == header.nodata;
}

// Codes which samples of a grid occur.
template <class Bits>
void code_whole_numbers(Bits &bits, ResidualGrid &grid) {
  const std::vector<float> given = std::move(grid.table);
  std::array<BitModel, 64> models;  // by the places since the last that occurs
  size_t since = 0, next = 0;
  grid.table.clear();
  for (int32_t place = 0; place <= grid.most; ++place) {
    const auto sample = float(grid.base + grid.step * place);
    int occurs = next < given.size() && given[next] == sample;
    code_bit(bits, models[since], kSteady, occurs);
    if (occurs) grid.table.push_back(sample), ++next;
    since = occurs ? 0 : std::min(since + 1, models.size() - 1);
  }
  grid.most = int32_t(grid.table.size()) - 1;
  if (grid.most < 0) refuse_payload();
}

// Codes each float by those before, as if all were as far apart.
template <class Bits>
void code_floats(Bits &bits, ResidualGrid &grid) {
  FloatDistances distances;
  grid.table.resize(size_t(grid.most) + 1);
  double last = grid.base, step = 0;
  for (float &sample : grid.table) {
    distances.code(bits, float(last + step), sample);
    const bool is_first = &sample == grid.table.data();
    if (!std::isfinite(sample) || (!is_first && rank_of(sample) <= rank_of(float(last)))) refuse_payload();
    step = is_first ? grid.step : sample - last, last = sample;
  }
}

}  // namespace

float sample_of(const ResidualGrid &grid, int32_t value) {
  return grid.table.empty() ? float(grid.base + grid.step * value) : grid.table[size_t(value)];
}

template <class Bits>
void code_table(Bits &bits, bool is_float, ResidualGrid &grid) {
  if (is_float)
    code_floats(bits, grid);
  else
    code_whole_numbers(bits, grid);
}

GridBlock on_grids(const Header &header, const ResidualForm &form, const float *drawn, int64_t width, size_t count) {
  const size_t channels = form.grids.size(), row = size_t(width) * channels;
  GridBlock found{std::vector<int32_t>(count), std::vector<uint8_t>(count)};
  for (size_t i = 0, c = 0; i < count; ++i, c = c + 1 < channels ? c + 1 : 0) {
    found.held[i] = !std::isfinite(drawn[i]) || is_nodata(header, form.channels[c], drawn[i]);
    if (!found.held[i])
      found.values[i] = nearest(form.grids[c], drawn[i]);
    else if (i % row >= channels)
      found.values[i] = found.values[i - channels];
    else if (i >= row)
      found.values[i] = found.values[i - row];
  }
  return found;
}

std::vector<int32_t> nearest_values(const ResidualForm &form, const float *samples, size_t count) {
  std::vector<int32_t> found(count);
  for (size_t i = 0; i < count; ++i) found[i] = nearest(form.grids[i % form.grids.size()], samples[i]);
  return found;
}

template <class Bits>
GridRest<Bits>::GridRest(const Header &header, const ResidualForm &form, Bits &bits)
    : header_(header), form_(form), bits_(bits), channels_(form.grids.size()) {
  for (size_t c = 0; c < channels_.size(); ++c) {
    const ResidualGrid &grid = form.grids[c];
    const int32_t value = nearest(grid, float(header.nodata));
    if (grid.max_error && is_nodata(header, form.channels[c], sample_of(grid, value))) channels_[c].nodata = value;
  }
}

template <class Bits>
void GridRest<Bits>::code(const GridBlock &drawn, const std::vector<int32_t> &values, const float *shown,
                          float *samples) {
  const size_t channels = channels_.size();
  for (size_t i = 0, c = 0; i < values.size(); ++i, c = c + 1 < channels ? c + 1 : 0) {
    Channel &channel = channels_[c];
    const ResidualGrid &grid = form_.grids[c];
    int32_t value = values[i];
    if (drawn.held[i]) {
      samples[i] = shown[i];
      continue;
    }
    if (value == channel.nodata) value = beside_nodata(channel, grid, samples[i]);
    const float found = sample_of(grid, value);
    if (!form_.has_bits)
      samples[i] = found;
    else
      channel.distances.code(bits_, found, samples[i]);
  }
}

template <class Bits>
int32_t GridRest<Bits>::beside_nodata(const Channel &channel, const ResidualGrid &grid, float sample) {
  int up = double(sample) > header_.nodata;
  if (channel.nodata == 0)
    up = 1;
  else if (channel.nodata == grid.most)
    up = 0;
  else
    bits_.code(kEvenOdds, up);
  return std::min(grid.most, channel.nodata + (up ? 1 : -1));
}

template <class Bits>
void FloatDistances::code(Bits &bits, float found, float &sample) {
  const int64_t far = rank_of(sample) - rank_of(found);
  int length = 0, negative = far < 0;
  while (std::llabs(far) >> length) ++length;
  int known = 0;
  for (; known < kLengths - 1; ++known) {
    int more = known < length;
    code_bit(bits, lengths_[size_t(length_ * kLengths + known)], kSteady, more);
    if (!more) break;
  }
  length_ = known;
  if (known) bits.code(kEvenOdds, negative);
  int64_t distance = known > 0;
  for (int place = known - 2; place >= 0; --place) {
    int next = int(std::llabs(far) >> place & 1);
    bits.code(kEvenOdds, next);
    distance = distance * 2 + next;
  }
  const int64_t rank = rank_of(found) + (negative ? -distance : distance);
  if (rank > INT32_MAX || rank < INT32_MIN) refuse_payload();
  sample = of_rank(rank);
}

template void code_table(RangeEncoder &bits, bool is_float, ResidualGrid &grid);
template void code_table(RangeDecoder &bits, bool is_float, ResidualGrid &grid);
template class GridRest<RangeEncoder>;
template class GridRest<RangeDecoder>;

}  // namespace sgi
