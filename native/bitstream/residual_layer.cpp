#include "bitstream/residual_layer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <type_traits>

#include "base/crc32.hpp"
#include "base/error.hpp"
#include "bitstream/range_coder.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

namespace {

constexpr size_t kCrcBytes = 4;
constexpr int64_t kMaxTableBytes = 1 << 19;  // of a channel
constexpr int64_t kHasBits = 1, kHasViews = 2, kHasPalette = 4, kHasCells = 8, kIsAlpha = 16, kHasBands = 32;

[[noreturn]] void corrupt(const char *text) { throw Error(Fault::corrupt, std::string("residual layer: ") + text); }

// What decodes, with `text` where the payload does not.
template <class Decode>
void decoded(const char *text, const Decode &decode) {
  try {
    decode();
  } catch (const Error &) {
    corrupt(text);
  }
}

int64_t count_of(const Header &header) { return residual_blocks(header.width) * residual_blocks(header.height); }

double read_real(Bytes data, size_t &at) {
  double value;
  if (data.size - at < sizeof value) corrupt("it ends too early");
  std::memcpy(&value, data.data + at, sizeof value);
  at += sizeof value;
  return value;
}

// Whether samples of a type are on the grid, which none but floats may fill with other than whole numbers.
bool is_sound(const ResidualGrid &grid, SampleType type) {
  const double last = grid.base + grid.step * grid.most;
  if (!(grid.step > 0) || grid.max_error > grid.most) return false;
  if (type == SampleType::f32) return std::isfinite(float(grid.base)) && std::isfinite(float(last));
  return last <= largest_of(type);
}

// The channels that a layer says it has, of so many.
std::vector<int> read_channels(Bytes start, size_t &at, int count) {
  std::vector<int> found;
  for (int channel = 0; channel < count; ++channel) {
    const int64_t is_coded = decode_varint(start, at);
    if (is_coded > 1) corrupt("it does not say which channels it has");
    if (is_coded) found.push_back(channel);
  }
  if (found.empty() || int(found.size()) == count) corrupt("it says that it has all channels, or none");
  return found;
}

ResidualGrid read_grid(Bytes start, size_t &at, SampleType type) {
  const auto number = [&] { return type == SampleType::f32 ? read_real(start, at) : double(decode_varint(start, at)); };
  ResidualGrid grid{};
  grid.base = number(), grid.step = number();
  const int64_t most = decode_varint(start, at), max_error = decode_varint(start, at);
  grid.most = int32_t(std::min<int64_t>(most, kMaxGridSteps)), grid.max_error = int32_t(std::min(max_error, most));
  if (most > kMaxGridSteps || max_error > most || !is_sound(grid, type)) corrupt("a channel has no sound grid");
  const int64_t bytes = decode_varint(start, at);
  if (!bytes) return grid;
  if (bytes > kMaxTableBytes || grid.max_error || grid.most > kMaxTableSteps) corrupt("a grid may not have this table");
  if (int64_t(start.size - at) < bytes) corrupt("it ends too early");
  RangeDecoder decoder(start.data + at, bytes);
  decoded("the table of a grid does not decode", [&] {
    code_table(decoder, type == SampleType::f32, grid);
    if (!decoder.maybe_exhausted()) refuse_payload();
  });
  at += size_t(bytes);
  return grid;
}

void read_palette(Bytes start, size_t &at, ResidualForm &form) {
  const int64_t count = decode_varint(start, at);
  if (!count || count > kMaxPalette || form.has_bits) corrupt("its palette has no sound size");
  for (int64_t i = 0; i < count; ++i)
    for (const ResidualGrid &grid : form.grids) {
      const int64_t value = decode_varint(start, at);
      if (value > grid.most || grid.max_error) corrupt("a colour of its palette is not on the grids");
      form.palette.push_back(int32_t(value));
    }
}

// Codes which cells are coded: a bit each, by those to the left, above and right above.
template <class Bits>
void code_cells(const ResidualBlock &block, Bits &bits, std::vector<uint8_t> &cells) {
  const auto across = size_t(block.cells_across());
  std::array<BitModel, 8> models;
  for (size_t i = 0; i < cells.size(); ++i) {
    const size_t x = i % across;
    const bool left = x && cells[i - 1], above = i >= across && cells[i - across];
    const bool above_right = i >= across && x + 1 < across && cells[i - across + 1];
    int bit = cells[i];
    code_bit(bits, models[size_t(left + 2 * above + 4 * above_right)], kQuick, bit);
    cells[i] = uint8_t(bit);
  }
}

// Holds what is in no coded cell.
void hold_others(const ResidualBlock &block, const std::vector<uint8_t> &cells, size_t channels, GridBlock &drawn) {
  if (!block.form.has_cells) return;
  for (int64_t y = 0, at = 0; y < block.height; ++y)
    for (int64_t x = 0; x < block.width; ++x, at += int64_t(channels))
      if (!cells[size_t(y / kResidualCell * block.cells_across() + x / kResidualCell)])
        std::fill_n(&drawn.held[size_t(at)], channels, uint8_t(1));
}

// Codes which colour of the palette each pixel has; what is drawn says nothing of that.
template <class Bits>
void code_colours(const ResidualBlock &block, Isa isa, Bits &bits, ResidualSamples &known) {
  float *samples = known.samples.data();
  const ResidualForm &form = block.form;
  const size_t channels = form.grids.size(), pixels = block.samples() / channels;
  const std::vector<int32_t> given = nearest_values(form, samples, block.samples());
  std::map<std::vector<int32_t>, int32_t> numbers;
  for (int32_t i = 0; i < form.colours(); ++i)
    numbers[{&form.palette[size_t(i) * channels], &form.palette[size_t(i) * channels] + channels}] = i;
  std::vector<int32_t> colours(pixels), pixel(channels);
  for (size_t i = 0; i < pixels; ++i) {
    const int32_t *values = &given[i * channels];
    if (i && std::equal(values, values + channels, values - channels)) {
      colours[i] = colours[i - 1];
      continue;
    }
    pixel.assign(values, values + channels);
    const auto found = numbers.find(pixel);
    colours[i] = found == numbers.end() ? 0 : found->second;
  }
  const std::vector<ResidualGrid> grids{{0, 1, form.colours() - 1, 0, {}}};
  const ResidualShape shape{block.width, block.height, false, grids};
  GridBlock drawn{std::vector<int32_t>(pixels), std::vector<uint8_t>(pixels)};
  hold_others(block, known.cells, 1, drawn);
  ResidualCoding<Bits>(shape, kernel_for<PredictorKernel>(isa), bits).code(colours, drawn);
  for (size_t i = 0; i < pixels; ++i)
    for (size_t c = 0; c < channels; ++c)
      samples[i * channels + c] = drawn.held[i]
                                      ? block.drawn[i * channels + c]
                                      : sample_of(form.grids[c], form.palette[size_t(colours[i]) * channels + c]);
}

template <class Bits>
void code_block(const ResidualBlock &block, Isa isa, Bits &bits, ResidualSamples &given) {
  if (block.form.has_cells) code_cells(block, bits, given.cells);
  if (block.form.colours()) return code_colours(block, isa, bits, given);
  float *samples = given.samples.data();
  const ChannelLayout layout = block.header.channels;
  const bool has_all = int(block.form.channels.size()) == block.header.spec.channels;
  const bool is_rgb = has_all && (layout == ChannelLayout::rgb || layout == ChannelLayout::rgba);
  const ResidualShape shape{block.width, block.height, is_rgb, block.form.grids};
  GridBlock drawn = on_grids(block.header, block.form, block.drawn, block.width, block.samples());
  hold_others(block, given.cells, block.form.grids.size(), drawn);
  // A reader finds all values, whatever they are before.
  std::vector<int32_t> values =
      std::is_same_v<Bits, RangeDecoder> ? drawn.values : nearest_values(block.form, samples, block.samples());
  ResidualCoding<Bits>(shape, kernel_for<PredictorKernel>(isa), bits).code(values, drawn);
  GridRest<Bits>(block.header, block.form, bits).code(drawn, values, block.drawn, samples);
}

}  // namespace

