#include "decoder/exact_blocks.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "base/thread_pool.hpp"

namespace sgi {

namespace {

ResidualTable table_of(StreamReader &chunks) {
  const Header &header = chunks.header();
  const auto read = [&](bool has_tables) {
    const auto start = chunks.residual(0, longest_residual_table(header, has_tables));
    return read_residual_table(header, {start.data(), start.size()}, chunks.residual_bytes());
  };
  try {
    return read(false);
  } catch (const Error &error) {
    if (longest_residual_table(header, false) >= chunks.residual_bytes()) throw;
  }
  return read(true);
}

}  // namespace

ExactBlocks::ExactBlocks(StreamReader &chunks, const DecoderSettings &settings)
    : chunks_(chunks), settings_(settings), across_(residual_blocks(chunks.header().width)), table_(table_of(chunks)) {}

void ExactBlocks::fill(int64_t x, int64_t y, const PixelBlock &out, SampleType type, const Draw &draw) {
  const int64_t last_row = (y + out.rows - 1) / kResidualBlock, last = (x + out.columns - 1) / kResidualBlock;
  for (int64_t row = y / kResidualBlock; row <= last_row; ++row) {
    std::vector<int64_t> missing;
    ++uses_;
    for (int64_t column = x / kResidualBlock; column <= last; ++column) {
      const auto found = blocks_.find(row * across_ + column);
      if (found == blocks_.end())
        missing.push_back(row * across_ + column);
      else
        found->second.use = uses_;
    }
    decode(missing, draw);
    for (int64_t column = x / kResidualBlock; column <= last; ++column) copy(row * across_ + column, x, y, out, type);
    forget();
  }
}

const std::vector<uint8_t> &ExactBlocks::cells(int64_t x, int64_t y, const Draw &draw) {
  const int64_t wanted = number(x, y);
  ++uses_;
  if (!blocks_.count(wanted)) decode({wanted}, draw);
  Kept &kept = blocks_.at(wanted);
  kept.use = uses_;
  forget();
  return kept.found.cells;
}

ExactBlocks::Place ExactBlocks::place(int64_t number) const {
  const int64_t x = number % across_ * kResidualBlock, y = number / across_ * kResidualBlock;
  const Header &header = chunks_.header();
  return {x, y, std::min(kResidualBlock, header.width - x), std::min(kResidualBlock, header.height - y)};
}

void ExactBlocks::decode(const std::vector<int64_t> &numbers, const Draw &draw) {
  const auto at_once = size_t(resolve_threads(settings_.threads));
  for (size_t first = 0; first < numbers.size(); first += at_once) {
    const size_t count = std::min(at_once, numbers.size() - first);
    std::vector<std::vector<float>> shown(count);
    std::vector<ResidualSamples> found(count);
    std::vector<std::vector<uint8_t>> bytes(count);
    for (size_t i = 0; i < count; ++i) {
      const ResidualTable::Block &block = table_.blocks[size_t(numbers[first + i])];
      bytes[i] = chunks_.residual(block.offset, block.bytes);
      shown[i] = drawn(place(numbers[first + i]), draw);
    }
    parallel_for(int64_t(count), settings_.threads, [&](int64_t i) {
      const int64_t number = numbers[first + size_t(i)];
      const Place where = place(number);
      const std::vector<uint8_t> &given = bytes[size_t(i)];
      const ResidualBlock block{chunks_.header(), table_.form, where.width, where.height, shown[size_t(i)].data()};
      found[size_t(i)] =
          decode_residual(block, settings_.isa, {given.data(), given.size()}, table_.blocks[size_t(number)].crc);
    });
    for (size_t i = 0; i < count; ++i) {
      bytes_ += int64_t(found[i].samples.size() * sizeof(float));
      blocks_[numbers[first + i]] = {std::move(found[i]), uses_};
    }
  }
}

std::vector<float> ExactBlocks::drawn(const Place &place, const Draw &draw) const {
  const std::vector<int> &coded = channels();
  std::vector<float> samples(size_t(place.height * place.width) * coded.size());
  if (is_alpha()) return samples;
  const int64_t count = chunks_.header().spec.channels, stride = place.width * count;
  with_sample(chunks_.header().sample_type, [&](auto sample) {
    std::vector<decltype(sample)> found(size_t(place.height * stride));
    draw(place, {found.data(), place.width, place.height, stride});
    float *to = samples.data();
    for (const auto *pixel = found.data(); to < samples.data() + samples.size(); pixel += count)
      for (const int channel : coded) *to++ = float(pixel[channel]);
  });
  return samples;
}

void ExactBlocks::copy(int64_t number, int64_t x, int64_t y, const PixelBlock &out, SampleType type) const {
  const Place from = place(number);
  const int64_t left = std::max(x, from.x), right = std::min(x + out.columns, from.x + from.width);
  const int64_t top = std::max(y, from.y), bottom = std::min(y + out.rows, from.y + from.height);
  const std::vector<int> &coded = channels();
  const int64_t count = chunks_.header().spec.channels, known = int64_t(coded.size());
  const float *samples = blocks_.at(number).found.samples.data();
  for (int64_t row = top; row < bottom; ++row) {
    const float *source = samples + ((row - from.y) * from.width + left - from.x) * known;
    const int64_t target = (row - y) * out.stride + (left - x) * count;
    with_sample(type, [&](auto sample) {
      auto *first = static_cast<decltype(sample) *>(out.first) + target;
      for (int64_t i = 0; i < right - left; ++i)
        for (int64_t c = 0; c < known; ++c)
          first[i * count + coded[size_t(c)]] = decltype(sample)(source[i * known + c]);
    });
  }
}

void ExactBlocks::forget() {
  while (bytes_ > settings_.cache_bytes) {
    const auto oldest = std::min_element(blocks_.begin(), blocks_.end(),
                                         [](const auto &a, const auto &b) { return a.second.use < b.second.use; });
    if (oldest == blocks_.end() || oldest->second.use == uses_) return;
    bytes_ -= int64_t(oldest->second.found.samples.size() * sizeof(float));
    blocks_.erase(oldest);
  }
}

}  // namespace sgi
