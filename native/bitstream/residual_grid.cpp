#include "bitstream/residual_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace sgi {

namespace {

int32_t nearest(const ResidualGrid &grid, float sample) {
  const double value = (double(sample) - grid.base) / grid.step + 0.5;
  return value > 0 ? value < grid.most ? int32_t(value) : grid.most : 0;
}

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

bool is_nodata(const Header &header, size_t channel, float sample) {
  return header.masked == Masked::nodata && int(channel) != header.alpha() && double(sample) == header.nodata;
}

}  // namespace

float sample_of(const ResidualGrid &grid, int32_t value) { return float(grid.base + grid.step * value); }

GridBlock on_grids(const Header &header, const ResidualForm &form, const float *drawn, int64_t width, size_t count) {
  const size_t channels = form.grids.size(), row = size_t(width) * channels;
  GridBlock found{std::vector<int32_t>(count), std::vector<uint8_t>(count)};
  for (size_t i = 0, c = 0; i < count; ++i, c = c + 1 < channels ? c + 1 : 0) {
    found.held[i] = !std::isfinite(drawn[i]) || is_nodata(header, c, drawn[i]);
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
    if (grid.max_error && is_nodata(header, c, sample_of(grid, value))) channels_[c].nodata = value;
  }
}

template <class Bits>
bool GridRest<Bits>::code(const GridBlock &drawn, const std::vector<int32_t> &values, const float *shown,
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
    if (value == channel.nodata && !code_side(channel, grid, samples[i], value)) return false;
    const float found = sample_of(grid, value);
    if (!form_.has_bits)
      samples[i] = found;
    else if (!code_bits(channel, found, samples[i]))
      return false;
  }
  return true;
}

template <class Bits>
bool GridRest<Bits>::code_side(const Channel &channel, const ResidualGrid &grid, float sample, int32_t &value) {
  int up = double(sample) > header_.nodata;
  if (channel.nodata == 0)
    up = 1;
  else if (channel.nodata == grid.most)
    up = 0;
  else if (!bits_.code(kEvenOdds, up))
    return false;
  value = std::min(grid.most, value + (up ? 1 : -1));
  return true;
}

template <class Bits>
bool GridRest<Bits>::code_bits(Channel &channel, float found, float &sample) {
  const int64_t far = rank_of(sample) - rank_of(found);
  int length = 0, negative = far < 0;
  while (std::llabs(far) >> length) ++length;
  int known = 0;
  for (; known < kLengths - 1; ++known) {
    BitModel &model = channel.lengths[size_t(channel.length * kLengths + known)];
    int more = known < length;
    if (!code_bit(bits_, model, kSteady, more)) return false;
    if (!more) break;
  }
  channel.length = known;
  if (known && !bits_.code(kEvenOdds, negative)) return false;
  int64_t distance = known > 0;
  for (int place = known - 2; place >= 0; --place) {
    int next = int(std::llabs(far) >> place & 1);
    if (!bits_.code(kEvenOdds, next)) return false;
    distance = distance * 2 + next;
  }
  const int64_t rank = rank_of(found) + (negative ? -distance : distance);
  if (rank > INT32_MAX || rank < INT32_MIN) return false;
  sample = of_rank(rank);
  return true;
}

template class GridRest<BitRecorder>;
template class GridRest<BitReader>;

}  // namespace sgi