int64_t longest_residual_table(const Header &header, bool has_tables) {
  const int64_t palette = kMaxVarintBytes + int64_t(kMaxPalette) * header.spec.channels * kMaxVarintBytes;
  const int64_t grids =
      header.spec.channels * int64_t(2 * sizeof(double) + 3 * kMaxVarintBytes + (has_tables ? kMaxTableBytes : 0));
  return sizeof(double) + 1 + grids + palette + count_of(header) * int64_t(kMaxVarintBytes + kCrcBytes);
}

ResidualForm read_residual_form(const Header &header, Bytes start, size_t &at) {
  ResidualForm form{read_real(start, at), false, false, false, false, {}, {}, {}};
  if (!(form.max_error >= 0) || std::isinf(form.max_error)) corrupt("its greatest error is no number from 0 on");
  const int64_t flags = decode_varint(start, at);
  form.has_bits = flags & kHasBits, form.has_views = flags & kHasViews, form.has_cells = flags & kHasCells;
  form.is_alpha = flags == kIsAlpha;
  const int64_t others = kHasViews | kHasPalette | (flags & kHasBands ? kHasBands : kHasCells);
  const bool has_all = header.masked != Masked::nodata && !header.has_exact;
  if (((flags & ~(kHasBits | others)) && !form.is_alpha) ||
      (form.is_alpha && (!has_all || header.alpha() < 0 || header.sample_type == SampleType::f32)) ||
      ((flags & kHasBands) && header.alpha() >= 0) || (form.has_bits && header.sample_type != SampleType::f32) ||
      ((flags & (kHasPalette | kHasCells)) && !form.has_views) || (form.has_views && !has_all))
    corrupt("it has flags that do not go with the picture");
  if (flags & kHasBands) {
    form.channels = read_channels(start, at, header.spec.channels);
  } else {
    form.channels.resize(form.is_alpha ? 1 : size_t(header.spec.channels));
    std::iota(form.channels.begin(), form.channels.end(), form.is_alpha ? header.alpha() : 0);
  }
  form.grids.resize(form.channels.size());
  for (ResidualGrid &grid : form.grids) grid = read_grid(start, at, header.sample_type);
  if (flags & kHasPalette) read_palette(start, at, form);
  return form;
}

ResidualTable read_residual_table(const Header &header, Bytes start, int64_t length) {
  size_t at = 0;
  ResidualTable table{read_residual_form(header, start, at), {}};
  if (length - int64_t(at) < count_of(header) * int64_t(1 + kCrcBytes))
    corrupt("it is too short for the blocks of the picture");
  table.blocks.resize(size_t(count_of(header)));
  for (ResidualTable::Block &block : table.blocks) {
    block.bytes = decode_varint(start, at);
    if (block.bytes > length || start.size - at < kCrcBytes) corrupt("a block ends behind it");
    for (size_t i = 0; i < kCrcBytes; ++i) block.crc |= uint32_t(start.data[at++]) << (8 * i);
  }
  auto offset = int64_t(at);
  for (ResidualTable::Block &block : table.blocks) {
    block.offset = offset;
    offset += block.bytes;
  }
  if (offset != length) corrupt("its blocks do not fill it");
  return table;
}

void encode_residual(const ResidualBlock &block, Isa isa, ResidualSamples &given, RangeEncoder &encoder) {
  code_block(block, isa, encoder, given);
}

ResidualSamples decode_residual(const ResidualBlock &block, Isa isa, Bytes bytes, uint32_t crc) {
  ResidualSamples found{{block.drawn, block.drawn + block.samples()},
                        std::vector<uint8_t>(block.cells(), uint8_t(!block.form.has_cells))};
  if (bytes.size || !block.form.has_cells) {
    RangeDecoder decoder(bytes.data, int64_t(bytes.size));
    decoded("the samples of a block do not decode", [&] { code_block(block, isa, decoder, found); });
    if (!decoder.maybe_exhausted()) corrupt("bytes are left over behind the samples of a block");
  }
  if (crc32({reinterpret_cast<const uint8_t *>(found.samples.data()), found.samples.size() * sizeof(float)}) != crc)
    corrupt("the samples of a block are not those that were written");
  return found;
}

}  // namespace sgi
